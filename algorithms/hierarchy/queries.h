// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"

#include <algorithm>
#include <functional>
#include <vector>

namespace tandem {

/// Maximum number of tetrahedra of the smaller body of a pair: those of the second largest body. With
/// `has_self`, pairs may be of a body with itself: those of the largest.
inline std::uint32_t most_queries(const Bodies& bodies, bool has_self = false) {
    std::vector<std::uint32_t> counts{0, 0};
    for (std::uint32_t body = 0; body < bodies.count(); ++body)
        counts.push_back(bodies.row(body).tetrahedron_count);
    std::nth_element(counts.begin(), counts.begin() + 1, counts.end(), std::greater<>());
    return has_self ? std::ranges::max(counts) : counts[1];
}

} // namespace tandem
