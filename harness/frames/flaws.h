// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"

#include <string>
#include <vector>

namespace tandem {

/// Handling of tetrahedra of zero volume and of those with a coordinate that is not finite (--degenerate).
/// Readers of files refuse the latter before, so only frames made by programs have them.
enum class Degenerate {
    flat,  ///< treats zero volume like any closed convex set; rejects coordinates that are not finite
    skip,  ///< leaves both out of answers, reference and truth
    reject ///< rejects both
};

/// "flat", "skip", "reject".
std::string_view name_of(Degenerate handling);

/// The handling with that name; throws InputError for any other name.
Degenerate degenerate_named(const std::string& name);

/// A body with flawed tetrahedra, counted in every frame.
struct FlawedBody {
    std::uint32_t body = 0;
    std::uint64_t degenerate = 0;     ///< of zero volume
    std::uint64_t non_finite = 0;     ///< with a coordinate that is not finite
    std::size_t frame = 0;            ///< its first frame with a flaw
    std::vector<std::uint32_t> first; ///< the first few tetrahedra in that frame, ascending
};

/// Most tetrahedra of a body, and most bodies in a message, that are listed.
inline constexpr std::size_t most_named_flaws = 4;

/// The flawed tetrahedra of a range of frames.
struct Flaws {
    Degenerate handling = Degenerate::flat;
    std::uint64_t degenerate = 0, non_finite = 0; ///< sums over bodies and frames
    std::vector<FlawedBody> bodies;               ///< only flawed bodies, by number

    bool any() const { return degenerate + non_finite > 0; }
};

/// Counts and the first few examples: "3 of zero volume and 1 not finite in 2 of 5 bodies: body 0 tetrahedron
/// 7, 9 in frame 0; body 4 tetrahedron 1, ... in frame 3".
std::string describe(const Flaws& flaws, const Scene& scene);

} // namespace tandem
