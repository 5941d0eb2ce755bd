// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/pipeline/stages.h"

namespace tandem {

/// How to get Embree if this program was built without it; empty otherwise.
std::string_view embree_absence();

/// Throws DeviceError when Embree does not start. Must not be called if Embree is absent.
AlgorithmStages embree_stages(const BuildContext& context);

namespace embree_counters {
inline constexpr Counter leaf_tests{"leaf_tests", "tetrahedron pairs",
                                    "leaf tests of pairs that Embree found"};
} // namespace embree_counters

} // namespace tandem
