// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/pipeline/stages.h"

namespace tandem {

/// How to get cuBQL if this program was built without it; empty otherwise.
std::string_view cubql_absence();

/// Builds a tree for each mesh on the device. Throws OutOfMemory or DeviceError. Must not be called if cuBQL
/// is absent.
AlgorithmStages cubql_stages(const BuildContext& context);

namespace cubql_counters {
inline constexpr Counter leaf_tests{
    "leaf_tests", "tetrahedron pairs",
    "tests of a query's box against tetrahedra of the leaves that it reaches"};
} // namespace cubql_counters

} // namespace tandem
