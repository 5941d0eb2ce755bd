// SPDX-License-Identifier: MIT
#pragma once

#include <gmpxx.h>

namespace tandem::geometry {

/// The double nearest to x, ties to even; subnormal and infinite results as in IEEE 754.
double nearest(const mpq_class& x);

/// The double nearest to the square root of x; x >= 0.
double nearest_root(const mpq_class& x);

/// x * 2^exponent.
mpq_class scaled(const mpq_class& x, long exponent);

} // namespace tandem::geometry
