// SPDX-License-Identifier: MIT
// heap.clh for the host: one text says where nodes are.
#pragma once

#include <bit>
#include <cstdint>

namespace tandem::heap {

using uint = std::uint32_t;

#define DEVICE inline
#define COUNT_LEADING_ZEROS(value) static_cast<uint>(std::countl_zero(value))
#include "algorithms/hierarchy/heap.clh"
#undef DEVICE
#undef COUNT_LEADING_ZEROS
#undef ROOT_NODE

inline constexpr uint root_node = 1;

/// How far below the root a node is.
inline uint depth_of(uint node) { return static_cast<uint>(std::bit_width(node)) - 1; }

} // namespace tandem::heap
