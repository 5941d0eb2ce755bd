// SPDX-License-Identifier: MIT
// The groups of the catalogue; each has its own file and table.
#pragma once

#include "scenes/hard/hard.h"

#include <span>

namespace tandem::hard {

std::span<const HardFamily> bounding_families();  ///< a
std::span<const HardFamily> tolerance_families(); ///< b
std::span<const HardFamily> decision_families();  ///< c
std::span<const HardFamily> shape_families();   ///< c, shapes and sizes; decision.cpp has inverted tetrahedra
std::span<const HardFamily> contact_families(); ///< d
std::span<const HardFamily> deforming_families(); ///< e
std::span<const HardFamily> capacity_families();  ///< f
std::span<const HardFamily> one_body_families();  ///< g
std::span<const HardFamily> moving_families();    ///< h, on straight paths
std::span<const HardFamily> turning_families();   ///< h, with rotations and equal speeds
std::span<const HardFamily> distant_families();   ///< i

} // namespace tandem::hard
