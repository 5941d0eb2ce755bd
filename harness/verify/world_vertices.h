// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"

#include <array>
#include <vector>

namespace tandem {

/// World vertices of a body with the cell's own arithmetic: the pose's matrix in double, rounded to Real,
/// then moved_coordinate() for each row. Real is float or double.
template<class Real>
std::vector<std::array<Real, 3>> world_vertices(const Scene& scene, const Frame& frame, std::size_t body);

} // namespace tandem
