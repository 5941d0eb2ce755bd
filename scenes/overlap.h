// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"

#include <optional>

namespace tandem {

using Corners3 = std::array<Eigen::Vector3d, 4>;

/// True when two tetrahedra overlap by more than `slack` along every candidate for a separating axis
/// (Gottschalk, Lin and Manocha 1996: normals of faces, cross products of edges).
bool overlap(const Corners3& a, const Corners3& b, double slack);

/// The first two bodies (a < b) that overlap by more than 1e-5 of the smaller body's diagonal; with
/// `only_fixed`, fixed bodies only. Checks an initial state on the host: boxes of bodies, boxes of
/// tetrahedra, then overlap() in double.
std::optional<std::array<std::size_t, 2>> first_overlap(const Scene& scene, const Frame& frame,
                                                        bool only_fixed = false);

} // namespace tandem
