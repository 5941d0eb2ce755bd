// SPDX-License-Identifier: MIT
#include "base/error.h"
#include "scenes/mesh.h"
#include "tests/support/message_of.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

/// Two tetrahedra that share the face {1, 2, 3}.
Mesh pair() {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
    mesh.tetrahedra = {{0, 1, 2, 3}, {1, 2, 3, 4}};
    return mesh;
}

std::string failure(Mesh mesh) {
    return support::message_of([&] { complete_mesh(mesh, "it.msh"); });
}

TEST(ScenesMesh, SharedFaceIsNoBoundary) {
    auto mesh = pair();
    complete_mesh(mesh, "it");
    // The shared face lies opposite corner 0 of the first and corner 3 of the second.
    EXPECT_THAT(mesh.boundary, testing::ElementsAre(0b1110, 0b0111));
}

TEST(ScenesMesh, LoneTetrahedronIsAllBoundary) {
    auto mesh = pair();
    mesh.tetrahedra.pop_back();
    complete_mesh(mesh, "it");
    EXPECT_THAT(mesh.boundary, testing::ElementsAre(0b1111));
}

TEST(ScenesMesh, CountsInvertedAndDegenerate) {
    auto mesh = pair();
    mesh.vertices.emplace_back(0.5, 0.5, 0);
    mesh.tetrahedra = {{0, 1, 2, 3}, {1, 0, 2, 3}, {0, 1, 2, 5}, {0, 0, 2, 3}};
    complete_mesh(mesh, "it");
    EXPECT_EQ(mesh.inverted, 1u);
    EXPECT_EQ(mesh.degenerate, 2u);
    complete_mesh(mesh, "it");
    EXPECT_EQ(mesh.inverted, 1u) << "a second call counts again from zero";
}

TEST(ScenesMesh, VolumeIgnoresOrientation) {
    auto mesh = pair();
    EXPECT_DOUBLE_EQ(volume(mesh), 1.0 / 6 + 1.0 / 3);
    std::swap(mesh.tetrahedra[1][0], mesh.tetrahedra[1][1]);
    EXPECT_DOUBLE_EQ(volume(mesh), 1.0 / 6 + 1.0 / 3);
}

TEST(ScenesMesh, RefusesInvalidMeshes) {
    auto mesh = pair();
    mesh.tetrahedra[1][3] = 5;
    EXPECT_THAT(failure(mesh), testing::Eq("it.msh: tetrahedron 1 names vertex 5 of 5, numbered from 0; "
                                           "repair the mesh"));
    mesh = pair();
    for (auto& tetrahedron : mesh.tetrahedra)
        for (auto& vertex : tetrahedron) ++vertex;
    EXPECT_THAT(failure(mesh), testing::EndsWith(" names vertex 5 of 5, numbered from 0; all ids seem to "
                                                 "start at 1: subtract 1 from each"));
    mesh.tetrahedra[0][0] = 6; // beyond such ids, too
    EXPECT_THAT(failure(mesh), testing::EndsWith("; repair the mesh"));
    mesh = pair();
    mesh.vertices[2].y() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(failure(mesh), testing::StartsWith("it.msh: vertex 2 is not finite;"));
    mesh = pair();
    mesh.vertices[4].z() = -std::numeric_limits<double>::infinity();
    EXPECT_THAT(failure(mesh), testing::StartsWith("it.msh: vertex 4 is not finite;"));
    mesh.tetrahedra.clear();
    EXPECT_THAT(failure(mesh), testing::StartsWith("it.msh: no tetrahedra;"));
}

TEST(ScenesError, NearestName) {
    const std::vector<std::string> names{"plates", "pile"};
    EXPECT_EQ(nearest("pyle", names), "pile");
    EXPECT_EQ(nearest("plate", names), "plates");
    EXPECT_EQ(nearest("x", {}), "");
    EXPECT_EQ(unknown("scene", "pyle", names),
              "unknown scene 'pyle'; the nearest is 'pile' (there are: plates, pile)");
}

} // namespace
} // namespace tandem
