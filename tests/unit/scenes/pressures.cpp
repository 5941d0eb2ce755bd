// SPDX-License-Identifier: MIT
// Pressure fields that MeshReading::pressure makes, and fields that meshes keep.
#include "scenes/pressure_field.h"
#include "scenes/hard/solids.h"
#include "scenes/refine.h"
#include "scenes/shapes.h"
#include "tests/support/message_of.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using testing::HasSubstr;

/// The distance of a vertex of angle() from its boundary.
double distance_in_angle(const Eigen::Vector3d& v) {
    const double x = v.x(), y = v.y();
    const double outer = std::min({4 + x, 4 + y, 4 - std::abs(v.z()), 4 - std::max(x, y)});
    return std::min(outer, x <= 0 && y <= 0 ? std::hypot(x, y) : -std::min(x, y));
}

/// A cube of 8 x 8 x 8 cells of size 1 about the origin, without the quarter of x > 0 and y > 0: its inner
/// edge is the z axis. Inner vertices are moved along z, so that none is beside a vertex of that edge.
Mesh angle() {
    auto mesh = hard::grid({8, 8, 8}, {8, 8, 8});
    std::erase_if(mesh.tetrahedra, [&](const Tetrahedron& t) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const auto vertex : t) sum += mesh.vertices[vertex];
        return sum.x() > 0 && sum.y() > 0;
    });
    for (auto& v : mesh.vertices)
        if (distance_in_angle(v) > 0) v.z() += 0.25;
    complete_mesh(mesh, "angle");
    return mesh;
}

TEST(ScenesPressures, AreProportionalToTheDistanceFromTheBoundary) {
    auto mesh = hard::grid({8, 6, 4}, {8, 6, 4});
    make_pressures(mesh, 10);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const Eigen::Vector3d to_faces = Eigen::Vector3d(4, 3, 2) - mesh.vertices[v].cwiseAbs();
        EXPECT_EQ(mesh.pressures[v], 5 * to_faces.minCoeff()) << v;
    }
}

/// Distances from edges, and vertices of no tetrahedron.
TEST(ScenesPressures, OfAnAngle) {
    auto mesh = angle();
    make_pressures(mesh, 1e6);
    std::size_t compared = 0, near_edge = 0;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const auto& at = mesh.vertices[v];
        EXPECT_LE(mesh.pressures[v], 1e6);
        if (at.x() > 0 && at.y() > 0) continue;
        EXPECT_DOUBLE_EQ(mesh.pressures[v], 1e6 * (distance_in_angle(at) / 2)) << at.transpose();
        ++compared;
        near_edge += at.x() == -1 && at.y() == -1 && std::abs(at.z()) < 2 ? 1 : 0;
    }
    EXPECT_EQ(compared, 9u * (81 - 16));
    EXPECT_EQ(near_edge, 4u);
}

/// Differences of coordinates are exact there, so that the field has the same bits.
TEST(ScenesPressures, FarFromTheOrigin) {
    auto near = angle();
    auto far = near;
    for (auto& v : far.vertices) v += Eigen::Vector3d(0x1p30, -0x1p31, 0x1p29);
    make_pressures(near, 1e6);
    make_pressures(far, 1e6);
    EXPECT_EQ(far.pressures, near.pressures);
    EXPECT_EQ(*std::ranges::max_element(far.pressures), 1e6);
}

TEST(ScenesPressures, AreZeroWithoutInnerVertices) {
    auto mesh = hexahedron({Eigen::Vector3d(0, 0, 0),
                            {1, 0, 0},
                            {0, 1, 0},
                            {1, 1, 0},
                            {0, 0, 1},
                            {1, 0, 1},
                            {0, 1, 1},
                            {1, 1, 1}});
    complete_mesh(mesh, "stone", {.pressure = 5});
    EXPECT_EQ(mesh.pressures, std::vector<double>(8, 0));
    EXPECT_THAT(findings_text(mesh),
                HasSubstr("no vertex lies inside, so that the pressure is 0 everywhere"));
}

/// The centre of a box is its last vertex.
TEST(ScenesPressures, ACompletedMeshGetsAnotherField) {
    auto mesh = box({2, 4, 6});
    EXPECT_TRUE(mesh.pressures.empty());
    for (const double modulus : {3.0, 1e7}) {
        complete_mesh(mesh, "box", {.pressure = modulus});
        EXPECT_EQ(mesh.pressures.back(), modulus);
        EXPECT_EQ(mesh.reading.pressure, modulus);
        EXPECT_EQ(findings_text(mesh), "");
    }
    complete_mesh(mesh, "box");
    EXPECT_TRUE(mesh.pressures.empty());
}

TEST(ScenesPressures, AFieldOfTheMeshIsKept) {
    auto mesh = box({2, 4, 6});
    const std::vector<double> own{1, 0, 0, 0, 0, 0, 0, 0.5, 2};
    mesh.pressures = own;
    for (const auto& reading : {MeshReading{}, MeshReading{.pressure = 1e7}, MeshReading{}}) {
        complete_mesh(mesh, "box", reading);
        EXPECT_EQ(mesh.pressures, own);
        EXPECT_FALSE(mesh.reading.pressure);
    }
    EXPECT_THAT(findings_text(mesh), HasSubstr("the pressure is not 0 on the whole boundary, but up to 1"));
}

/// Vertices on a seam of two halves count as inner ones once the halves are welded.
TEST(ScenesPressures, FollowWelding) {
    Mesh halves;
    for (const double side : {-0.5, 0.5}) {
        const auto half = hard::grid({1, 2, 2}, {1, 2, 2});
        for (const auto& t : half.tetrahedra) {
            halves.tetrahedra.push_back(t);
            for (auto& vertex : halves.tetrahedra.back())
                vertex += static_cast<std::uint32_t>(halves.vertices.size());
        }
        for (const auto& v : half.vertices) halves.vertices.push_back(v + Eigen::Vector3d(side, 0, 0));
    }
    complete_mesh(halves, "halves", {.pressure = 7});
    EXPECT_EQ(*std::ranges::max_element(halves.pressures), 0);
    complete_mesh(halves, "halves", {.weld = 0.0, .pressure = 7});
    EXPECT_EQ(std::ranges::count(halves.pressures, 7), 2);
    EXPECT_EQ(std::ranges::count(halves.pressures, 0), 34);
}

TEST(ScenesPressures, RefinedMeshesHaveTheMeanAtMidpoints) {
    Mesh lone;
    lone.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    lone.tetrahedra = {{0, 1, 2, 3}};
    lone.pressures = {1, 2, 4, 8};
    complete_mesh(lone, "lone");
    EXPECT_EQ(refined(lone, 1).pressures, (std::vector<double>{1, 2, 4, 8, 1.5, 2.5, 4.5, 3, 5, 6}));
    EXPECT_EQ(refined(lone, 2).pressures.size(), refined(lone, 2).vertices.size());
    EXPECT_TRUE(refined(box({1, 1, 1}), 1).pressures.empty());
}

TEST(ScenesPressures, ScenesGiveThemToAllMeshes) {
    const auto scene = make_scene("pile:bodies=2,refine=1", {.pressure = 1e7});
    EXPECT_EQ(*std::ranges::max_element(scene.meshes[0].pressures), 1e7);
    EXPECT_NE(scene.digest, make_scene("pile:bodies=2,refine=1").digest);
    EXPECT_NE(scene.digest, make_scene("pile:bodies=2,refine=1", {.pressure = 2e7}).digest);
    EXPECT_EQ(bodies_without_field(scene), 0u);
    EXPECT_EQ(bodies_without_field(make_scene("pile:bodies=2")), 2u);
}

TEST(ScenesPressures, ImpossibleValuesAreRefused) {
    auto mesh = box({1, 1, 1});
    const double inf = std::numeric_limits<double>::infinity();
    for (const double modulus : {0.0, -1.0, inf, std::numeric_limits<double>::quiet_NaN(), 1e39})
        EXPECT_EQ(support::message_of([&] { complete_mesh(mesh, "box", {.pressure = modulus}); }),
                  fmt::format("pressure {}: give a modulus above 0, at most 3.4e+38", modulus));
    for (const double value : {-1.0, inf, std::numeric_limits<double>::quiet_NaN(), 1e39}) {
        mesh.pressures.assign(9, 0);
        mesh.pressures[4] = value;
        EXPECT_THAT(support::message_of([&] { complete_mesh(mesh, "box"); }),
                    HasSubstr(fmt::format("box: the pressure of vertex 4 is {}", value)));
    }
    mesh.pressures.assign(8, 0);
    EXPECT_THAT(support::message_of([&] { complete_mesh(mesh, "box"); }),
                HasSubstr("box: 8 pressures for 9 vertices; give one a vertex"));
}

} // namespace
} // namespace tandem
