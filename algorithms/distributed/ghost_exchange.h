// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/broad_phase/broad.h"
#include "algorithms/distributed/bytes.h"
#include "algorithms/distributed/partitioner.h"
#include "backends/ranks.h"

namespace tandem {

/// Finds the ghost bodies of a rank, and updates them in every frame. A pair of bodies of two ranks belongs
/// to the lower rank, to which the other rank sends the pose or vertices of its body. Ghosts are found from
/// bounds enlarged by a skin, and are valid until a body is displaced by more. All ranks together call the
/// functions marked "collective", in the same order.
class GhostExchange {
public:
    /// Bytes and messages that this rank has sent.
    struct Traffic {
        std::uint64_t bytes = 0, messages = 0;
    };

    /// `scene` and `ranks` must outlive this.
    GhostExchange(const Scene& scene, const Geometry& geometry, Ranks& ranks);

    /// Collective: whether the ghosts are invalid. On some rank none are built, or a body is displaced by
    /// more than its skin, in the frame or on the path to its successor.
    bool is_expired(const FrameInput& input, Traffic& traffic);
    /// Collective: exchanges bounds and rebuilds the ghosts. The bounds enclose the paths to the successor
    /// too. The frames need poses or vertices of `own` and of fixed bodies only.
    void rebuild(const std::vector<std::uint32_t>& own, const FrameInput& input, Traffic& traffic);
    /// Collective: sends poses, vertices and skipped tetrahedra of own bodies to the ranks where they are
    /// ghosts, and poses and vertices of the successor. `vertices`: false when DeviceVertexExchange sends the
    /// vertices.
    void exchange_states(const FrameInput& input, Traffic& traffic, bool vertices = true);
    /// Deformable bodies whose vertices this rank sends and receives, by other rank. Sender and receiver have
    /// the same order.
    std::vector<std::vector<std::uint32_t>> deformed_sent() const { return deformable(sent_); }
    std::vector<std::vector<std::uint32_t>> deformed_received() const { return deformable(received_); }
    /// The states that this rank has received, by body; all other entries are unset.
    const Frame& ghost_frame() const { return ghost_frame_; }
    /// The same for the frame's successor, without skipped tetrahedra. Set if the last frame had one.
    const Frame& next_ghost_frame() const { return next_ghost_frame_; }
    /// This rank's own bodies, and its ghosts: bodies that it receives, and fixed ones.
    const Subdomain& subdomain() const { return subdomain_; }
    /// Bodies that are not ghosts but may be after the next rebuild(), as they are within a wider skin. In no
    /// order; this rank does not receive their states.
    const std::vector<std::uint32_t>& next_ghosts() const { return next_; }
    /// Makes the next is_expired() return true.
    void invalidate() { is_built_ = false; }

private:
    using BodyIds = std::vector<std::uint32_t>;

    std::vector<double> slabs_of(const BodyIds& bodies, const FrameInput& input, double skin) const;
    BodyIds overlapping_any(const BodyIds& bodies, const std::vector<double>& slabs,
                            std::span<const double> boxes) const;
    BodyIds select_ghosts(const BodyIds& bodies, const std::vector<double>& slabs,
                          const std::vector<double>& narrow, const std::vector<double>& wide);
    std::vector<BodyIds> exchange_ids(const std::vector<BodyIds>& lists, Traffic& traffic);
    void select_received(const FrameInput& input, const std::vector<double>& slabs,
                         const std::vector<double>& wide, Traffic& traffic);
    std::vector<Ranks::Bytes> exchange_messages(const std::vector<Ranks::Bytes>& out, Traffic& traffic);
    std::vector<Ranks::Bytes> exchange_boxes(const std::vector<double>& boxes, Traffic& traffic);
    FrameInput ghost_input(const FrameInput& input) const {
        return {ghost_frame_, input.next == nullptr ? nullptr : &next_ghost_frame_};
    }
    Ranks::Bytes states_message(const BodyIds& bodies, const FrameInput& input, bool vertices) const;
    void append_states(Ranks::Bytes& message, const BodyIds& bodies, const Frame& frame, bool vertices) const;
    void read_message(const Ranks::Bytes& message, const BodyIds& bodies, bool has_next, bool vertices);
    void read_states(MessageReader& reader, const BodyIds& bodies, Frame& frame, bool vertices) const;
    std::vector<BodyIds> deformable(const std::vector<BodyIds>& lists) const;

    const Scene& scene_;
    Ranks& ranks_;
    BroadSweep sweep_;
    DisplacementTracker tracker_;
    BodyIds fixed_;
    Subdomain subdomain_;
    BodyIds sorted_own_; ///< own bodies in the order of memory, which halves the time of is_expired()
    BodyIds next_;
    std::vector<BodyIds> sent_, received_; ///< by rank
    Frame ghost_frame_, next_ghost_frame_;
    double skin_ = 0.25;           ///< fraction of a body's radius
    std::size_t valid_frames_ = 0; ///< since the last rebuild()
    bool is_built_ = false;
};

} // namespace tandem
