// SPDX-License-Identifier: MIT
#include "python/core/meeting.h"

#include "base/parallel.h"
#include "geometry/meet_exactly.h"

#include <algorithm>
#include <iterator>

namespace tandem::python {

std::vector<Pair> meeting_of(const oracle::World& world, std::span<const Pair> pairs) {
    const auto parts = in_parts(pairs);
    std::vector<std::vector<Pair>> found(parts.size());
    parallel_for(parts.size(), [&](std::size_t part) {
        std::ranges::copy_if(parts[part], std::back_inserter(found[part]), [&](const Pair& pair) {
            return meet_exactly(world[pair.body_a][pair.tet_a], world[pair.body_b][pair.tet_b]);
        });
    });
    std::vector<Pair> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    return all;
}

} // namespace tandem::python
