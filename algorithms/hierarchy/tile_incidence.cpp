// SPDX-License-Identifier: MIT
#include "algorithms/hierarchy/tile_incidence.h"

#include "algorithms/bodies/self_pairs.h"
#include "backends/upload.h"

#include <algorithm>

namespace tandem {

namespace {

constexpr std::uint32_t mask_bits = TANDEM_LANES;     ///< tetrahedra of a tile
constexpr std::uint32_t tile_corners = 4 * mask_bits; ///< vertex numbers of a tile

/// The tetrahedra of a tile that have a vertex, as bits.
struct TileOfVertex {
    std::uint32_t tile = 0, bits = 0;
};

/// By vertex: its tiles, ascending.
std::vector<std::vector<TileOfVertex>> tiles_by_vertex(std::span<const std::uint32_t> tetrahedra,
                                                       std::size_t vertices) {
    std::vector<std::vector<TileOfVertex>> result(vertices);
    for (std::size_t i = 0; i < tetrahedra.size(); ++i) {
        auto& tiles = result[tetrahedra[i]];
        const auto tile = static_cast<std::uint32_t>(i / tile_corners);
        if (tiles.empty() || tiles.back().tile != tile) tiles.push_back({tile, 0});
        tiles.back().bits |= 1u << i / 4 % mask_bits;
    }
    return result;
}

/// The part of `tiles` from `first` on.
std::span<const TileOfVertex> from(std::span<const TileOfVertex> tiles, std::uint32_t first) {
    return tiles.subspan(static_cast<std::size_t>(
        std::ranges::lower_bound(tiles, first, {}, &TileOfVertex::tile) - tiles.begin()));
}

void append(std::vector<std::uint32_t>& to, std::span<const std::uint32_t> values, std::uint32_t offset = 0) {
    for (const auto value : values) to.push_back(value + offset);
}

} // namespace

IncidenceTable incidence_of(std::span<const std::uint32_t> tetrahedra, std::size_t vertices) {
    const auto by_vertex = tiles_by_vertex(tetrahedra, vertices);
    IncidenceTable table;
    std::vector<std::size_t> pair_of((tetrahedra.size() + tile_corners - 1) / tile_corners); // by partner
    for (std::uint32_t tile = 0; tile < pair_of.size(); ++tile) {
        const auto first = table.partners.size();
        table.starts.push_back(static_cast<std::uint32_t>(first));
        const auto own = tetrahedra.subspan(std::size_t{tile} * tile_corners);
        const auto count = std::min<std::size_t>(own.size(), tile_corners);
        std::vector<std::uint32_t> partners;
        for (const auto vertex : own.first(count))
            for (const auto& other : from(by_vertex[vertex], tile)) partners.push_back(other.tile);
        std::ranges::sort(partners);
        // No std::ranges::unique: clang 14 does not compile the one of g++ 12.
        partners.erase(std::unique(partners.begin(), partners.end()), partners.end());
        for (std::size_t i = 0; i < partners.size(); ++i) pair_of[partners[i]] = first + i;
        append(table.partners, partners);
        table.masks.resize(mask_bits * table.partners.size());
        for (std::size_t i = 0; i < count; ++i)
            for (const auto& other : from(by_vertex[own[i]], tile))
                table.masks[mask_bits * pair_of[other.tile] + i / 4] |= other.bits;
        for (std::uint32_t lane = 0; lane < mask_bits; ++lane)
            table.masks[mask_bits * first + lane] |= ~0u >> (mask_bits - 1 - lane);
    }
    table.starts.push_back(static_cast<std::uint32_t>(table.partners.size()));
    return table;
}

TileIncidence::TileIncidence(const Bodies& bodies, SelfPairs self) {
    const auto& scene = bodies.scene();
    std::vector<bool> is_needed(scene.meshes.size());
    for (std::uint32_t body = 0; body < bodies.count(); ++body)
        if (meets_itself(scene, body, self)) is_needed[scene.bodies[body].mesh] = true;
    IncidenceTable all;
    std::uint32_t row = 0; // of a mesh's first tile
    for (std::size_t mesh = 0; mesh < scene.meshes.size(); ++mesh) {
        const auto& ordered = bodies.ordered_mesh(mesh);
        const auto tiles = static_cast<std::uint32_t>((ordered.ids.size() + mask_bits - 1) / mask_bits);
        const auto first = static_cast<std::uint32_t>(all.partners.size());
        auto own = is_needed[mesh] ? incidence_of(ordered.topology(), scene.meshes[mesh].vertices.size())
                                   : IncidenceTable{std::vector<std::uint32_t>(tiles + 1), {}, {}};
        own.starts.pop_back();
        append(all.starts, own.starts, first);
        append(all.partners, own.partners, row);
        append(all.masks, own.masks);
        row += tiles;
    }
    all.starts.push_back(static_cast<std::uint32_t>(all.partners.size()));
    if (all.partners.empty()) all = {{0}, {0}, {0}}; // buffers cannot be empty
    starts_ = uploaded(bodies.device(), bytes_of(all.starts), "pairs of incident tiles, starts");
    partners_ = uploaded(bodies.device(), bytes_of(all.partners), "pairs of incident tiles");
    masks_ = uploaded(bodies.device(), bytes_of(all.masks), "masks of incident tetrahedra");
}

} // namespace tandem
