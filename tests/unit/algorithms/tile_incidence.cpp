// SPDX-License-Identifier: MIT
// Table of tetrahedra that share a vertex, by pairs of tiles, against brute force over vertex numbers.
#include "algorithms/hierarchy/tile_incidence.h"
#include "tests/support/cells.h"
#include "tests/support/flawed.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using support::shaken_box;

constexpr std::size_t tile_size = TANDEM_LANES;

bool share_vertex(std::span<const std::uint32_t> tetrahedra, std::size_t a, std::size_t b) {
    const auto rest = tetrahedra.subspan(4 * b, 4);
    return std::ranges::any_of(tetrahedra.subspan(4 * a, 4), [&](std::uint32_t vertex) {
        return std::ranges::find(rest, vertex) != rest.end();
    });
}

/// The mask of tetrahedron `item` with those of tile `partner`.
std::uint32_t mask_by_brute_force(std::span<const std::uint32_t> tetrahedra, std::size_t item,
                                  std::size_t partner) {
    std::uint32_t mask = 0;
    for (std::size_t lane = 0; lane < tile_size; ++lane) {
        const auto other = tile_size * partner + lane;
        const auto leaves_out = other <= item || share_vertex(tetrahedra, item, other);
        if (4 * other < tetrahedra.size() && leaves_out) mask |= 1u << lane;
    }
    return mask;
}

/// Every mask of every pair of tiles, and that pairs without any are not stored.
void expect_right(std::span<const std::uint32_t> tetrahedra, std::size_t vertices) {
    const auto table = incidence_of(tetrahedra, vertices);
    const auto tiles = (tetrahedra.size() / 4 + tile_size - 1) / tile_size;
    ASSERT_EQ(table.starts.size(), tiles + 1);
    ASSERT_EQ(table.starts.front(), 0u);
    ASSERT_EQ(table.starts.back(), table.partners.size());
    ASSERT_EQ(table.masks.size(), tile_size * table.partners.size());
    std::size_t pair = 0;
    for (std::size_t tile = 0; tile < tiles; ++tile) {
        ASSERT_EQ(table.starts[tile], pair);
        for (auto partner = tile; partner < tiles; ++partner) {
            const auto count = std::min(tile_size, tetrahedra.size() / 4 - tile_size * tile);
            std::vector<std::uint32_t> masks;
            for (std::size_t lane = 0; lane < count; ++lane)
                masks.push_back(mask_by_brute_force(tetrahedra, tile_size * tile + lane, partner));
            if (std::ranges::all_of(masks, [](std::uint32_t mask) { return mask == 0; })) continue;
            ASSERT_LT(pair, table.partners.size());
            ASSERT_EQ(table.partners[pair], partner) << "of tile " << tile;
            for (std::size_t lane = 0; lane < count; ++lane)
                EXPECT_EQ(table.masks[tile_size * pair + lane], masks[lane])
                    << "tile " << tile << " with " << partner << ", lane " << lane;
            ++pair;
        }
    }
    EXPECT_EQ(pair, table.partners.size());
}

TEST(TileIncidence, MasksOfABoxAreThoseOfItsVertexNumbers) {
    Random random(1);
    const auto mesh = ordered(shaken_box(5, random), {.builder = Builder::sah});
    ASSERT_NE(mesh.ids.size() % tile_size, 0u); // the last tile is not full
    expect_right(mesh.tetrahedra, mesh.vertices.size());
}

/// Rows of tetrahedra with own vertices, but for one that the first, a middle and the last one share.
TEST(TileIncidence, FarTilesWithOneCommonVertexArePartners) {
    std::vector<std::uint32_t> tetrahedra(4 * 10 * tile_size);
    for (std::size_t i = 0; i < tetrahedra.size(); ++i) tetrahedra[i] = static_cast<std::uint32_t>(i);
    const auto last = tetrahedra.size() - 1;
    tetrahedra[4 * 5 * tile_size + 17] = tetrahedra[last] = 0;
    expect_right(tetrahedra, tetrahedra.size());
    const auto table = incidence_of(tetrahedra, tetrahedra.size());
    EXPECT_EQ(std::vector(table.partners.begin(), table.partners.begin() + 3),
              (std::vector<std::uint32_t>{0, 5, 9}));
    EXPECT_EQ(table.partners.size(), 10u + 3u);
    EXPECT_EQ(table.masks[tile_size], 1u << 4);
    EXPECT_EQ(table.masks[2 * tile_size], 1u << 31);
}

/// Only meshes of bodies that meet themselves have pairs. Numbers of tiles run over all meshes.
TEST(TileIncidence, TablesOfUnusedMeshesAreEmpty) {
    Random random(2);
    Scene scene;
    scene.meshes = {shaken_box(4, random), shaken_box(3, random)};
    scene.bodies = {{.mesh = 0}, {.mesh = 1, .deformable = true}};
    const Bodies bodies(support::device("host"), scene, {}, Bodies::Sharing::by_mesh);
    const auto tiles_of = [&](std::size_t mesh) {
        return (bodies.ordered_mesh(mesh).ids.size() + tile_size - 1) / tile_size;
    };
    const auto bytes_of_masks = [&](std::size_t mesh) {
        const auto& own = bodies.ordered_mesh(mesh);
        return 4 * incidence_of(own.tetrahedra, own.vertices.size()).masks.size();
    };
    const TileIncidence off(bodies, SelfPairs::off), some(bodies, SelfPairs::deformable),
        on(bodies, SelfPairs::on);
    EXPECT_LE(off.bytes(), 3 * 16u); // the least size of a buffer
    EXPECT_EQ(some.masks().bytes(), bytes_of_masks(1));
    EXPECT_EQ(on.masks().bytes(), bytes_of_masks(0) + bytes_of_masks(1));
    EXPECT_EQ(on.starts().bytes(), 4 * (tiles_of(0) + tiles_of(1) + 1));
    EXPECT_EQ(on.bytes(), on.masks().bytes() + on.partners().bytes() + on.starts().bytes());
    EXPECT_EQ(on.partners().bytes(), on.masks().bytes() / 32);
    std::vector<std::uint32_t> partners(some.partners().bytes() / 4);
    const StageScope scope(bodies.device(), Stage::read);
    bodies.device().download(some.partners(), std::as_writable_bytes(std::span(partners)));
    EXPECT_EQ(partners.front(), tiles_of(0));
}

} // namespace
} // namespace tandem
