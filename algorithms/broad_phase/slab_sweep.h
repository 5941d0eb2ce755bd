// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/body_pair.h"

#include <span>
#include <vector>

namespace tandem {

/// Pairs (a < b) of bodies whose slabs overlap along all axes, in ascending order; touching overlaps.
/// `slabs`: for each body the lower and upper end along each axis. There are at least three axes, and the
/// first three are linearly independent. `sweep`: the axis to sweep few bodies along. Many bodies are binned
/// into cells along two axes, and cells are swept along the third in parallel. O(n log n) for bodies of
/// similar size.
std::vector<BodyPair> overlapping(std::span<const double> slabs, std::size_t axes, std::size_t sweep);

} // namespace tandem
