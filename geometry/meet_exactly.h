// SPDX-License-Identifier: MIT
#pragma once

#include <array>

namespace tandem {

/// Whether two closed tetrahedra have a point in common, exactly; also when a coordinate is not finite, since
/// nothing tells such a pair apart. Declared here for decision=exact and defined by the oracle
/// (harness/verify/oracle), so that this room includes nothing of that one.
bool meet_exactly(const std::array<std::array<double, 3>, 4>& a,
                  const std::array<std::array<double, 3>, 4>& b);

} // namespace tandem
