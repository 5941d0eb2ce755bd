// SPDX-License-Identifier: MIT
#include "algorithms/leaf_query/partner_lists.h"

#include <algorithm>

namespace tandem {

std::vector<std::uint32_t> partner_lists(std::span<const BodyPair> pairs, std::uint32_t bodies) {
    std::vector<std::uint32_t> table(std::size_t{bodies} + 1 + 2 * pairs.size());
    for (const auto& pair : pairs) {
        ++table[pair.a];
        if (pair.a != pair.b) ++table[pair.b];
    }
    std::uint32_t next = bodies + 1;
    for (std::uint32_t body = 0; body <= bodies; ++body) next += std::exchange(table[body], next);
    table.resize(next);
    std::vector<std::uint32_t> at(table.begin(), table.begin() + bodies);
    for (const auto& pair : pairs) {
        table[at[pair.a]++] = pair.b;
        if (pair.a != pair.b) table[at[pair.b]++] = pair.a;
    }
    for (std::uint32_t body = 0; body < bodies; ++body)
        std::sort(table.begin() + table[body], table.begin() + table[body + 1]);
    return table;
}

void PartnerLists::upload(std::span<const BodyPair> pairs, std::uint32_t bodies) {
    std::vector<std::uint32_t> table;
    {
        const HostWork work(device_, Stage::broad, "partners of bodies");
        table = partner_lists(pairs, bodies);
    }
    if (table.size() > table_.capacity()) table_.grow(table.size());
    const StageScope scope(device_, Stage::write);
    device_.upload(table_.buffer(), bytes_of(table));
}

} // namespace tandem
