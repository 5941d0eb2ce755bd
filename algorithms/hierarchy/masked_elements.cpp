// SPDX-License-Identifier: MIT
#include "algorithms/hierarchy/masked_elements.h"

#include "algorithms/orders/heap.h"

#include <algorithm>

namespace tandem {

namespace {

constexpr std::uint32_t no_children = 0xffffffffu; ///< NO_CHILDREN of refit.cl

void make_unique(std::vector<std::uint32_t>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

} // namespace

void MaskedElementsPlan::begin_round() {
    result_.starts.push_back(static_cast<std::uint32_t>(result_.rows.size() / 3));
}

/// Adds the rounds of one level: first its leaves over `items`, then one round per depth from the deepest
/// inner nodes up. Returns the chunks that change.
std::vector<std::uint32_t> MaskedElementsPlan::add_level(std::uint32_t first_slot,
                                                         std::span<const Level> levels, std::uint32_t index,
                                                         std::span<const std::uint32_t> items) {
    const auto& level = levels[index];
    const auto base = first_slot + level.slot;
    const auto depths = ceil_log2(leaves_);
    const auto chunk_slots = heap::heap_slots(leaves_);
    // Inner nodes by depth, as slots relative to `base`: the slots of all earlier chunks plus the heap index.
    std::vector<std::vector<std::uint32_t>> inner(depths + 1);
    std::vector<std::uint32_t> chunks;
    begin_round();
    for (const auto item : items) {
        const auto chunk = item / leaves_;
        const auto in_chunk = std::min(leaves_, level.items - chunk * leaves_);
        const auto node = heap::leaf_node(item % leaves_, in_chunk);
        const auto below = index == 0
                               ? no_children
                               : first_slot + levels[index - 1].slot + chunk_slots * item + heap::root_node;
        result_.rows.insert(result_.rows.end(), {base + chunk_slots * chunk + node, below, below});
        if (node != heap::root_node)
            inner[heap::depth_of(node) - 1].push_back(chunk_slots * chunk + heap::parent_of(node));
        chunks.push_back(chunk);
    }
    for (auto depth = depths; depth-- > 0;) {
        begin_round();
        make_unique(inner[depth]);
        for (const auto slot : inner[depth]) {
            const auto node = slot % chunk_slots;
            const auto child = base + slot - node + heap::first_child(node);
            result_.rows.insert(result_.rows.end(), {base + slot, child, child + 1});
            if (depth > 0) inner[depth - 1].push_back(slot - node + heap::parent_of(node));
        }
    }
    make_unique(chunks);
    return chunks;
}

void MaskedElementsPlan::add(std::uint32_t first_slot, std::span<const Level> levels,
                             std::vector<std::uint32_t> items) {
    ++result_.bodies;
    for (std::uint32_t index = 0; index < end_; ++index)
        if (index < levels.size())
            items = add_level(first_slot, levels, index, items);
        else
            for (std::uint32_t round = 0; round <= ceil_log2(leaves_); ++round) begin_round();
}

MaskedElements MaskedElementsPlan::take() {
    result_.rounds = end_ * (ceil_log2(leaves_) + 1);
    begin_round();
    return std::move(result_);
}

} // namespace tandem
