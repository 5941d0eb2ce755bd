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

/// The vertices and body pairs that the truth is for. Placement::rounded: those of world_vertices() in a
/// cell's precision, treated as exact. Placement::exact: the scene's vertices in double, posed without
/// rounding, for every precision.
struct Positions {
    Precision precision = Precision::fp32;
    Placement placement = Placement::rounded;
    Origin origin = Origin::world; ///< of coordinates and meshes that Placement::rounded rounds
    SelfPairs self = SelfPairs::off;

    // NOLINTNEXTLINE(*-explicit-*): most callers pass only a precision
    Positions(Precision cell, Placement level = Placement::rounded, Origin from = Origin::world,
              SelfPairs own = SelfPairs::off)
        : precision(level == Placement::exact ? Precision::fp64 : cell),
          placement(level),
          origin(level == Placement::exact ? Origin::world : from),
          self(own) {}
    auto operator<=>(const Positions&) const = default;
};

/// The exact relation of a frame's tetrahedra; the same for all cells with the same positions.
struct FrameTruth {
    std::vector<Pair> touching, overlapping; ///< sorted
    /// (body, tetrahedron) with a coordinate that is not finite, sorted; in no pair above.
    std::vector<std::array<std::uint32_t, 2>> invalid;
    DecisionCounts decisions; ///< of the pairs whose boxes overlap
};

/// Progress, reported from the calling thread; `fraction` of the work in 0..1.
using Report = std::function<void(double fraction, std::uint64_t decided)>;

/// Decides every pair of tetrahedra of different bodies that may meet, and with positions.self those of
/// one body that share no vertex, except those that the frame skips, on all cores. Pairs that are not listed
/// are disjoint: only pairs with disjoint boxes are not decided, and boxes are exact or wide enough for
/// rounding. Throws InputError when the estimated memory exceeds `memory` bytes.
FrameTruth frame_truth(const Scene& scene, const Frame& frame, Positions positions, const Report& report = {},
                       std::uint64_t memory = ~std::uint64_t{0});

/// The same decisions for a list of pairs, in its order.
std::vector<Decision> decide_pairs(const Scene& scene, const Frame& frame, Positions positions,
                                   std::span<const Pair> pairs);

/// The corners of the pairs' tetrahedra, in the order of the list. They are rounded for every placement.
std::vector<std::array<TetraCorners, 2>> pair_corners(const Scene& scene, const Frame& frame,
                                                      Positions positions, std::span<const Pair> pairs);

/// Looks up ascending pairs in one pass over a sorted list, which is much faster than a search for each.
class PairCursor {
public:
    /// `first` is the first pair to look up.
    PairCursor(std::span<const Pair> sorted, const Pair& first)
        : next_(std::lower_bound(sorted.begin(), sorted.end(), first)), end_(sorted.end()) {}

    bool contains(const Pair& pair) {
        while (next_ != end_ && *next_ < pair) ++next_;
        return next_ != end_ && *next_ == pair;
    }

private:
    std::span<const Pair>::iterator next_, end_;
};

/// Errors of a set of candidate pairs.
struct PairErrors {
    std::uint64_t candidates = 0;
    std::uint64_t disjoint = 0; ///< false pairs
    std::uint64_t touching = 0, overlapping = 0;
    std::uint64_t invalid = 0; ///< pairs with a tetrahedron whose coordinates are not finite
    std::uint64_t missed_touching = 0, missed_overlapping = 0;

    void add(const PairErrors& other);
    bool operator==(const PairErrors&) const = default;
};

/// `candidates` must be sorted, without duplicates, and for the frame and positions of `truth`.
PairErrors pair_errors(const FrameTruth& truth, std::span<const Pair> candidates);

} // namespace tandem
