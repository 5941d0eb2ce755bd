// SPDX-License-Identifier: MIT
#include "algorithms/hierarchy/levels.h"

#include "algorithms/orders/heap.h"

#include <algorithm>
#include <bit>

namespace tandem {

std::uint32_t leaves_of_chunk_bytes(std::uint64_t bytes, int k) {
    const auto most = bytes / (4 * static_cast<std::uint64_t>(k) + 24) / 2;
    const auto perfect = std::bit_floor(std::clamp<std::uint64_t>(most, 4, 1u << 15));
    return static_cast<std::uint32_t>(perfect / 2);
}

std::vector<Level> chunk_levels(std::uint32_t tetrahedra, std::uint32_t leaves) {
    std::vector<Level> levels;
    std::uint32_t slot = 0;
    std::uint32_t items = tetrahedra;
    while (true) {
        const std::uint32_t chunks = items / leaves + (items % leaves != 0 ? 1u : 0u);
        levels.push_back({slot, items, chunks});
        if (chunks <= leaves) return levels;
        slot += heap::heap_slots(items);
        items = chunks;
    }
}

std::uint32_t slot_count(std::span<const Level> levels) {
    return levels.back().slot + heap::heap_slots(levels.back().items);
}

std::uint32_t ceil_log2(std::uint32_t n) { return static_cast<std::uint32_t>(std::bit_width(n - 1)); }

} // namespace tandem
