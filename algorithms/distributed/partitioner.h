// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/broad_phase/broad.h"
#include "algorithms/distributed/displacement_tracker.h"
#include "algorithms/bodies/subdomain.h"

namespace tandem {

/// Partitions a scene's moving bodies into subdomains. A space-filling curve through the bodies is cut so
/// that the estimated work of each piece matches the speed of its device. A partition is valid for later
/// frames until a body is displaced by more than its skin, a fraction of its radius.
class Partitioner {
public:
    /// `scene` must outlive this.
    Partitioner(const Scene& scene, const Geometry& geometry, std::size_t subdomains);

    /// Whether the subdomains contain every pair of the frame, and on the path to its successor. O(bodies),
    /// and O(vertices) of deformable bodies.
    bool is_valid(const FrameInput& input);
    /// Makes a new partition. `speeds`: of each subdomain's device, in any unit. When the last partition
    /// expired early the skin grows; from its limit on, all subdomains contain all bodies and never expire.
    void partition(const Frame& frame, std::span<const double> speeds);
    /// Makes a new partition from balls that contain the bodies. The ghosts of a subdomain are all bodies
    /// whose balls may overlap those of its own bodies. is_valid() does not apply to such a partition.
    void partition(std::span<const Ball> balls, std::span<const double> speeds);
    /// Calibrates work estimates of later partitions by the candidate pairs of each body, as found in a frame
    /// of this partition.
    void calibrate(std::span<const std::uint64_t> pairs_by_body);

    const std::vector<Subdomain>& subdomains() const { return subdomains_; }
    /// The subdomain that a body pair belongs to. At least one of the two bodies must be moving.
    std::size_t subdomain_of(BodyPair pair) const { return std::min(owner_of(pair.a), owner_of(pair.b)); }
    /// The subdomain that owns a body; the number of subdomains for a fixed body.
    std::size_t owner_of(std::uint32_t body) const { return owners_[rows_[body]]; }
    /// Estimated candidate pairs of a subdomain. 0 before the first calibrate(), because estimates from balls
    /// alone are several times too high.
    std::uint64_t expected_pairs(std::size_t subdomain) const;
    /// The work of a subdomain in which `pairs` candidate pairs were found, in refitted tetrahedra.
    double work_of(std::size_t subdomain, std::uint64_t pairs) const;

private:
    void order_bodies();
    void estimate_work();
    void list_neighbours();
    template<class Visit>
    void for_ghost_subdomains(std::size_t row, const Visit& visit) const;
    std::vector<double> compute_ghost_work() const;
    double estimated_pairs(BodyPair pair) const;
    double tetrahedra_of(std::uint32_t body) const;
    void cut(std::span<const double> speeds);
    std::vector<double> cut_once(std::span<const double> speeds, std::span<const double> ghost_work);
    void collect_ghosts();
    void collect_all_ghosts();
    void count_tetrahedra();

    const Scene& scene_;
    BroadSweep sweep_;
    DisplacementTracker tracker_;
    std::vector<std::uint32_t> all_bodies_;
    std::vector<Subdomain> subdomains_;
    std::vector<double> tetrahedra_; ///< by subdomain: of own bodies and ghosts
    std::vector<Ball> balls_;        ///< by body, in the frame of the partition
    // Rows are positions of moving bodies along the curve, followed by the fixed bodies:
    std::vector<std::uint32_t> order_;      ///< bodies by row
    std::vector<std::uint32_t> rows_;       ///< by body
    std::size_t moving_ = 0;                ///< rows of moving bodies
    std::vector<std::size_t> owners_;       ///< by row: subdomain; of a fixed body the number of subdomains
    std::vector<double> work_;              ///< by row below moving_: estimated work of the body
    std::vector<std::uint64_t> starts_;     ///< by row: begin of its part of neighbours_
    std::vector<std::uint32_t> neighbours_; ///< rows of the bodies that pairs_ pairs it with, ascending
    std::vector<BodyPair> pairs_;           ///< body pairs that the skins allow
    std::vector<double> estimated_pairs_;   ///< by pair of pairs_: candidate pairs, estimated from balls
    /// By body: correction factor. Found over estimated candidate pairs of a body pair is the product of
    /// both.
    std::vector<double> calibration_;
    double skin_ = 0.25;           ///< fraction of a body's radius
    std::size_t valid_frames_ = 0; ///< for which is_valid() returned true
    bool is_partitioned_ = false;  ///< by a frame
    bool is_expired_ = false;      ///< the last is_valid() returned false
    bool has_all_ghosts_ = false;  ///< subdomains contain all bodies
    bool is_calibrated_ = false;   ///< calibrate() has been called
};

} // namespace tandem
