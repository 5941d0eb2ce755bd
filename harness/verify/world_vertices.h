// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/choices.h"
#include "scenes/scene.h"

#include <array>
#include <vector>

namespace tandem {

/// The point that a rigid body's mesh is centred at in cells with this origin: by axis the middle of its
/// tetrahedra where it is further from 0 than 8 of their extents, otherwise 0. Always 0 with Origin::world.
std::array<double, 3> centre_of(const Mesh& mesh, Origin origin);

/// World vertices of a body with the cell's own arithmetic: the pose's matrix in double, its translation with
/// the moved centre, both rounded to Real, then moved_coordinate() for each row, of vertices less the centre.
/// Real is float or double. `frame`: relative to the cell's origin.
template<class Real>
std::vector<std::array<Real, 3>> world_vertices(const Scene& scene, const Frame& frame, std::size_t body,
                                                Origin origin);

} // namespace tandem
