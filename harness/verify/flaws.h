// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"

#include <string>
#include <vector>

namespace tandem {

/// What becomes of tetrahedra of zero volume and of those with a coordinate that is not finite
/// (--degenerate).
enum class Degenerate {
    flat,  ///< zero volume: a closed convex set like any other; not finite: refused
    skip,  ///< neither takes part: no answer, no reference and no truth has them
    reject ///< both are refused
};

/// "flat", "skip", "reject".
std::string_view name_of(Degenerate handling);

/// The one of that name; throws InputError.
Degenerate degenerate_named(const std::string& name);

/// A body with flawed tetrahedra, counted in every frame.
struct FlawedBody {
    std::uint32_t body = 0;
    std::uint64_t degenerate = 0;     ///< of zero volume
    std::uint64_t non_finite = 0;     ///< with a coordinate that is not finite
    std::size_t frame = 0;            ///< the first frame it has any in
    std::vector<std::uint32_t> first; ///< in that frame, ascending, the first few
};

/// Tetrahedra of a body, and bodies in a message, that are named.
inline constexpr std::size_t most_named_flaws = 4;

/// The flawed tetrahedra of a range of frames.
struct Flaws {
    Degenerate handling = Degenerate::flat;
    std::uint64_t degenerate = 0, non_finite = 0; ///< sums over bodies and frames
    std::vector<FlawedBody> bodies;               ///< by number; only those that have any

    bool any() const { return degenerate + non_finite > 0; }
};

/// "3 of zero volume and 1 not finite in 2 of 5 bodies: body 0 tetrahedron 7, 9 in frame 0; body 4
/// tetrahedron 1, ... in frame 3", with the first few.
std::string describe(const Flaws& flaws, const Scene& scene);

} // namespace tandem
