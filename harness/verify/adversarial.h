// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "backends/device.h"
#include "scenes/hard/hard.h"

#include <optional>
#include <span>

namespace tandem {

/// Where pairs are bounded and tested, and how.
struct AdversarialCell {
    Device* device = nullptr;
    Geometry geometry; ///< in single precision, whose vertices the truth is of
};

struct AdversarialOptions {
    std::uint64_t pairs = 100000;  ///< of the family; a fifth at each of five difficulties
    std::uint64_t batch = 1 << 17; ///< in one launch
    std::uint64_t seed = 1;
    std::uint64_t sample = 64; ///< of so many pairs known by construction the oracle decides one as well
    /// Families whose truth is geometry: of so many, at each difficulty, the exact intersection is made
    /// instead.
    std::uint64_t clipped = 2000;
};

/// A pair that meets and was not found.
struct MissedPair {
    std::size_t cell = 0;
    double difficulty = 0;
    std::uint64_t seed = 0;  ///< of hard_pair
    std::uint64_t index = 0; ///< of hard_pair; in families with poses: frame * together + tetrahedron
};

/// What came of a family's pairs.
struct AdversarialTally {
    std::uint64_t pairs = 0, touching = 0, overlapping = 0; ///< the rest is disjoint
    std::uint64_t decided = 0;                              ///< by the oracle
    std::uint64_t clipped = 0;                              ///< of these by the exact intersection
    std::uint64_t contradictions = 0;           ///< constructions that the oracle does not confirm
    std::vector<std::uint64_t> missed;          ///< [cell] pairs that meet and were not found
    std::vector<std::uint64_t> false_pairs;     ///< [cell] found pairs that do not meet
    std::optional<MissedPair> first;            ///< the first missed one
    double truth_seconds = 0, test_seconds = 0; ///< generation and truth on all cores; upload, refit and test

    bool ok() const;
    /// `other` is of the same cells; a new tally takes any.
    void add(const AdversarialTally& other);
};

/// Makes pairs of a family, bounds and tests them by the kernels of the walks on every cell
/// (hierarchy/pair_list.h) and compares with the truth: by construction, or the oracle's decision of the very
/// vertices. Pairs are those of hard_pair(family, 5 seed + i, 0.., difficulty), i the number of the
/// difficulty. Families of whole scenes and those that are not finite have none and throw InputError.
AdversarialTally run_adversarial(const HardFamily& family, std::span<const AdversarialCell> cells,
                                 const AdversarialOptions& options);

/// Whether run_adversarial takes the family.
bool is_adversarial(const HardFamily& family);

/// Least, default and largest difficulty, and one between each two: the geometric mean where both have a
/// sign.
std::array<double, 5> difficulties_of(const HardFamily& family);

} // namespace tandem
