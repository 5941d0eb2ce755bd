// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/hard/hard.h"

namespace tandem::hard {

/// A complete mesh of a box of cells about the origin, six tetrahedra a cell. Coordinates are rounded to
/// floats.
Mesh grid(const std::array<std::uint32_t, 3>& cells, const Eigen::Vector3d& size);

/// A complete mesh of separate tetrahedra.
Mesh separate(std::string name, const std::vector<FloatCorners>& tetrahedra);

/// A scene of one frame with these poses; body i has mesh i % meshes.size().
Scene still(std::vector<Mesh> meshes, std::vector<Pose> poses);

/// A pose without rotation. The translation is rounded to floats.
Pose at(const Eigen::Vector3d& translation);

} // namespace tandem::hard
