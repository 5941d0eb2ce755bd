// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/facets.h"

#include <gmpxx.h>

namespace tandem::geometry {

/// Whether the convex hulls of two sets of four points intersect; any points are valid. They do when weights
/// w, v >= 0 of sum 1 each exist with sum w_i a_i = sum v_j b_j. Decided by the first phase of the simplex
/// method in rationals with Bland's rule (1977), which terminates on degenerate programs too.
bool hulls_meet(const Points<mpz_class>& a, const Points<mpz_class>& b);

} // namespace tandem::geometry
