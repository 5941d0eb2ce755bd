// SPDX-License-Identifier: MIT
#pragma once

#include "base/random.h"
#include "scenes/scene.h"

#include <optional>

namespace tandem {

/// Corners of a tetrahedron in either orientation. They are floats, so that every precision has the same
/// input.
using FloatCorners = std::array<std::array<float, 3>, 4>;

/// Relation of two closed tetrahedra by construction; `open` when the construction does not define it.
enum class Known : std::uint8_t { open, disjoint, touching, overlapping, invalid };

/// Two tetrahedra and their known relation.
struct HardPair {
    FloatCorners a{}, b{};
    Known known = Known::open;
};

/// Source of a family's truth.
enum class HardTruth : std::uint8_t {
    construction, ///< defined by the construction of the pair or scene
    oracle,       ///< the exact decision (harness/verify/oracle)
    program,      ///< the oracle's linear program, for tetrahedra without volume
    geometry      ///< exact intersection and depth (geometry/contact_truth.h)
};

/// "construction", "oracle", ...
std::string_view name_of(HardTruth truth);

/// Meaning and range of `difficulty` in a family.
struct HardKnob {
    std::string_view meaning;
    double least, most, initial;
};

/// A family of hard cases, one row of the catalogue. A family of pairs has `pair`, a family of scenes has
/// `scene`. Fields have the order of a row, since padding does not matter for 59 objects.
struct HardFamily { // NOLINT(clang-analyzer-optin.performance.Padding)
    unsigned row;   ///< row in the catalogue, from 1
    /// a k-DOPs, b tolerances, c decision, d contacts, e deforming, f queues and stacks, g pairs of one body,
    /// h motion between two frames, i distances in double
    char group;
    std::string_view name; ///< "touch": the scene kind is hard:touch
    std::string_view summary;
    HardKnob knob;
    HardTruth truth;
    /// Quantities that change with the difficulty. MISS: missed pairs; FPR: candidates per pair that meets;
    /// CLS: the relation confused; SYM, PERM, INV: changes under mirroring, renumbering and scaling; DREL,
    /// DULP: the error of the depth, relative and in units of the size; ANG: the angle to the nearest best
    /// normal; PT: the distance of a contact point; VOL: the volume.
    std::string_view metric;
    std::string_view fails; ///< known failures
    /// Makes pair number `index`. Pairs differ only by values from `random` and by the index.
    HardPair (*pair)(Random& random, double difficulty, std::uint64_t index) = nullptr;
    bool twins = false; ///< pairs 2i and 2i + 1 have the same random numbers
    /// The pose of both bodies in a frame, for families with rigid bodies instead of world vertices.
    Pose (*pose)(Random& random, double difficulty) = nullptr;
    Scene (*scene)(Random& random, double difficulty) = nullptr;
    /// Number of tetrahedron pairs that meet in every frame, when the construction defines it. With `self` it
    /// includes pairs of one body. With `motion` it is the number on the way from frame 0 to frame 1, and no
    /// pair meets in either frame.
    std::uint64_t (*meeting)(double difficulty) = nullptr;
    bool self = false;   ///< the intended pairs are of one body, which setting self finds
    bool motion = false; ///< the intended pairs meet between frame 0 and frame 1
    /// Coordinates need double, and cells in single precision need origin=auto. The coordinates of all other
    /// families are floats.
    bool distant = false;
};

/// All 59, in the order of the catalogue.
std::span<const HardFamily> hard_families();

/// The family of that name. Throws InputError with the nearest name when there is none.
const HardFamily& hard_family(std::string_view name);

/// Throws InputError when `difficulty` is outside the family's range.
void check_difficulty(const HardFamily& family, double difficulty);

/// Pair number `index` of a family of pairs. It depends only on the arguments, so that pairs can be made in
/// any order.
HardPair hard_pair(const HardFamily& family, std::uint64_t seed, std::uint64_t index, double difficulty);

/// Number of pairs, and number of pairs in a frame.
struct HardCount {
    std::uint64_t pairs = 64;
    std::uint64_t together = 16;
};

/// A scene of two bodies with `together` tetrahedra each, in world coordinates or with one pose. Tetrahedron
/// t of both bodies in frame f is pair f * together + t. With together = 1 there are no other pairs. Families
/// with poses have `together` pairs and a pose for every frame.
Scene hard_pair_scene(const HardFamily& family, std::uint64_t seed, double difficulty, HardCount count);

/// The scene kinds hard:NAME, one a family. Parameters are difficulty, seed and field, for pairs also pairs
/// and together.
std::span<const SceneKind> hard_kinds();

/// Specifications of all families for "hard:all" and "hard:all:pairs=N,seed=N,field=1,together=N". Families
/// of scenes ignore pairs and together. Any other specification is returned unchanged. Throws InputError.
std::vector<std::string> expand_hard(const std::string& specification);

} // namespace tandem
