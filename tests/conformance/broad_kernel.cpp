// SPDX-License-Identifier: MIT
// The kernels of the device's broad phase: their body pairs against those of a double loop over the root
// volumes on the device.
#include "tests/support/broad.h"
#include "tests/support/on_device.h"

namespace tandem {
namespace {

using namespace support;

/// A cube from 0 to 1 along each axis.
Mesh unit_cube() {
    Random random(1);
    auto cube = shaken_box(1, random);
    for (auto& v : cube.vertices)
        for (int i = 0; i < 3; ++i) v[i] = v[i] < 0 ? 0 : 1;
    return cube;
}

/// side x side x side cubes that touch their neighbours without overlapping in depth.
Scene lattice(std::uint32_t side) {
    std::vector<Eigen::Vector3d> positions;
    for (std::uint32_t i = 0; i < side * side * side; ++i)
        positions.emplace_back(i % side, i / side % side, i / side / side);
    return still_scene(unit_cube(), {positions});
}

/// A row of cubes that touch along x; frame 1 reverses the row.
Scene row_of_cubes(std::uint32_t bodies) {
    std::vector<std::vector<Eigen::Vector3d>> positions(2);
    for (std::uint32_t i = 0; i < bodies; ++i) {
        positions[0].emplace_back(i, 0, 0);
        positions[1].emplace_back(bodies - i, 0, 0);
    }
    return still_scene(unit_cube(), positions);
}

class BroadKernel : public OnDevice {};

TEST_P(BroadKernel, EqualsADoubleLoopOverTheRootVolumes) {
    for (const auto& geometry : {Geometry{}, Geometry{.k = 8}, Geometry{.k = 8, .precision = Precision::fp64},
                                 Geometry{.k = 18, .precision = Precision::fp64}}) {
        const auto scene = crowd(77, 40, 2.5);
        Search search(on, scene, geometry, 64, 100);
        search.sort_by(0);
        for (std::size_t frame = 0; frame < scene.frame_count; ++frame) {
            search.go_to(frame);
            const auto pairs = search.expected().size();
            EXPECT_GT(pairs, 20u);
            EXPECT_LT(pairs, all_pairs(scene).size() / 2);
            search.expect_right();
        }
    }
}

/// 25 tiles, several per work-group, in batches of as many as the group has work-items. The sorting order is
/// out of date. Every third body is fixed, so some tiles are fixed partly and others completely.
TEST_P(BroadKernel, ManyTilesInAnyOrder) {
    const auto scene = gravel(3, 800, 12, 3);
    for (const std::uint32_t groups : {1u, 7u, 100000u}) {
        for (const std::uint32_t group_size : {1u, 8u, 32u}) {
            Search search(on, scene, {}, group_size, groups);
            for (const std::size_t order : {0u, 1u}) {
                search.sort_by(order);
                search.go_to(1 - order);
                EXPECT_GT(search.expected().size(), 400u);
                search.expect_right();
            }
        }
    }
}

TEST_P(BroadKernel, TouchingOverlaps) {
    const auto scene = lattice(5);
    for (const auto& geometry : {Geometry{}, Geometry{.precision = Precision::fp64}}) {
        Search search(on, scene, geometry, 32, 100);
        search.sort_by(0);
        search.go_to(0);
        // Neighbours share a face, an edge or a corner: ((3 * 5 - 2)^3 - 5^3) / 2.
        EXPECT_EQ(search.expected().size(), 1036u);
        search.expect_right();
    }
}

/// Unions of tiles that only touch, from either side.
TEST_P(BroadKernel, TouchingTilesOverlap) {
    const auto scene = row_of_cubes(100);
    Search search(on, scene, {}, 32, 100);
    for (const std::size_t order : {0u, 1u}) {
        for (const std::size_t frame : {0u, 1u}) {
            search.sort_by(order);
            search.go_to(frame);
            EXPECT_EQ(search.expected().size(), 99u);
            search.expect_right();
        }
    }
}

TEST_P(BroadKernel, FixedBodiesPairWithMovingOnesOnly) {
    for (const std::uint32_t moving : {0u, 1u, 33u}) {
        auto scene = lattice(4);
        for (std::size_t i = moving; i < scene.bodies.size(); ++i) scene.bodies[i].fixed = true;
        Search search(on, scene, {}, 32, 100);
        search.sort_by(0);
        search.go_to(0);
        EXPECT_EQ(search.expected().empty(), moving == 0);
        search.expect_right();
    }
}

TEST_P(BroadKernel, OneBodyHasNoPairs) {
    const auto scene = still_scene(one_tetrahedron(), {{Eigen::Vector3d(1, 2, 3)}});
    Search search(on, scene, {}, 32, 100);
    search.sort_by(0);
    search.go_to(0);
    search.expect_right();
}

TEST_P(BroadKernel, NothingIsWrittenPastTheCapacity) {
    const auto scene = gravel(9, 200, 6, 1000);
    Search search(on, scene, {}, 32, 100);
    search.sort_by(0);
    search.go_to(0);
    const auto right = search.expected();
    const auto all = static_cast<std::uint32_t>(right.size());
    ASSERT_GT(all, 100u);
    for (const std::uint32_t capacity : {1u, all - 1, all, all + 1}) {
        std::uint64_t count = 0;
        const auto found = search.found(capacity, count);
        EXPECT_EQ(count, all);
        EXPECT_EQ(found.size(), std::min(capacity, all));
        EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
        EXPECT_TRUE(std::includes(right.begin(), right.end(), found.begin(), found.end()));
    }
}

TANDEM_ON_DEVICES(BroadKernel);

} // namespace
} // namespace tandem
