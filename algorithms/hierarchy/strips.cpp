// SPDX-License-Identifier: MIT
#include "algorithms/hierarchy/strips.h"

#include <algorithm>
#include <bit>

namespace tandem {

namespace {

constexpr std::uint32_t most_refitting =
    128;                           ///< work-items per group; of larger groups too few fit on a compute unit
constexpr std::uint32_t team = 32; ///< TEAM_SIZE of portable.h, unless a team is the whole group
constexpr std::uint64_t tile_bytes = 32 << 10;
constexpr std::uint32_t strip_nodes = 2u << strip_height;

/// Two leaves (in_pairs) or one for each work-item. At least one strip and at most what fits.
std::uint32_t tile_nodes(const Geometry& geometry, std::uint32_t group_size) {
    const auto node = static_cast<std::uint64_t>(ends_of_node(geometry) + 2) * real_bytes(geometry) + 8;
    const auto wanted = std::max(strip_nodes, (in_pairs(geometry) ? 4 : 2) * group_size);
    return std::min(wanted, static_cast<std::uint32_t>(std::bit_floor(tile_bytes / node)));
}

} // namespace

RefitShape refit_shape(const Geometry& geometry, std::uint32_t group_size) {
    auto group = std::bit_floor(std::min(group_size, most_refitting));
    // If nodes are large, the tile has no capacity for a strip of each team.
    while (group > team && tile_nodes(geometry, group) / (group / team) < strip_nodes) group /= 2;
    return {group, tile_nodes(geometry, group)};
}

std::uint32_t strips_of_group(const RefitShape& shape, std::uint32_t height) {
    return std::min(shape.tile_nodes >> (height + 1), shape.tile_nodes / 16); // MOST_STRIPS of refit.cl
}

} // namespace tandem
