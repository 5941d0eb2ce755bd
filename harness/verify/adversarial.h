// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "backends/device.h"
#include "scenes/hard/hard.h"

#include <optional>
#include <span>

namespace tandem {

/// A device and bounds to test.
struct AdversarialCell {
    Device* device = nullptr;
    Geometry geometry; ///< in single precision, because the truth is for vertices in that precision
};

struct AdversarialOptions {
    std::uint64_t pairs = 100000;  ///< number of pairs; a fifth at each of five difficulties
    std::uint64_t batch = 1 << 17; ///< most pairs in one launch
    std::uint64_t seed = 1;
    std::uint64_t sample = 64; ///< the oracle also decides every `sample`-th pair whose relation is known
    /// Number of pairs at each difficulty whose relation the exact intersection decides, in families whose
    /// truth is geometry.
    std::uint64_t clipped = 2000;
};

/// An intersecting pair that the test missed.
struct MissedPair {
    std::size_t cell = 0;
    double difficulty = 0;
    std::uint64_t seed = 0;  ///< argument of hard_pair
    std::uint64_t index = 0; ///< argument of hard_pair; with poses: frame * batch size + tetrahedron
};

/// Results of testing a family's pairs.
struct AdversarialTally {
    std::uint64_t pairs = 0, touching = 0, overlapping = 0; ///< the remaining pairs are disjoint
    std::uint64_t decided = 0;                              ///< by the oracle
    std::uint64_t clipped = 0;                              ///< of these, by the exact intersection
    std::uint64_t contradictions = 0;                       ///< constructions that the oracle contradicts
    std::vector<std::uint64_t> missed;                      ///< [cell] intersecting pairs that were not found
    std::vector<std::uint64_t> false_pairs;                 ///< [cell] found pairs that are disjoint
    std::optional<MissedPair> first;                        ///< the first missed one
    double truth_seconds = 0, test_seconds = 0; ///< generation and truth on all cores; upload, refit and test

    bool ok() const;
    /// `other` must have the same cells, unless this tally is new.
    void add(const AdversarialTally& other);
};

/// Generates pairs of a family, tests them on every cell with the kernels of the walks
/// (answer/pair_list.h), and compares with the truth. The truth is known by construction, or the oracle
/// decides the same vertices. Pairs are hard_pair(family, 5 seed + i, 0.., difficulty), where i numbers the
/// difficulty. Throws InputError for families of whole scenes and for not-finite, which have no such pairs.
AdversarialTally run_adversarial(const HardFamily& family, std::span<const AdversarialCell> cells,
                                 const AdversarialOptions& options);

/// Whether run_adversarial() accepts the family.
bool is_adversarial(const HardFamily& family);

/// Least, default and largest difficulty, and the midpoint of each two: the geometric mean when both are
/// positive, otherwise the arithmetic mean.
std::array<double, 5> difficulties_of(const HardFamily& family);

} // namespace tandem
