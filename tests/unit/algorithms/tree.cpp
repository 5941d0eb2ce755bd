// SPDX-License-Identifier: MIT
#include "algorithms/hierarchy/levels.h"
#include "algorithms/orders/order.h"
#include "scenes/builtin.h"
#include "scenes/scene.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using support::tetrahedra_at;

TEST(Morton, InterleavesXFirst) {
    EXPECT_EQ(morton_code(0, 0, 0), 0u);
    EXPECT_EQ(morton_code(1, 0, 0), 4u);
    EXPECT_EQ(morton_code(0, 1, 0), 2u);
    EXPECT_EQ(morton_code(0, 0, 1), 1u);
    EXPECT_EQ(morton_code(2, 0, 0), 32u);
    EXPECT_EQ(morton_code(3, 5, 1), 0b010'100'111u);
    const auto most = (1u << 21) - 1;
    EXPECT_EQ(morton_code(most, most, most), (std::uint64_t{1} << 63) - 1);
}

TEST(Morton, OrdersAlongTheCurve) {
    // Cells of a 2 x 2 x 2 grid are in the order of their codes: z fastest, then y, then x.
    std::vector<Eigen::Vector3d> positions;
    for (int i : {6, 1, 7, 0, 3, 5, 2, 4})
        positions.emplace_back(10.0 * (i >> 2), 10.0 * (i >> 1 & 1), 10.0 * (i & 1));
    const auto order = morton_order(tetrahedra_at(positions));
    const std::vector<std::uint32_t> expected{3, 1, 6, 4, 7, 5, 0, 2};
    EXPECT_EQ(order, expected);
}

TEST(Morton, HandlesExtremeMeshes) {
    const auto check = [](const Mesh& mesh) {
        auto order = morton_order(mesh);
        std::sort(order.begin(), order.end());
        std::vector<std::uint32_t> all(mesh.tetrahedra.size());
        std::iota(all.begin(), all.end(), 0u);
        EXPECT_EQ(order, all);
    };
    check(tetrahedra_at({{0, 0, 0}}));
    check(tetrahedra_at({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}));            // duplicate centroids
    check(tetrahedra_at({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}})); // planar
    check(tetrahedra_at({{-1e9, -1e9, -1e9}, {-1e9 + 1, -1e9, -1e9}})); // far away and negative
    check(tetrahedra_at({{0, 0, 0}, {1e-310, 0, 0}}, 1e-310));          // denormal extent
    check(tetrahedra_at({{0, 0, 0}, {1e300, 0, 0}}));                   // huge extent
}

TEST(Morton, TiesKeepInputOrder) {
    const auto order = morton_order(tetrahedra_at({{5, 5, 5}, {5, 5, 5}, {5, 5, 5}}));
    EXPECT_EQ(order, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(Chunks, SizesOfThePaper) {
    EXPECT_EQ(leaves_of_chunk_bytes(8000, 8), 32u); // 8000 / 56 = 142, / 2 = 71, lower power 64, L = 32
    EXPECT_EQ(leaves_of_chunk_bytes(8192, 8), 32u);
    EXPECT_EQ(leaves_of_chunk_bytes(8000, 18), 16u); // 8000 / 96 = 83, / 2 = 41, 32, L = 16
    EXPECT_EQ(leaves_of_chunk_bytes(1, 8), 2u);
    const auto glass = chunk_levels(1682, 32);
    ASSERT_EQ(glass.size(), 2u);
    EXPECT_EQ(glass[0].chunks, 53u);
    EXPECT_EQ(glass[1].items, 53u);
    EXPECT_EQ(glass[1].chunks, 2u);
    const auto jack = chunk_levels(2337, 32);
    EXPECT_EQ(jack[0].chunks, 74u);
    EXPECT_EQ(jack[1].chunks, 3u);
    const auto box = chunk_levels(12, 32);
    ASSERT_EQ(box.size(), 1u);
    EXPECT_EQ(box[0].chunks, 1u);
}

TEST(Chunks, LevelsStackUntilAtMostLChunksAreLeft) {
    const auto levels = chunk_levels(100'000'000, 32);
    ASSERT_EQ(levels.size(), 5u); // 3,125,000 97,657 3,052 96 3
    EXPECT_EQ(levels[0].chunks, 3'125'000u);
    EXPECT_EQ(levels.back().chunks, 3u);
    EXPECT_EQ(slot_count(levels), 2u * (100'000'000u + 3'125'000u + 97'657u + 3'052u + 96u));
    EXPECT_EQ(chunk_levels(1, 2).size(), 1u);
    EXPECT_EQ(chunk_levels(1024, 32).size(), 1u);
    EXPECT_EQ(chunk_levels(1025, 32).size(), 2u);
}

TEST(Chunks, CeilLog2) {
    EXPECT_EQ(ceil_log2(1), 0u);
    EXPECT_EQ(ceil_log2(2), 1u);
    EXPECT_EQ(ceil_log2(3), 2u);
    EXPECT_EQ(ceil_log2(32), 5u);
    EXPECT_EQ(ceil_log2(33), 6u);
}

TEST(OrderedMesh, KeepsEveryTetrahedron) {
    const auto mesh = built_in_mesh("jack");
    const auto result = ordered(mesh);
    ASSERT_EQ(result.ids.size(), mesh.tetrahedra.size());
    EXPECT_EQ(result.vertices.size(), mesh.vertices.size());
    for (std::size_t i = 0; i < result.ids.size(); ++i) {
        EXPECT_EQ(result.boundary[i], mesh.boundary[result.ids[i]]);
        for (std::size_t corner = 0; corner < 4; ++corner)
            EXPECT_EQ(result.vertices[result.tetrahedra[4 * i + corner]],
                      mesh.tetrahedra[result.ids[i]][corner]);
    }
}

} // namespace
} // namespace tandem
