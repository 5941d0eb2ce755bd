// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "geometry/decision.h"
#include "scenes/contact.h"
#include "scenes/scene.h"

#include <algorithm>
#include <functional>
#include <span>
#include <vector>

namespace tandem {

/// Where the vertices are. Placement::rounded: where a cell's precision has them, moved by world_vertices and
/// then taken as they are. Placement::exact: where the poses put the scene's own doubles exactly, whatever
/// the precision.
struct Positions {
    Precision precision = Precision::fp32;
    Placement placement = Placement::rounded;
    Origin origin = Origin::world; ///< that Placement::rounded rounds from

    // NOLINTNEXTLINE(*-explicit-*): most questions are about the vertices of a precision
    Positions(Precision cell, Placement level = Placement::rounded, Origin from = Origin::world)
        : precision(level == Placement::exact ? Precision::fp64 : cell),
          placement(level),
          origin(level == Placement::exact ? Origin::world : from) {}
    auto operator<=>(const Positions&) const = default;
};

/// Which tetrahedra of a frame meet, exactly. Worth keeping: it is the same for all cells of the same
/// positions.
struct FrameTruth {
    std::vector<Pair> touching, overlapping; ///< sorted
    /// (body, tetrahedron) with a coordinate that is not finite, sorted; they are in no pair above.
    std::vector<std::array<std::uint32_t, 2>> invalid;
    DecisionCounts decisions; ///< of the pairs whose boxes meet
};

/// Called on the calling thread, now and then; `share` of the work done, in 0..1.
using Report = std::function<void(double share, std::uint64_t decided)>;

/// Decides every pair of tetrahedra of different bodies (not both fixed) on all cores, those that the frame
/// skips left out. A pair it does not list does not meet: pairs are left out only where boxes, found without
/// rounding or wide enough for it, are apart. Throws InputError before it takes more than `memory` bytes, as
/// far as pairs whose boxes meet tell.
FrameTruth frame_truth(const Scene& scene, const Frame& frame, Positions positions, const Report& report = {},
                       std::uint64_t memory = ~std::uint64_t{0});

/// The same decision for a list of pairs, in its order.
std::vector<Decision> decide_pairs(const Scene& scene, const Frame& frame, Positions positions,
                                   std::span<const Pair> pairs);

/// The corners of the pairs' tetrahedra, in their order: as the decision of Placement::rounded takes them.
std::vector<std::array<TetraCorners, 2>> pair_corners(const Scene& scene, const Frame& frame,
                                                      Precision precision, std::span<const Pair> pairs);

/// Answers ascending questions by walking along a sorted list, which is much faster than a search for each.
class PairCursor {
public:
    /// Questions start at `first`.
    PairCursor(std::span<const Pair> sorted, const Pair& first)
        : next_(std::lower_bound(sorted.begin(), sorted.end(), first)), end_(sorted.end()) {}

    bool holds(const Pair& pair) {
        while (next_ != end_ && *next_ < pair) ++next_;
        return next_ != end_ && *next_ == pair;
    }

private:
    std::span<const Pair>::iterator next_, end_;
};

/// How right a set of candidate pairs is.
struct PairErrors {
    std::uint64_t candidates = 0;
    std::uint64_t disjoint = 0; ///< false pairs
    std::uint64_t touching = 0, overlapping = 0;
    std::uint64_t invalid = 0; ///< pairs with a tetrahedron whose coordinates are not finite
    std::uint64_t missed_touching = 0, missed_overlapping = 0;

    void add(const PairErrors& other);
    bool operator==(const PairErrors&) const = default;
};

/// `candidates` sorted, without repetition, of the frame and positions of `truth`.
PairErrors pair_errors(const FrameTruth& truth, std::span<const Pair> candidates);

} // namespace tandem
