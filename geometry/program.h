// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/facets.h"

#include <gmpxx.h>

namespace tandem::oracle {

/// Whether the convex hulls of two sets of four points meet, for any points at all: whether there are weights
/// w, v >= 0 of sum 1 each with sum w_i a_i = sum v_j b_j, by the first phase of the simplex method in
/// rationals with Bland's rule (1977), which ends on degenerate programs too.
bool hulls_meet(const Points<mpz_class>& a, const Points<mpz_class>& b);

} // namespace tandem::oracle
