// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/hard/hard.h"

namespace tandem::hard {

/// A box of cells, six tetrahedra each, about the origin; complete. Coordinates are rounded to
/// floats.
Mesh grid(const std::array<std::uint32_t, 3>& cells, const Eigen::Vector3d& size);

/// A complete mesh of separate tetrahedra.
Mesh separate(std::string name, const std::vector<FloatCorners>& tetrahedra);

/// A scene of one frame with these poses of bodies that have the meshes in turn: body i has mesh
/// i % meshes.
Scene still(std::vector<Mesh> meshes, std::vector<Pose> poses);

/// Without rotation; the translation is rounded to floats.
Pose at(const Eigen::Vector3d& translation);

} // namespace tandem::hard
