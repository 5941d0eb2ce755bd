// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/stages.h"

namespace tandem {

/// Says how to get Embree where this program was built without; empty where it was built with it.
std::string_view embree_absence();

/// Throws DeviceError when Embree does not start. Not to be called where it is absent.
AlgorithmStages embree_stages(const BuildContext& ground);

namespace embree_counters {
inline constexpr Counter leaf_tests{"leaf_tests", "tetrahedron pairs",
                                    "leaf tests of what Embree handed over"};
} // namespace embree_counters

} // namespace tandem
