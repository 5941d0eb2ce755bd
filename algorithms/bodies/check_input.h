// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "scenes/scene.h"

#include <optional>
#include <span>

namespace tandem {

/// Throws InputError that names the first flaw: a body without mesh, a mesh that complete_mesh has not
/// completed, that has no tetrahedra, a coordinate beyond largest_coordinate, or pressures below
/// smallest_pressure or with an extent below smallest_extent, or a pair of Scene::never_meet that is out of
/// order or has no such body.
void check_scene(const Scene& scene, const Geometry& geometry);

/// Throws InputError that names the first flaw of a frame: the number of its poses and lists, of vertices or
/// of skipped tetrahedra; a rotation whose length is not 1 within 0.001; a coordinate beyond
/// largest_coordinate. `owned`: the bodies whose states are read, in addition to fixed ones; nullopt: all.
/// O(bodies + vertices of deformable bodies): check_scene has checked the meshes.
void check_frame(const Scene& scene, const Frame& frame, const Geometry& geometry,
                 std::optional<std::span<const std::uint32_t>> owned);

} // namespace tandem
