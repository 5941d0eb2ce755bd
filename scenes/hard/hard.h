// SPDX-License-Identifier: MIT
#pragma once

#include "base/random.h"
#include "scenes/scene.h"

#include <optional>

namespace tandem {

/// Corners of a tetrahedron in either orientation: floats, so that every precision gets the same ones.
using FloatCorners = std::array<std::array<float, 3>, 4>;

/// How two closed tetrahedra lie to each other by construction; `open` where the construction leaves it open.
enum class Known : std::uint8_t { open, disjoint, touching, overlapping, invalid };

/// Two tetrahedra and what is known of them.
struct HardPair {
    FloatCorners a{}, b{};
    Known known = Known::open;
};

/// Where the truth of a family comes from.
enum class HardTruth : std::uint8_t {
    construction, ///< known when the pair or scene is made
    oracle,       ///< the exact decision (harness/verify/oracle)
    program,      ///< its linear program: tetrahedra of no volume
    geometry      ///< exact intersection and depth (geometry/contact_truth.h)
};

/// "construction", "oracle", ...
std::string_view name_of(HardTruth truth);

/// What `difficulty` is in a family.
struct HardKnob {
    std::string_view meaning;
    double least, most, initial;
};

/// A family of hard cases, one row of the catalogue. A family of pairs has `pair`, one of whole scenes
/// `scene`. In the order in which a row is read: of 43, room is no matter.
struct HardFamily { // NOLINT(clang-analyzer-optin.performance.Padding)
    unsigned row;   ///< of the catalogue, from 1
    char group;     ///< a k-DOPs, b tolerances, c decision, d contacts, e deforming, f queues and stacks
    std::string_view name; ///< "touch": the scene kind is hard:touch
    std::string_view summary;
    HardKnob knob;
    HardTruth truth;
    std::string_view metric; ///< what moves with the difficulty
    std::string_view fails;  ///< what is known to fail on it
    /// Makes pair number `index`. All that differs between pairs is drawn from `random` or is the index.
    HardPair (*pair)(Random& random, double difficulty, std::uint64_t index) = nullptr;
    bool twins = false; ///< pairs 2i and 2i + 1 draw the same numbers
    /// Rigid bodies instead of world vertices: the pose of both bodies in a frame.
    Pose (*pose)(Random& random, double difficulty) = nullptr;
    Scene (*scene)(Random& random, double difficulty) = nullptr;
    /// Pairs of tetrahedra that meet in every frame of the scene, where that is known by construction.
    std::uint64_t (*meeting)(double difficulty) = nullptr;
};

/// All 43, in the order of the catalogue.
std::span<const HardFamily> hard_families();

/// The family of that name; throws InputError that names the nearest.
const HardFamily& hard_family(std::string_view name);

/// Throws InputError when the family's range does not hold `difficulty`.
void check_difficulty(const HardFamily& family, double difficulty);

/// Pair number `index` of a family of pairs: a function of its arguments only, so that pairs can be made in
/// any order.
HardPair hard_pair(const HardFamily& family, std::uint64_t seed, std::uint64_t index, double difficulty);

/// How many pairs, and how many of them share a frame.
struct HardCount {
    std::uint64_t pairs = 64;
    std::uint64_t together = 16;
};

/// Bodies 0 and 1 hold `together` tetrahedra each, in world coordinates or with one pose: tetrahedron t of
/// both in frame f is pair f * together + t. With together = 1 nothing else can meet. Families with poses
/// draw `together` pairs, and a pose for every frame.
Scene hard_pair_scene(const HardFamily& family, std::uint64_t seed, double difficulty, HardCount count);

/// The scene kinds hard:NAME, one a family; parameters difficulty, seed and, of pairs, pairs and together.
std::span<const SceneKind> hard_kinds();

/// Specifications of all families for "hard:all" and "hard:all:pairs=N,seed=N,together=N", which families of
/// whole scenes ignore; the specification itself for all others. Throws InputError.
std::vector<std::string> expand_hard(const std::string& specification);

} // namespace tandem
