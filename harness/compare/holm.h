// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

namespace tandem::compare {

/// Corrects p-values for being many (Holm 1979): with the i-th least of n, from 0, multiplied by n - i, made
/// monotone and at most 1, the probability of any false alarm among them stays below the level that they are
/// compared with, whatever their dependence. In the order given.
std::vector<double> holm(std::span<const double> p);

} // namespace tandem::compare
