// SPDX-License-Identifier: MIT
#include "algorithms/published/host_trees.h"

#include "algorithms/orders/heap.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace tandem {

namespace {

constexpr std::size_t numbers = 24; ///< bytes of a node beside its slabs

/// Reads a copy, so that no compiler leaves it out.
void read(const std::vector<std::byte>& copy) {
    static_cast<void>(*static_cast<const volatile std::byte*>(&copy.back()));
}

} // namespace

HostTrees::HostTrees(const ChunkTrees& trees)
    : trees_(trees),
      slabs_(static_cast<std::size_t>(ends_of_node(trees.bodies().geometry()))
             * real_bytes(trees.bodies().geometry())),
      node_(slabs_ + numbers),
      bodies_(trees.bodies().count()) {
    for (std::uint32_t body = 0; body < bodies_.size(); ++body)
        for (const auto& level : trees.levels(body))
            for (std::uint32_t chunk = 0; chunk < level.chunks; ++chunk) {
                const auto first = chunk * trees.leaves();
                const auto items = std::min(trees.leaves(), level.items - first);
                const auto slot =
                    std::uint64_t{trees.first_slot(body)} + level.slot + heap::heap_slots(first);
                bodies_[body].push_back(
                    {slot + heap::root_node, 2 * items - 1,
                     std::vector<std::byte>((2 * std::size_t{std::bit_ceil(items)} - 1) * node_)});
            }
}

void HostTrees::store(std::span<const std::byte> nodes, Converter& converter) {
    converter.each(bodies_.size(), [&](std::size_t body) {
        for (auto& chunk : bodies_[body])
            for (std::size_t i = 0; i < chunk.count; ++i)
                std::memcpy(&chunk.nodes[i * node_], &nodes[(chunk.root + i) * slabs_], slabs_);
    });
}

void HostTrees::flatten(std::span<std::byte> nodes, Converter& converter) const {
    converter.each(bodies_.size(), [&](std::size_t body) {
        for (const auto& chunk : bodies_[body])
            for (std::size_t i = 0; i < chunk.count; ++i)
                std::memcpy(&nodes[(chunk.root + i) * slabs_], &chunk.nodes[i * node_], slabs_);
    });
}

void HostTrees::copy(std::span<const BodyPair> pairs, Converter& converter) const {
    constexpr int passes = 2;
    converter.each(pairs.size(), [&](std::size_t pair) {
        for (const auto body : {pairs[pair].a, pairs[pair].b})
            for (int pass = 0; pass < passes; ++pass)
                for (const auto& chunk : bodies_[body]) read(std::vector<std::byte>(chunk.nodes));
    });
}

} // namespace tandem
