// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/broad_phase/broad.h"
#include "algorithms/distributed/displacement_tracker.h"
#include "algorithms/distributed/subdomain.h"

namespace tandem {

/// Deals a scene's moving bodies to shares: pieces of a curve through their places, cut where the work that
/// is expected of each piece is as its device is fast. A deal holds for later frames as long as no body has
/// gone further than a margin, a share of its radius.
class Partitioner {
public:
    /// `scene` must outlive this.
    Partitioner(const Scene& scene, const Geometry& geometry, std::size_t subdomains);

    /// Whether the shares have every pair of `frame`. O(bodies), and O(vertices) of deformable ones.
    bool is_valid(const Frame& frame);
    /// Deals anew. `speeds`: of each share's device, in any unit. Where the last deal has not held for long
    /// margins grow, and where they are of no use shares have all bodies, which holds for any frame.
    void partition(const Frame& frame, std::span<const double> speeds);
    /// The same for who knows no more of a frame than the balls that bodies are in: shares have all bodies
    /// whose balls may meet their own, and holds() is not to be asked.
    void partition(std::span<const Ball> balls, std::span<const double> speeds);
    /// Candidate pairs of each body in the frame that was dealt, from which the next deal expects work.
    void calibrate(std::span<const std::uint64_t> pairs_by_body);

    const std::vector<Subdomain>& subdomains() const { return subdomains_; }
    /// The share that a pair of bodies, not both of which are fixed, belongs to.
    std::size_t subdomain_of(BodyPair pair) const { return std::min(owner_of(pair.a), owner_of(pair.b)); }
    /// The share that owns a body; of a fixed one the number of shares.
    std::size_t owner_of(std::uint32_t body) const { return owners_[rows_[body]]; }
    /// Candidate pairs that a share of the last deal is expected to have; 0 where none were ever learned, as
    /// balls alone expect several times too many.
    std::uint64_t expected_pairs(std::size_t subdomain) const;
    /// What a share in which so many candidate pairs were found has worked, in tetrahedra refitted.
    double work_of(std::size_t subdomain, std::uint64_t pairs) const;

private:
    void order_bodies();
    void estimate_work();
    void list_neighbours();
    template<class Need>
    void for_needs(std::size_t row, const Need& need) const;
    std::vector<double> ghost_work() const;
    double estimated_pairs(BodyPair pair) const;
    double tetrahedra_of(std::uint32_t body) const;
    void cut(std::span<const double> speeds);
    std::vector<double> cut_once(std::span<const double> speeds, std::span<const double> ghost_work);
    void gather();
    void gather_all();
    void count_tetrahedra();

    const Scene& scene_;
    BroadSweep sweep_;
    DisplacementTracker places_;
    std::vector<std::uint32_t> all_; ///< bodies
    std::vector<Subdomain> subdomains_;
    std::vector<double> tetrahedra_; ///< by share, of its own bodies and others'
    std::vector<Ball> balls_;        ///< by body, in the frame that was dealt
    // Rows are positions of moving bodies along the curve and, behind them, fixed bodies:
    std::vector<std::uint32_t> order_;      ///< bodies by row
    std::vector<std::uint32_t> rows_;       ///< by body
    std::size_t moving_ = 0;                ///< rows of moving bodies
    std::vector<std::size_t> owners_;       ///< by row; of a fixed body the number of shares
    std::vector<double> work_;              ///< by row below moving_: expected of what it brings its share
    std::vector<std::uint64_t> first_;      ///< by row: of its part of neighbours_
    std::vector<std::uint32_t> neighbours_; ///< rows of bodies that it has a pair of near_ with, in order
    std::vector<BodyPair> near_;            ///< that were dealt
    std::vector<double> estimated_pairs_;   ///< by pair of near_: candidate pairs expected from balls alone
    std::vector<double> calibration_; ///< by body; of a pair those found for each that was foreseen are the
                                      ///< product of its bodies'
    double skin_ = 0.25;              ///< of a body's radius
    std::size_t held_ = 0;            ///< frames that the deal was asked for and held
    bool is_made_ = false;            ///< there is one
    bool is_expired_ = false;         ///< it was asked for one and did not hold
    bool has_all_ = false;            ///< shares have all bodies
    bool is_calibrated_ = false;      ///< work_ is of what bodies had once
};

} // namespace tandem
