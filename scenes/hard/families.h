// SPDX-License-Identifier: MIT
// The groups of the catalogue, one file each.
#pragma once

#include "scenes/hard/hard.h"

#include <vector>

namespace tandem::hard {

std::vector<HardFamily> bounding_families();  ///< a
std::vector<HardFamily> tolerance_families(); ///< b
std::vector<HardFamily> decision_families();  ///< c
std::vector<HardFamily> shape_families();     ///< c, shapes and sizes
std::vector<HardFamily> contact_families();   ///< d
std::vector<HardFamily> deforming_families(); ///< e
std::vector<HardFamily> capacity_families();  ///< f

} // namespace tandem::hard
