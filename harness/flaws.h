// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"

#include <span>
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

/// The flawed tetrahedra of a range of frames.
struct Flaws {
    Degenerate handling = Degenerate::flat;
    std::uint64_t degenerate = 0, non_finite = 0; ///< sums over bodies and frames
    std::vector<FlawedBody> bodies;               ///< by number; only those that have any

    bool any() const { return degenerate + non_finite > 0; }
};

/// Finds them in all frames, on all cores, and does with them what is asked for; frame i of the span has
/// number first + i. Volumes are decided exactly (oracle/volume.h) for the coordinates that are given: those
/// of the mesh for a rigid body, whose poses change no volume, those of the frame for a deformable one. With
/// skip the frames list them in `skipped`, and coordinates that are not finite are replaced by finite ones of
/// the same body, which nothing looks at. Throws InputError for what is refused.
Flaws handle_flaws(const Scene& scene, std::size_t first, std::span<Frame> frames, Degenerate handling);

/// "3 of zero volume and 1 not finite in 2 of 5 bodies: body 0 tetrahedron 7, 9 in frame 0; body 4
/// tetrahedron 1, ... in frame 3", with the first few.
std::string describe(const Flaws& flaws, const Scene& scene);

} // namespace tandem
