// SPDX-License-Identifier: MIT
// refit.cl and the host agree on the number of strips of a work-group, and every team gets at least one.
#include "algorithms/hierarchy/strips.h"
#include "tests/support/test.h"

#include <bit>

namespace tandem {
namespace {

TEST(Strips, AGroupProcessesTheStripsOfItsTeams) {
    for (const int k : {6, 8, 12, 14, 16, 18, 20, 24, 26})
        for (const auto precision : {Precision::fp32, Precision::fp64})
            for (std::uint32_t given = 1; given <= 1024; ++given) {
                const Geometry geometry{.k = k, .precision = precision};
                const auto shape = refit_shape(geometry, given);
                ASSERT_LE(shape.group_size, given);
                ASSERT_GE(2 * shape.group_size, std::min(given, 64u) + 1)
                    << "more than half of a small group";
                // As in portable.h and refit.cl.
                const auto team = shape.group_size % 32 == 0 ? 32 : shape.group_size;
                const auto teams = shape.group_size / team;
                const auto team_nodes = shape.tile_nodes / teams;
                for (std::uint32_t height = 0; height <= strip_height; ++height) {
                    const auto taken = teams * std::min(team_nodes >> (height + 1), team_nodes / 16);
                    ASSERT_EQ(strips_of_group(shape, height), taken) << k << " " << given << " " << height;
                    ASSERT_GE(taken, teams);
                }
                const auto reals = static_cast<std::uint32_t>(k) + 2; // a node and its padding
                ASSERT_LE(shape.tile_nodes * (reals * real_bytes(geometry)), 32u << 10);
            }
}

TEST(Strips, LargeNodesOfFullGroupsKeepTheirGroup) {
    EXPECT_EQ(refit_shape({.k = 18}, 128).group_size, 128u);
    EXPECT_EQ(refit_shape({.k = 18}, 128).tile_nodes, 256u);
    EXPECT_EQ(refit_shape({.k = 8}, 1024).group_size, 128u);
    EXPECT_EQ(refit_shape({.k = 18, .precision = Precision::fp64}, 128).group_size, 64u);
    EXPECT_EQ(refit_shape({.k = 18}, 96).group_size, 64u);
}

} // namespace
} // namespace tandem
