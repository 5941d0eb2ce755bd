// SPDX-License-Identifier: MIT
// Meshes made of grids of cubes.
#include "scenes/cubes.h"
#include "base/error.h"
#include "tests/support/test.h"

#include <bit>
#include <numbers>

namespace tandem {
namespace {

using Vector = Eigen::Vector3d;

TEST(ScenesCubes, BallsOfCubes) {
    for (const std::uint64_t cells : {1, 2, 3, 5, 8}) {
        const auto mesh = ball_of_cubes("ball", {1, 2, 4}, cells);
        EXPECT_EQ(mesh.vertices.size(), (cells + 1) * (cells + 1) * (cells + 1));
        EXPECT_EQ(mesh.tetrahedra.size(), 6 * cells * cells * cells);
        EXPECT_EQ(mesh.inverted + mesh.degenerate, 0u) << cells;
        std::size_t outside = 0;
        for (const auto& v : mesh.vertices) {
            const double length = v.cwiseQuotient(Vector(1, 2, 4)).norm();
            EXPECT_LT(length, 1 + 1e-15);
            outside += length > 1 - 1e-15 ? 1 : 0;
        }
        EXPECT_EQ(outside, 6 * cells * cells + 2);
    }
    EXPECT_NEAR(volume(ball_of_cubes("ball", {1, 1, 1}, 24)), 4 * std::numbers::pi / 3, 0.03);
    EXPECT_THROW(ball_of_cubes("ball", {1, 1, 1}, 1u << 15), InputError) << "beyond memory";
}

TEST(ScenesCubes, BoxesOfCubes) {
    const auto mesh = box_of_cubes("box", {3, 5, 7}, {1, 2, 3});
    EXPECT_EQ(mesh.vertices.size(), 2u * 3 * 4);
    EXPECT_EQ(mesh.vertices.front(), Vector(-1.5, -2.5, -3.5));
    EXPECT_EQ(mesh.vertices.back(), Vector(1.5, 2.5, 3.5));
    EXPECT_EQ(mesh.inverted + mesh.degenerate, 0u);
    EXPECT_DOUBLE_EQ(volume(mesh), 105);
    std::size_t faces = 0;
    for (const auto flags : mesh.boundary) faces += static_cast<std::size_t>(std::popcount(flags));
    EXPECT_EQ(faces, 2u * 2 * (2 + 6 + 3)) << "cubes conform";
}

} // namespace
} // namespace tandem
