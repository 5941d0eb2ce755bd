// SPDX-License-Identifier: MIT
// Meshes of two tetrahedra on a common face, moved along their axis. Bodies, fields and numbers of pairs are
// those of geometry/proximity/sycl/test/sycl_proximity_engine_test.cc in forks of Drake that collide on GPUs.
#include "geometry/decision.h"
#include "tests/support/cells.h"
#include "tests/support/test.h"

namespace tandem::unit_test::two_tetrahedra {
namespace {

using namespace support;
using testing::ElementsAre;

/// A body at each height.
Scene at_heights(const std::vector<double>& heights) {
    Mesh mesh;
    mesh.vertices = {{0, 0, -1}, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.tetrahedra = {{1, 3, 2, 0}, {1, 2, 3, 4}};
    mesh.pressures = {0, 1, 2, 3, 4};
    complete_mesh(mesh, "two");
    Scene scene;
    scene.meshes = {mesh};
    scene.bodies.resize(heights.size());
    scene.frame = [heights](std::size_t) {
        Frame frame;
        for (const double z : heights) frame.poses.push_back({.translation = {0, 0, z}});
        frame.deformed.resize(heights.size());
        return frame;
    };
    return scene;
}

TetraCorners corners_of(const Mesh& mesh, std::uint32_t tetrahedron, double height) {
    TetraCorners corners;
    for (std::size_t i = 0; i < 4; ++i) {
        const auto& v = mesh.vertices[mesh.tetrahedra[tetrahedron][i]];
        corners[i] = {v.x(), v.y(), v.z() + height};
    }
    return corners;
}

/// Candidate pairs (tetrahedron a, tetrahedron b) of each pair of bodies, ascending. All of them overlap.
std::map<std::array<std::uint32_t, 2>, std::vector<std::array<std::uint32_t, 2>>>
pairs_of(const std::vector<double>& heights) {
    const auto scene = at_heights(heights);
    const auto session = prepare_on(device("host"), algorithm("tiled"), scene,
                                    texts("contact_rule=pressure precision=double order=canonical"));
    std::map<std::array<std::uint32_t, 2>, std::vector<std::array<std::uint32_t, 2>>> found;
    for (const auto& pair : session->run(scene.frame(0)).download()) {
        found[{pair.body_a, pair.body_b}].push_back({pair.tet_a, pair.tet_b});
        EXPECT_EQ(relation(corners_of(scene.meshes[0], pair.tet_a, heights[pair.body_a]),
                           corners_of(scene.meshes[0], pair.tet_b, heights[pair.body_b])),
                  Relation::overlapping);
    }
    return found;
}

using Row = std::array<std::uint32_t, 2>;

TEST(TwoTetrahedra, OnePairWhereTheyJustOverlap) {
    const auto two = pairs_of({0, 1.1});
    EXPECT_EQ(two.size(), 1u);
    EXPECT_THAT(two.at({0, 1}), ElementsAre(Row{1, 0}));
    const auto three = pairs_of({0, 1.1, 2.2});
    EXPECT_EQ(three.size(), 2u) << "the outer ones are apart";
    EXPECT_THAT(three.at({0, 1}), ElementsAre(Row{1, 0}));
    EXPECT_THAT(three.at({1, 2}), ElementsAre(Row{1, 0}));
}

TEST(TwoTetrahedra, ThreePairsWhereTheyOverlapFurther) {
    for (const auto& heights : {std::vector<double>{0, 0.3}, std::vector<double>{0, 0.3, 0.6}}) {
        const auto found = pairs_of(heights);
        EXPECT_EQ(found.size(), heights.size() == 2 ? 1u : 3u);
        for (const auto& [bodies, rows] : found)
            EXPECT_THAT(rows, ElementsAre(Row{0, 0}, Row{1, 0}, Row{1, 1}));
    }
}

} // namespace
} // namespace tandem::unit_test::two_tetrahedra
