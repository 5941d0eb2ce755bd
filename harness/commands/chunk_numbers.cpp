// SPDX-License-Identifier: MIT
#include "harness/commands/chunk_numbers.h"

#include "algorithms/orders/order.h"

namespace tandem {

std::vector<std::uint32_t> chunk_numbers(const Mesh& mesh) {
    constexpr std::uint32_t leaves = 32;
    const auto order = ordered(mesh).ids;
    // A merged duplicate is in no chunk: it has the number behind the last one.
    const auto behind = static_cast<std::uint32_t>((order.size() + leaves - 1) / leaves);
    std::vector<std::uint32_t> chunks(mesh.tetrahedra.size(), behind);
    for (std::uint32_t i = 0; i < order.size(); ++i) chunks[order[i]] = i / leaves;
    return chunks;
}

} // namespace tandem
