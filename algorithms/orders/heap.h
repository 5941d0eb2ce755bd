// SPDX-License-Identifier: MIT
// Host version of heap.clh, so that kernels and host share one definition of node positions.
#pragma once

#include <bit>
#include <cstdint>

namespace tandem::heap {

using uint = std::uint32_t;

#define DEVICE inline
#define COUNT_LEADING_ZEROS(value) static_cast<uint>(std::countl_zero(value))
#include "algorithms/orders/heap.clh"
#undef DEVICE
#undef COUNT_LEADING_ZEROS
#undef ROOT_NODE

inline constexpr uint root_node = 1;

/// Depth of a node below the root.
inline uint depth_of(uint node) { return static_cast<uint>(std::bit_width(node)) - 1; }

} // namespace tandem::heap
