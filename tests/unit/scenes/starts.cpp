// SPDX-License-Identifier: MIT
#include "base/error.h"
#include "scenes/overlap.h"
#include "scenes/scene.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using support::failure;
using testing::HasSubstr;

struct Row {
    std::string scene;
    std::size_t bodies;
    double vertices, tetrahedra;
};

TEST(ScenesStarts, CountsOfThePapersTableWithinTwoPercent) {
    const Row rows[] = {{"glasses", 2002, 1102.6e3, 3365.7e3}, {"funnel", 2002, 1596.7e3, 4676.1e3},
                        {"colosseum", 1729, 14793, 16140},     {"plates", 3, 1.65e3, 5.2e3},
                        {"tower", 24, 10.22e3, 37.8e3},        {"jacks", 2002, 1596.7e3, 4676.1e3}};
    for (const auto& row : rows) {
        SCOPED_TRACE(row.scene);
        const auto scene = make_scene(row.scene);
        EXPECT_EQ(scene.bodies.size(), row.bodies);
        EXPECT_NEAR(static_cast<double>(vertex_count(scene)) / row.vertices, 1, 0.02);
        EXPECT_NEAR(static_cast<double>(tetrahedron_count(scene)) / row.tetrahedra, 1, 0.02);
    }
}

TEST(ScenesStarts, ExactCounts) {
    EXPECT_EQ(vertex_count(make_scene("colosseum")), 14793u);
    EXPECT_EQ(tetrahedron_count(make_scene("colosseum")), 16140u);
    EXPECT_EQ(make_scene("colosseum:keystone=0").bodies.size(), 1728u);
    EXPECT_EQ(make_scene("colosseum:slices=7,layers=2").bodies.size(), 7u * 2 * 18 + 1);
    const auto meteor = make_scene("meteor");
    EXPECT_EQ(meteor.bodies.size(), 1082u) << "Fig. 2";
    EXPECT_EQ(meteor.meshes[meteor.bodies.back().mesh].vertices.size(), 135u) << "a ball of 12 x 12";
    EXPECT_EQ(meteor.meshes[meteor.bodies.back().mesh].tetrahedra.size(), 264u);
    EXPECT_EQ(make_scene("jacks:bodies=1000").bodies.size(), 1002u) << "Fig. 2";
    EXPECT_EQ(make_scene("chalk").bodies.size(), 21u);
    EXPECT_EQ(make_scene("temple").bodies.size(), 1u + 24 * 9 + 24 + 7);
    EXPECT_EQ(make_scene("arch").bodies.size(), 18u);
    EXPECT_EQ(make_scene("arch:keystone=0").bodies.size(), 17u);
    EXPECT_EQ(make_scene("block:bodies=3").bodies.size(), 4u);
    EXPECT_EQ(tetrahedron_count(make_scene("rod")), 12960u);
    EXPECT_EQ(tetrahedron_count(make_scene("sheet")), 17280u);
    EXPECT_EQ(tetrahedron_count(make_scene("column")), 10368u);
}

/// Small variants of every scene that starts without overlap.
const std::vector<std::string> small_scenes = {"glasses:bodies=60,size=3",
                                               "glasses:bodies=200",
                                               "funnel:bodies=60,size=4",
                                               "funnel:bodies=200",
                                               "jacks:bodies=30,size=5",
                                               "colosseum:slices=8,layers=2",
                                               "colosseum:slices=3,layers=1,radius=0.5,width=0.2",
                                               "tower:segments=2",
                                               "tower:segments=3,slices=3,radius=0.5",
                                               "meteor:slices=6,layers=2",
                                               "chalk",
                                               "chalk:bodies=60,seed=5",
                                               "temple:columns=3,rows=4",
                                               "temple:columns=2,rows=2,height=1,width=0.3",
                                               "arch",
                                               "arch:stones=3,segments=2,keystone=0,radius=7",
                                               "block:bodies=3,stack=1",
                                               "block:bodies=4,size=0.3,drop=1",
                                               "rod:count=3,length=20",
                                               "sheet:count=3,width=2",
                                               "column:count=3,folds=2",
                                               "spheres:overlap=0",
                                               "spheres:overlap=1",
                                               "grippers:worlds=1"};

TEST(ScenesStarts, NothingOverlaps) {
    for (const auto& name : small_scenes) {
        const auto scene = make_scene(name);
        const auto found = first_overlap(scene, scene.frame(0));
        EXPECT_FALSE(found) << name << ": bodies " << (*found)[0] << " and " << (*found)[1];
    }
}

TEST(ScenesStarts, DefaultsOfThePaperDoNotOverlap) {
    for (const auto* name : {"glasses", "funnel", "jacks", "colosseum", "tower", "meteor", "temple"}) {
        const auto scene = make_scene(name);
        EXPECT_FALSE(first_overlap(scene, scene.frame(0))) << name;
    }
}

TEST(ScenesStarts, EveryPartOfDynamicsIsSet) {
    for (const auto& kind : scene_kinds()) {
        SCOPED_TRACE(kind.name);
        const auto scene = make_scene(kind.name);
        if (scene.dynamics == nullptr) {
            EXPECT_GT(scene.frame_count, 1u) << "a scene without dynamics needs scripted frames";
            continue;
        }
        const auto& d = *scene.dynamics;
        const auto materials = d.materials.names.size();
        EXPECT_EQ(scene.frame_count, 1u);
        EXPECT_EQ(d.bodies.size(), scene.bodies.size());
        EXPECT_EQ(d.materials.densities.size(), materials);
        EXPECT_EQ(missing_surface(d.materials, scene.bodies, d.bodies), std::nullopt);
        for (const auto& [pair, surface] : d.materials.surfaces) {
            EXPECT_LT(pair.second, materials);
            EXPECT_EQ(&d.materials.surface(pair.second, pair.first), &surface);
        }
        EXPECT_GT(d.stepping.step, 0);
        const auto frame = scene.frame(0);
        for (std::size_t i = 0; i < d.bodies.size(); ++i) {
            ASSERT_LT(d.bodies[i].material, materials);
            ASSERT_EQ(scene.bodies[i].deformable, d.bodies[i].elastic >= 0);
            ASSERT_EQ(frame.deformed[i].size(),
                      scene.bodies[i].deformable ? scene.meshes[scene.bodies[i].mesh].vertices.size() : 0u);
        }
    }
}

TEST(ScenesStarts, TheirMaterials) {
    const auto scene = make_scene("meteor:slices=3,layers=1");
    const auto& m = scene.dynamics->materials;
    ASSERT_THAT(m.names, testing::ElementsAre("stone", "ground", "cannonball"));
    EXPECT_THAT(m.densities, testing::ElementsAre(2000, 5500, 7900));
    EXPECT_EQ(m.surface(0, 1).friction, 0.75);
    EXPECT_EQ(m.surface(0, 2).restitution, 0.8);
    EXPECT_EQ(m.surface(1, 2).restitution, 0.3);
    EXPECT_EQ(m.surface(2, 2).friction, 0.3);
    EXPECT_EQ(m.surface(0, 0).restitution, 0.7);
    const auto& ball = scene.dynamics->bodies.back();
    EXPECT_EQ(ball.material, 2u);
    EXPECT_EQ(ball.velocity, Eigen::Vector3d(-90, 0, -15));
    EXPECT_TRUE(scene.bodies.front().fixed) << "the ground";
    EXPECT_EQ(scene.dynamics->bodies.front().material, 1u);
}

TEST(ScenesStarts, BlocksKeepPitchAndShape) {
    const auto scene = make_scene("funnel:bodies=200");
    const auto frame = scene.frame(0);
    std::set<double> levels;
    for (std::size_t i = 2; i < 202; ++i) levels.insert(frame.poses[i].translation.y());
    EXPECT_EQ(levels.size(), 8u) << "5 x 8 x 5";
    EXPECT_EQ(*std::next(levels.begin()) - *levels.begin(), 1.0);
    const auto full = make_scene("funnel").frame(0);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 2; i < 2002; ++i) sum += full.poses[i].translation;
    EXPECT_LT((sum / 2000 - Eigen::Vector3d(0, 31, 0)).norm(), 1e-12) << "as the paper's configuration";
    EXPECT_EQ(full.poses[1].translation, Eigen::Vector3d(0, 15, 0));
}

/// World vertices of a rigid body, in single precision.
std::set<std::array<float, 3>> vertices_of(const Scene& scene, const Frame& frame, std::size_t body) {
    std::set<std::array<float, 3>> result;
    const Eigen::Matrix3f turn = frame.poses[body].rotation.cast<float>().toRotationMatrix();
    for (const auto& v : scene.meshes[scene.bodies[body].mesh].vertices) {
        const Eigen::Vector3f w = turn * v.cast<float>() + frame.poses[body].translation.cast<float>();
        result.insert({w.x(), w.y(), w.z()});
    }
    return result;
}

TEST(ScenesStarts, StonesOfAnArchShareVerticesInSinglePrecision) {
    const auto scene = make_scene("colosseum:slices=5,layers=2");
    const auto frame = scene.frame(0);
    for (std::size_t arch = 0; arch < 10; ++arch)
        for (std::size_t stone = 0; stone < 6; ++stone) {
            const auto first = 1 + arch * 18 + 10 + stone;
            const auto a = vertices_of(scene, frame, first);
            std::size_t shared = 0;
            for (const auto& v : vertices_of(scene, frame, first + 1)) shared += a.count(v);
            EXPECT_EQ(shared, 4u) << first;
        }
}

TEST(ScenesStarts, StackedBodiesTouchExactly) {
    for (const auto* name :
         {"arch:keystone=0", "colosseum:slices=5,layers=3", "temple", "block:bodies=3,stack=1"}) {
        SCOPED_TRACE(name);
        const auto scene = make_scene(name);
        const auto frame = scene.frame(0);
        std::set<float> tops;
        std::vector<float> bottoms;
        for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
            float low = 1e9F;
            float high = -1e9F;
            for (const auto& v : vertices_of(scene, frame, i)) {
                low = std::min(low, v[1]);
                high = std::max(high, v[1]);
            }
            tops.insert(high);
            if (i > 0) bottoms.push_back(low);
        }
        // All stones of an arch except the outermost rest on inclined joints.
        std::size_t hanging = 0;
        for (const auto low : bottoms) hanging += tops.count(low) == 0 ? 1 : 0;
        const std::map<std::string, std::size_t> inclined{{"arch:keystone=0", 4},
                                                          {"colosseum:slices=5,layers=3", 5u * 3 * 5}};
        EXPECT_EQ(hanging, inclined.count(name) != 0 ? inclined.at(name) : 0u);
    }
}

TEST(ScenesStarts, TowerIsPinnedAtItsOuterEnds) {
    const auto scene = make_scene("tower");
    const auto& d = *scene.dynamics;
    ASSERT_EQ(d.elastics.size(), 1u);
    EXPECT_EQ(d.elastics[0].young, 15000);
    EXPECT_EQ(d.elastics[0].poisson, 0.4);
    EXPECT_EQ(d.materials.densities[0], 10);
    EXPECT_FALSE(d.stepping.couple_contacts);
    EXPECT_TRUE(make_scene("tower:couple=1").dynamics->stepping.couple_contacts);
    EXPECT_EQ(d.elastics[0].pinned.size(), 7u * 5) << "the end's grid of points";
    const auto frame = scene.frame(0);
    for (const auto& vertices : frame.deformed)
        for (const auto v : d.elastics[0].pinned)
            EXPECT_GE(std::hypot(vertices[v].x(), vertices[v].z()), 6 - 1e-12);
}

TEST(ScenesStarts, RefinementMultipliesTetrahedra) {
    for (const auto* name :
         {"plates:frames=2", "pile:bodies=2", "funnel:bodies=2", "tower:segments=1", "arch"}) {
        SCOPED_TRACE(name);
        const auto coarse = make_scene(name);
        const auto separator = std::string(name).find(':') == std::string::npos ? ":" : ",";
        const auto fine = make_scene(std::string(name) + separator + "refine=1");
        EXPECT_EQ(tetrahedron_count(fine), 8 * tetrahedron_count(coarse));
        EXPECT_EQ(coarse.key.find("refine"), std::string::npos);
        EXPECT_THAT(fine.key, HasSubstr("refine=1"));
        EXPECT_NE(fine.digest, coarse.digest);
        for (std::size_t i = 0; i < fine.bodies.size(); ++i)
            if (fine.bodies[i].deformable) {
                EXPECT_EQ(fine.frame(0).deformed[i].size(), fine.meshes[0].vertices.size());
            }
    }
    EXPECT_GT(make_scene("tower:refine=1").dynamics->elastics[0].pinned.size(), 35u);
    EXPECT_EQ(make_scene("pile:refine=00").digest, make_scene("pile").digest);
}

TEST(ScenesStarts, ImpossibleParameters) {
    for (const auto* specification :
         {"funnel:size=0",      "funnel:size=-1",      "glasses:size=0",       "glasses:bodies=0",
          "funnel:bodies=0",    "jacks:bodies=0",      "chalk:bodies=0",       "block:bodies=0",
          "block:size=0",       "block:restitution=2", "block:friction=-1",    "colosseum:slices=2",
          "colosseum:layers=0", "colosseum:radius=0",  "colosseum:keystone=2", "meteor:ball=0",
          "meteor:ball=3",      "tower:segments=0",    "tower:radius=-2",      "temple:columns=1",
          "temple:height=0",    "arch:radius=0",       "arch:thickness=1",     "funnel:refine=5",
          "arch:stones=1"})
        EXPECT_THAT(failure(specification), HasSubstr("give a number from")) << specification;
    EXPECT_THAT(failure("arch:stones=6"), HasSubstr("give an odd number"));
}

TEST(ScenesStarts, SameBitsOnEveryMachine) {
    const std::pair<const char*, std::uint64_t> golden[] = {
        {"glasses:bodies=8", 0xfcefc016bd4111a1u},
        {"funnel:bodies=8", 0xbe3428630cc2028eu},
        {"colosseum:slices=4,layers=1", 0xd9f68b4e215ecb9fu},
        {"tower:segments=2", 0x8fc94f328fbf3478u},
        {"meteor:slices=4,layers=1", 0xdd10b8cda71640d2u},
        {"jacks:bodies=8", 0x507b26318d4d0d2bu},
        {"chalk", 0x4c3d0fd7e564a8edu},
        {"temple:columns=2,rows=3", 0x398616690a61a34fu},
        {"arch", 0x481b012328e8c3afu},
        {"block:bodies=2", 0x19a5f898044d2140u}};
    for (const auto& [name, digest] : golden) {
        EXPECT_EQ(make_scene(name).digest, digest) << name;
        EXPECT_EQ(make_scene(name).digest, make_scene(name).digest) << name;
    }
}

} // namespace
} // namespace tandem
