// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/broad_phase/broad.h"
#include "algorithms/distributed/partitioner.h"
#include "backends/ranks.h"

namespace tandem {

/// What ranks tell each other of bodies: those of a rank that come near bodies of a lower one are that one's
/// to pair, and it is sent their poses or vertices in every frame. Who is near is found from bounds with a
/// margin, and holds until a body has gone further. Functions that are marked so are called by all ranks
/// together, in the same order.
class GhostExchange {
public:
    /// What a rank has sent.
    struct Traffic {
        std::uint64_t bytes = 0, messages = 0;
    };

    /// `scene` and `ranks` must outlive this.
    GhostExchange(const Scene& scene, const Geometry& geometry, Ranks& ranks);

    /// By all ranks: whether bodies of any of them have gone too far, or are others than before.
    bool is_expired(const Frame& frame, Traffic& traffic);
    /// By all ranks: exchanges bounds, and finds who is near. `frame` has the poses or vertices of `own`, and
    /// of fixed bodies.
    void rebuild(const std::vector<std::uint32_t>& own, const Frame& frame, Traffic& traffic);
    /// By all ranks: sends poses, vertices and skipped tetrahedra of own bodies to those that need them;
    /// vertices unless they go another way.
    void exchange_states(const Frame& frame, Traffic& traffic, bool vertices = true);
    /// Deformable bodies whose vertices go to other ranks, or come from them: by rank, in the order in which
    /// both have them.
    std::vector<std::vector<std::uint32_t>> deformed_sent() const { return deformable(sent_); }
    std::vector<std::vector<std::uint32_t>> deformed_received() const { return deformable(received_); }
    /// What came of others' bodies; of all else it has nothing.
    const Frame& ghost_frame() const { return ghost_frame_; }
    /// Of this rank: its own bodies, and the others that it gets or that are fixed and near.
    const Subdomain& subdomain() const { return subdomain_; }
    /// Others' bodies that are not in the share, and fixed ones, but may be after the next meet(): those
    /// within margins more. In no order; where they are is not known.
    const std::vector<std::uint32_t>& next_ghosts() const { return next_; }
    /// The next is_expired() is true.
    void forget() { is_built_ = false; }

private:
    using Numbers = std::vector<std::uint32_t>;

    std::vector<double> slabs_of(const Numbers& bodies, const Frame& frame, double skin) const;
    Numbers near(const Numbers& bodies, const std::vector<double>& slabs,
                 std::span<const double> boxes) const;
    Numbers divide(const Numbers& bodies, const std::vector<double>& slabs, const std::vector<double>& narrow,
                   const std::vector<double>& wide);
    std::vector<Numbers> exchange_ids(const std::vector<Numbers>& lists, Traffic& traffic);
    void keep_near(const Frame& frame, const std::vector<double>& slabs, const std::vector<double>& wide,
                   Traffic& traffic);
    std::vector<Ranks::Bytes> passed(const std::vector<Ranks::Bytes>& out, Traffic& traffic);
    std::vector<Ranks::Bytes> boxes_near(const std::vector<double>& boxes, Traffic& traffic);
    Ranks::Bytes states_message(const Numbers& bodies, const Frame& frame, bool vertices) const;
    void read_states(const Ranks::Bytes& words, const Numbers& bodies, bool vertices);
    std::vector<Numbers> deformable(const std::vector<Numbers>& lists) const;

    const Scene& scene_;
    Ranks& ranks_;
    BroadSweep sweep_;
    DisplacementTracker places_;
    Numbers fixed_; ///< bodies
    Subdomain subdomain_;
    Numbers looked_at_; ///< own bodies as they lie in memory, which is half of the time that it takes to look
    Numbers next_;
    std::vector<Numbers> sent_, received_; ///< by rank
    Frame ghost_frame_;
    double skin_ = 0.25;   ///< of a body's radius
    std::size_t held_ = 0; ///< frames since the last meet()
    bool is_built_ = false;
};

} // namespace tandem
