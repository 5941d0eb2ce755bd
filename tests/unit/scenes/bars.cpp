// SPDX-License-Identifier: MIT
// Scenes of bars that bend by script until they meet themselves: rod, sheet, column.
#include "base/error.h"
#include "geometry/decision.h"
#include "scenes/digest.h"
#include "scenes/kinds/bars.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

#include <bit>

namespace tandem {
namespace {

using testing::HasSubstr;

/// Small variants that fold as the defaults do.
const std::vector<std::string> small_bars = {"rod:length=64,width=2", "sheet:length=60,width=4",
                                             "column:folds=2,width=2"};

std::vector<TetraCorners> corners_of(const Scene& scene, const Frame& frame, std::size_t body) {
    std::vector<TetraCorners> result;
    for (const auto& tetrahedron : scene.meshes[0].tetrahedra) {
        auto& corners = result.emplace_back();
        for (std::size_t i = 0; i < 4; ++i) {
            const auto& p = frame.deformed[body][tetrahedron[i]];
            corners[i] = {p.x(), p.y(), p.z()};
        }
    }
    return result;
}

bool share_a_vertex(const Tetrahedron& a, const Tetrahedron& b) {
    return std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end();
}

/// Relations of all pairs of body 0 that share no vertex.
DecisionCounts own_pairs(const Scene& scene, std::size_t step) {
    const auto corners = corners_of(scene, scene.frame(step), 0);
    const auto& tetrahedra = scene.meshes[0].tetrahedra;
    DecisionCounts counts;
    for (std::size_t a = 0; a < corners.size(); ++a)
        for (std::size_t b = a + 1; b < corners.size(); ++b)
            if (!share_a_vertex(tetrahedra[a], tetrahedra[b])) counts.add(decide(corners[a], corners[b]));
    return counts;
}

/// Relations of all pairs of bodies 0 and 1.
DecisionCounts common_pairs(const Scene& scene, std::size_t step) {
    const auto frame = scene.frame(step);
    const auto neighbours = corners_of(scene, frame, 1);
    DecisionCounts counts;
    for (const auto& a : corners_of(scene, frame, 0))
        for (const auto& b : neighbours) counts.add(decide(a, b));
    return counts;
}

/// Number of tetrahedra of a frame without positive volume.
std::size_t flawed_in(const Scene& scene, std::size_t step) {
    Mesh mesh = scene.meshes[0];
    std::size_t count = 0;
    for (const auto& vertices : scene.frame(step).deformed) {
        mesh.vertices = vertices;
        count_flawed(mesh);
        count += mesh.inverted + mesh.degenerate;
    }
    return count;
}

TEST(ScenesBars, BarIsABoxOfCubes) {
    const auto mesh = bar("test", {3, 2, 1});
    EXPECT_EQ(mesh.vertices.size(), 4u * 3 * 2);
    EXPECT_EQ(mesh.tetrahedra.size(), 6u * 6);
    EXPECT_EQ(mesh.inverted + mesh.degenerate, 0u);
    EXPECT_EQ(volume(mesh), 6 * bar_edge * bar_edge * bar_edge);
    EXPECT_EQ(mesh.vertices.front(), Eigen::Vector3d(0, -bar_edge, -0.5 * bar_edge));
    EXPECT_EQ(mesh.vertices.back(), Eigen::Vector3d(3 * bar_edge, bar_edge, 0.5 * bar_edge));
    std::size_t faces = 0;
    for (const auto flags : mesh.boundary) faces += static_cast<std::size_t>(std::popcount(flags));
    EXPECT_EQ(faces, 2u * 2 * (3 * 2 + 2 * 1 + 3 * 1)) << "cubes conform";
}

TEST(ScenesBars, ApartAtRestAndThroughThemselvesLater) {
    for (const auto& name : small_bars) {
        SCOPED_TRACE(name);
        const auto scene = make_scene(name);
        const auto rest = own_pairs(scene, 0);
        EXPECT_EQ(rest[Relation::overlapping] + rest[Relation::touching], 0u);
        EXPECT_GT(own_pairs(scene, 100)[Relation::overlapping], 500u);
    }
}

TEST(ScenesBars, NeighboursMeetOnlyLater) {
    for (const auto& name : small_bars) {
        SCOPED_TRACE(name);
        const auto scene = make_scene(name + ",count=2");
        const auto rest = common_pairs(scene, 0);
        EXPECT_EQ(rest[Relation::overlapping] + rest[Relation::touching], 0u);
        EXPECT_GT(common_pairs(scene, 100)[Relation::overlapping], 50u);
    }
}

TEST(ScenesBars, NoTetrahedronIsInverted) {
    auto names = small_bars;
    for (const auto* extreme :
         {"rod", "sheet", "column", "rod:width=1,length=40,twist=1,pitch=0",
          "rod:width=1,length=40,twist=-1,pitch=8", "sheet:gap=0.5,width=2", "sheet:gap=1.5,width=2",
          "column:slope=2.2,folds=2,count=2", "sheet:length=60,gap=1.5,width=2,refine=1"})
        names.emplace_back(extreme);
    for (const auto& name : names) {
        const auto scene = make_scene(name);
        for (const std::size_t step : {0u, 1u, 30u, 60u, 80u, 90u, 100u})
            EXPECT_EQ(flawed_in(scene, step), 0u) << name << " in frame " << step;
    }
}

TEST(ScenesBars, MotionReturns) {
    for (const auto& name : small_bars) {
        const auto scene = make_scene(name + ",frames=201");
        EXPECT_EQ(scene.frame(200).deformed, scene.frame(0).deformed) << name;
        EXPECT_EQ(scene.frame(130).deformed, scene.frame(70).deformed) << name;
        EXPECT_NE(scene.frame(101).deformed, scene.frame(100).deformed) << name;
    }
}

TEST(ScenesBars, StraightAtRest) {
    const auto scene = make_scene("rod");
    const auto& rest = scene.meshes[0].vertices;
    const auto first = scene.frame(0).deformed[0];
    for (std::size_t v = 0; v < rest.size(); ++v) {
        const Eigen::Vector3d upright(-rest[v].y(), rest[v].x(), rest[v].z());
        ASSERT_LT((first[v] - upright).norm(), 1e-12);
    }
}

TEST(ScenesBars, RefinedBarsHaveTheSameForm) {
    for (const auto& name : small_bars) {
        const auto coarse = make_scene(name).frame(100).deformed[0];
        const auto fine = make_scene(name + ",refine=1").frame(100).deformed[0];
        for (std::size_t v = 0; v < coarse.size(); ++v) ASSERT_LT((fine[v] - coarse[v]).norm(), 0.01) << name;
    }
}

TEST(ScenesBars, SameOnEveryMachine) {
    EXPECT_EQ(digest_of(make_scene("rod").frame(100)), 0xbedb7bc8fa59a230u);
    EXPECT_EQ(digest_of(make_scene("sheet").frame(100)), 0x849836cf19a2e9eau);
    EXPECT_EQ(digest_of(make_scene("column").frame(100)), 0xf6e669a8207f729cu);
}

TEST(ScenesBars, ImpossibleParameters) {
    EXPECT_THAT(support::failure("sheet:length=59"), HasSubstr("from 60 to"));
    EXPECT_THAT(support::failure("column:slope=3"), HasSubstr("from 1 to 2.2"));
    EXPECT_THROW(bar("test", {1u << 20, 1u << 20, 1u << 10}), InputError) << "beyond memory";
}

} // namespace
} // namespace tandem
