// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"

#include <array>
#include <vector>

namespace tandem {

/// A coordinate of a point that a row of a pose moves. The order of operations is that of body.clh, so that
/// all bits are equal.
template<class Real, std::size_t n>
Real moved_coordinate(const std::array<Real, 4>& row, const std::array<Real, n>& point) {
    return ((row[0] * point[0] + row[1] * point[1]) + row[2] * point[2]) + row[3];
}

/// World vertices of a body with the cell's own arithmetic: the pose's matrix in double, rounded to Real,
/// then moved_coordinate() for each row. Real is float or double.
template<class Real>
std::vector<std::array<Real, 3>> world_vertices(const Scene& scene, const Frame& frame, std::size_t body);

} // namespace tandem
