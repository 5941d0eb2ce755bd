// SPDX-License-Identifier: MIT
#include "base/error.h"
#include "scenes/overlap.h"
#include "scenes/shapes.h"
#include "tests/support/test.h"

#include <bit>

namespace tandem {
namespace {

constexpr double pi = 3.14159265358979323846;

std::size_t boundary_faces(const Mesh& mesh) {
    std::size_t count = 0;
    for (const auto flags : mesh.boundary) count += static_cast<std::size_t>(std::popcount(flags));
    return count;
}

void expect_counts(const Mesh& mesh, std::size_t vertices, std::size_t tetrahedra, std::size_t faces) {
    EXPECT_EQ(mesh.vertices.size(), vertices);
    EXPECT_EQ(mesh.tetrahedra.size(), tetrahedra);
    EXPECT_EQ(boundary_faces(mesh), faces);
    EXPECT_EQ(mesh.inverted + mesh.degenerate, 0u);
}

TEST(ScenesShapes, Box) {
    const auto mesh = box({2, 3, 4});
    expect_counts(mesh, 9, 12, 12);
    EXPECT_DOUBLE_EQ(volume(mesh), 24);
    EXPECT_TRUE(mesh.vertices.back().isZero());
    EXPECT_THROW(box({2, 1e-7, 4}), InputError) << "flat in single precision";
}

TEST(ScenesShapes, HexahedraInARowConform) {
    std::array<Eigen::Vector3d, 8> corners;
    for (unsigned c = 0; c < 8; ++c)
        corners[c] = {static_cast<double>(c & 1), static_cast<double>(c >> 1 & 1),
                      static_cast<double>(c >> 2)};
    const auto one = hexahedron(corners);
    expect_counts(one, 8, 6, 12);
    EXPECT_DOUBLE_EQ(volume(one), 1);
    // Two in a row along any axis, with merged common vertices: 2 x 12 faces minus 2 x 2.
    for (unsigned axis = 0; axis < 3; ++axis) {
        auto row = one;
        for (const auto& v : one.vertices) row.vertices.push_back(v + Eigen::Vector3d::Unit(axis));
        for (const auto& t : one.tetrahedra) {
            Tetrahedron next{};
            for (std::size_t i = 0; i < 4; ++i) {
                const bool near = (t[i] >> axis & 1) == 0;
                next[i] = near ? t[i] | 1u << axis : t[i] + 8;
            }
            row.tetrahedra.push_back(next);
        }
        complete_mesh(row, "row");
        EXPECT_EQ(boundary_faces(row), 20u) << axis;
        EXPECT_EQ(row.inverted, 0u);
    }
    std::swap(corners[0], corners[1]);
    EXPECT_THROW(hexahedron(corners), InputError);
}

TEST(ScenesShapes, SphereAndDrum) {
    const auto ball = sphere(1.5, 12, 12);
    expect_counts(ball, 135, 264, 264);
    EXPECT_NEAR(volume(ball), 4 * pi / 3 * 1.5 * 1.5 * 1.5, 1);
    for (std::size_t v = 0; v + 1 < ball.vertices.size(); ++v)
        EXPECT_NEAR(ball.vertices[v].norm(), 1.5, 1e-5);
    const auto prism = drum(12, 2, 1, 3);
    expect_counts(prism, 27, 48, 48);
    // A frustum of regular 12-gons, whose area is 3 r^2; the sides are cut into plane trapezoids.
    EXPECT_NEAR(volume(prism), 3 * (4 + 2 + 1), 1e-4);
}

TEST(ScenesShapes, CoordinatesAreSinglePrecisionOnAGrid) {
    EXPECT_EQ(on_grid(1.0 / 3), 87381 / 262144.0);
    EXPECT_EQ(halved_on_grid(1.0 / 3), 2 * 43691 / 262144.0);
    for (const auto& v : drum(7, 0.37, 0.11, 0.9).vertices)
        for (const double x : v) {
            EXPECT_EQ(x * 0x1p18, std::round(x * 0x1p18));
            EXPECT_EQ(static_cast<double>(static_cast<float>(x)), x);
        }
}

const Corners3 unit_corner = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

Corners3 moved(const Corners3& t, const Eigen::Vector3d& by) {
    return {t[0] + by, t[1] + by, t[2] + by, t[3] + by};
}

TEST(ScenesOverlap, Tetrahedra) {
    EXPECT_TRUE(overlap(unit_corner, unit_corner, 1e-9));
    EXPECT_TRUE(overlap(unit_corner, moved(unit_corner, {0.9, 0, 0}), 1e-9));
    EXPECT_FALSE(overlap(unit_corner, moved(unit_corner, {0.9, 0, 0}), 0.2)) << "less than the slack";
    EXPECT_FALSE(overlap(unit_corner, moved(unit_corner, {1, 0, 0}), 1e-9)) << "touching";
    EXPECT_FALSE(overlap(unit_corner, moved(unit_corner, {0.4, 0.4, 0.4}), 1e-9)) << "boxes overlap";
    // Edges that pass each other: only the cross product of an edge of each separates them.
    const Corners3 low = {{{-1, 0, 0}, {1, 0, 0}, {0, 0.2, -1}, {0, -0.2, -1.3}}};
    const Corners3 high = {{{0, -1, 0.05}, {0, 1, 0.05}, {0.2, 0, 1}, {-0.2, 0, 1.3}}};
    EXPECT_FALSE(overlap(low, high, 1e-9));
    EXPECT_TRUE(overlap(low, moved(high, {0, 0, -0.1}), 1e-9));
}

TEST(ScenesOverlap, Bodies) {
    Scene scene;
    scene.meshes = {box({1, 1, 1})};
    scene.bodies = {{.mesh = 0, .fixed = true}, {.mesh = 0}, {.mesh = 0, .fixed = true}};
    Frame frame;
    frame.poses = {{.translation = {5, 0, 0}}, {.translation = {0.5, 0, 0}}, {.translation = {1.4, 0, 0}}};
    frame.deformed.resize(3);
    using Found = std::optional<std::array<std::size_t, 2>>;
    EXPECT_EQ(first_overlap(scene, frame), (Found{{1, 2}}));
    EXPECT_EQ(first_overlap(scene, frame, true), std::nullopt) << "one of them may move";
    frame.poses[0].translation = {2.3, 0, 0};
    EXPECT_EQ(first_overlap(scene, frame, true), (Found{{0, 2}}));
    frame.poses[0].translation = {2.4, 0, 0};
    EXPECT_EQ(first_overlap(scene, frame, true), std::nullopt) << "touching";
    frame.poses = {{.translation = {0.2, 0, 0}}, {.translation = {1, 0, 0}}, {.translation = {1.5, 0, 0}}};
    EXPECT_EQ(first_overlap(scene, frame), (Found{{0, 1}})) << "not the last, 1 and 2";
}

} // namespace
} // namespace tandem
