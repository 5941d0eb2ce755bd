// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

#include <cstdint>
#include <vector>

namespace tandem {

/// Tetrahedra of a mesh in an order whose runs of 32, 32^2, ... have small boxes: position i holds the
/// tetrahedron order[i]. A range is cut, again and again, along the axis and at the multiple of the run's
/// length at which the surface area heuristic (MacDonald and Booth 1990: areas of the two boxes, each times
/// what is in it) is least; runs of 32 and less are halved. O(n log n) and, for the worst meshes, 31 n for
/// each length; ties go to the lower axis, place and number, so that a mesh has one order.
std::vector<std::uint32_t> sah_order(const Mesh& mesh);

} // namespace tandem
