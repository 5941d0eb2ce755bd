// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>

namespace tandem {

/// A coordinate of a point that a row of a pose moves. The order of operations is that of body.clh, so that
/// all bits are equal.
template<class Real, std::size_t n>
Real moved_coordinate(const std::array<Real, 4>& row, const std::array<Real, n>& point) {
    return ((row[0] * point[0] + row[1] * point[1]) + row[2] * point[2]) + row[3];
}

} // namespace tandem
