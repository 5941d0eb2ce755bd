// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace tandem {

/// Work-groups of launches.
struct LaunchShape {
    std::uint32_t group_size = 1; ///< work-items per group
    std::uint32_t groups = 1;     ///< for kernels with strided loops
};

} // namespace tandem
