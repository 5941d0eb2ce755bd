// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"

#include <span>

namespace tandem {

/// Pairs (a < b) of bodies whose slabs overlap along all axes, ascending; closed, as everywhere. `slabs`: of
/// each body lower and upper end along each axis, one after the other; the first three axes span space, and
/// there may be no more than three. `sweep`: the axis that spreads few bodies most; many are strewn into
/// cells along two axes first, and each cell is swept along the third, on all cores. O(n log n) where no body
/// is much larger than most.
std::vector<BodyPair> overlapping(std::span<const double> slabs, std::size_t axes, std::size_t sweep);

} // namespace tandem
