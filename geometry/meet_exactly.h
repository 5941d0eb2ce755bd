// SPDX-License-Identifier: MIT
#pragma once

#include <array>

namespace tandem {

/// Whether two closed tetrahedra have a point in common, exactly. True when a coordinate is not finite,
/// because no axis separates such a pair. Its types are plain arrays, so that decision=exact includes no
/// oracle header.
bool meet_exactly(const std::array<std::array<double, 3>, 4>& a,
                  const std::array<std::array<double, 3>, 4>& b);

} // namespace tandem
