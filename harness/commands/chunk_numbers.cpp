// SPDX-License-Identifier: MIT
#include "harness/commands/chunk_numbers.h"

#include "algorithms/hierarchy/order.h"

namespace tandem {

std::vector<std::uint32_t> chunk_numbers(const Mesh& mesh) {
    constexpr std::uint32_t leaves = 32;
    const auto order = morton_order(mesh);
    std::vector<std::uint32_t> chunks(order.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) chunks[order[i]] = i / leaves;
    return chunks;
}

} // namespace tandem
