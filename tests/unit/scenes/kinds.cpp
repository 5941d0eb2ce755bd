// SPDX-License-Identifier: MIT
#include "scenes/builtin.h"
#include "scenes/digest.h"
#include "base/error.h"
#include "scenes/scene.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

#include <bit>

namespace tandem {
namespace {

using support::failure;
using testing::HasSubstr;

/// Number of coordinates that are not exact in single precision.
std::size_t not_single(const Mesh& mesh) {
    std::size_t count = 0;
    for (const auto& v : mesh.vertices)
        for (const double x : v) {
            const volatile float narrow = static_cast<float>(x);
            count += static_cast<double>(narrow) == x ? 0 : 1;
        }
    return count;
}

std::size_t boundary_faces(const Mesh& mesh) {
    std::size_t count = 0;
    for (const auto flags : mesh.boundary) count += static_cast<std::size_t>(std::popcount(flags));
    return count;
}

struct Expected {
    std::string name;
    std::size_t vertices, tetrahedra, boundary;
    Eigen::Vector3d size;
};

TEST(ScenesBuiltin, CountsAndSizes) {
    const Expected all[] = {{"jack", 798, 2337, 1392, {1, 1, 1}},
                            {"glass", 551, 1682, 1070, {0.889, 1, 0.889}},
                            {"plate", 550, 1734, 1020, {4, 0.5, 4}},
                            {"funnel", 692, 2094, 1280, {0.995, 0.331, 0.995}},
                            {"beam", 426, 1575, 576, {1.9, 1, 4}}};
    for (const auto& expected : all) {
        SCOPED_TRACE(expected.name);
        const auto mesh = built_in_mesh(expected.name);
        // The paper's counts, within 2 %.
        EXPECT_NEAR(static_cast<double>(mesh.vertices.size()) / static_cast<double>(expected.vertices), 1,
                    0.02);
        EXPECT_NEAR(static_cast<double>(mesh.tetrahedra.size()) / static_cast<double>(expected.tetrahedra), 1,
                    0.02);
        EXPECT_EQ(boundary_faces(mesh), expected.boundary);
        EXPECT_EQ(mesh.inverted, 0u);
        EXPECT_EQ(mesh.degenerate, 0u);
        EXPECT_EQ(not_single(mesh), 0u);
        Eigen::Vector3d lower = mesh.vertices.front();
        Eigen::Vector3d upper = lower;
        std::set<std::array<double, 3>> different;
        for (const auto& v : mesh.vertices) {
            lower = lower.cwiseMin(v);
            upper = upper.cwiseMax(v);
            different.insert({v.x(), v.y(), v.z()});
        }
        EXPECT_EQ(different.size(), mesh.vertices.size());
        EXPECT_LT((upper - lower - expected.size).cwiseAbs().maxCoeff(), 0.002);
    }
}

TEST(ScenesBuiltin, AllAreValid) {
    EXPECT_EQ(built_in_names().size(), 11u);
    for (const auto& name : built_in_names()) {
        const auto mesh = built_in_mesh(name);
        EXPECT_EQ(mesh.inverted + mesh.degenerate + not_single(mesh), 0u) << name;
        if (!name.starts_with("grain")) continue;
        // Sizes of the grains of the paper's chalk.
        EXPECT_TRUE(mesh.vertices.size() >= 33 && mesh.vertices.size() <= 56) << name;
        EXPECT_TRUE(mesh.tetrahedra.size() >= 109 && mesh.tetrahedra.size() <= 257) << name;
    }
}

/// Number of corners of the mesh outside one of its boundary faces.
std::size_t beyond_faces(const Mesh& mesh) {
    std::size_t count = 0;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (std::size_t corner = 0; corner < 4; ++corner) {
            if ((mesh.boundary[t] >> corner & 1) == 0) continue;
            const auto at = [&](std::size_t i) {
                return mesh.vertices[mesh.tetrahedra[t][(corner + i) % 4]];
            };
            const Eigen::Vector3d normal = (at(2) - at(1)).cross(at(3) - at(1));
            const double side = normal.dot(at(0) - at(1));
            for (const auto& v : mesh.vertices) count += normal.dot(v - at(1)) * side < -1e-9 ? 1 : 0;
        }
    return count;
}

TEST(ScenesBuiltin, GrainsAreConvex) {
    for (int i = 1; i <= 6; ++i) EXPECT_EQ(beyond_faces(built_in_mesh("grain" + std::to_string(i))), 0u);
    EXPECT_GT(beyond_faces(built_in_mesh("glass")), 0u) << "the test can fail";
}

TEST(ScenesBuiltin, UnknownName) {
    EXPECT_THROW(built_in_mesh("jak"), InputError);
    EXPECT_THAT(failure("pile:mesh=jak"), HasSubstr("unknown mesh 'jak'; the nearest is 'jack'"));
}

TEST(ScenesPlates, RestIsAStackOfTouchingTurnedPlates) {
    const auto scene = make_scene("plates");
    ASSERT_EQ(scene.bodies.size(), 3u);
    EXPECT_EQ(scene.frame_count, 500u);
    const auto frame = scene.frame(0);
    const auto& rest = scene.meshes[0].vertices;
    for (std::size_t plate = 0; plate < 3; ++plate) {
        EXPECT_TRUE(scene.bodies[plate].deformable);
        EXPECT_TRUE(frame.poses[plate].translation.isZero());
        ASSERT_EQ(frame.deformed[plate].size(), rest.size());
        const Eigen::AngleAxisd turn(0.3 * static_cast<double>(plate), Eigen::Vector3d::UnitY());
        for (std::size_t v = 0; v < rest.size(); ++v) {
            const Eigen::Vector3d lifted(0, 0.5 * static_cast<double>(plate), 0);
            ASSERT_LT((frame.deformed[plate][v] - (turn * rest[v] + lifted)).norm(), 1e-14);
        }
    }
}

TEST(ScenesPlates, EndsTwistOneDegreeAStepForthAndBack) {
    const auto scene = make_scene("plates:count=1,frames=401");
    const auto& rest = scene.meshes[0].vertices;
    const auto twist_of = [&](std::size_t step, std::size_t v) {
        const auto p = scene.frame(step).deformed[0][v];
        return std::atan2(p.y(), p.x()) - std::atan2(rest[v].y(), rest[v].x());
    };
    const auto end = static_cast<std::size_t>(
        std::find_if(rest.begin(), rest.end(), [](const auto& p) { return p.z() == 2 && p.x() == 2; })
        - rest.begin());
    ASSERT_LT(end, rest.size());
    constexpr double degree = 0.017453292519943295;
    EXPECT_NEAR(twist_of(1, end), degree, 1e-14);
    EXPECT_NEAR(twist_of(100, end), 100 * degree, 1e-14);
    EXPECT_NEAR(std::remainder(twist_of(200, end) - 200 * degree, 360 * degree), 0, 1e-14);
    EXPECT_NEAR(twist_of(399, end), degree, 1e-14);
    EXPECT_EQ(scene.frame(400).deformed[0], scene.frame(0).deformed[0]) << "no drift";
    for (std::size_t v = 0; v < rest.size(); ++v) {
        ASSERT_EQ(scene.frame(90).deformed[0][v].z(), rest[v].z());
        if (rest[v].z() == 0) {
            ASSERT_EQ(scene.frame(90).deformed[0][v], rest[v]) << "the middle stays";
        }
    }
}

TEST(ScenesPile, DensityIsSolidVolumeOverBox) {
    // Centres of many bodies fill the box from which they are drawn.
    const auto scene = make_scene("pile:bodies=4000,density=0.3,mesh=plate,frames=1");
    Eigen::Vector3d lower = Eigen::Vector3d::Constant(1e9);
    Eigen::Vector3d upper = -lower;
    for (const auto& pose : scene.frame(0).poses) {
        lower = lower.cwiseMin(pose.translation);
        upper = upper.cwiseMax(pose.translation);
    }
    const double side = std::cbrt(4000 * 8 / 0.3);
    EXPECT_LE((upper - lower).maxCoeff(), side);
    EXPECT_GT((upper - lower).minCoeff(), 0.99 * side);
}

TEST(ScenesPile, MovesSlowlyAsARigidBody) {
    const auto scene = make_scene("pile:bodies=20,frames=5");
    for (std::size_t step = 0; step + 1 < scene.frame_count; ++step)
        for (std::size_t body = 0; body < 20; ++body) {
            const auto now = scene.frame(step).poses[body];
            const auto next = scene.frame(step + 1).poses[body];
            ASSERT_NEAR(now.rotation.norm(), 1, 1e-15);
            ASSERT_GT(now.rotation.angularDistance(next.rotation), 0.02);
            ASSERT_LT(now.rotation.angularDistance(next.rotation), 0.04);
            ASSERT_GT((now.translation - next.translation).norm(), 0);
            ASSERT_LT((now.translation - next.translation).norm(), 0.01);
        }
}

TEST(ScenesPile, FarMovesEveryBodyByTheSameOffset) {
    const auto near = make_scene("pile:bodies=5").frame(3);
    const auto far = make_scene("pile:bodies=5,far=1024").frame(3);
    for (std::size_t body = 0; body < 5; ++body) {
        const Eigen::Vector3d moved = far.poses[body].translation - near.poses[body].translation;
        EXPECT_LT((moved - Eigen::Vector3d::Constant(1024)).norm(), 1e-12);
        EXPECT_EQ(far.poses[body].rotation.coeffs(), near.poses[body].rotation.coeffs());
    }
}

TEST(ScenesPile, SeedDecides) {
    const auto once = make_scene("pile:bodies=5,seed=2");
    EXPECT_EQ(once.digest, make_scene("pile:seed=2,bodies=5").digest);
    EXPECT_EQ(once.key, make_scene("pile:seed=2,bodies=5").key);
    const auto other = make_scene("pile:bodies=5,seed=3");
    EXPECT_NE(once.digest, other.digest);
    EXPECT_NE(once.frame(0).poses[0].translation, other.frame(0).poses[0].translation);
}

TEST(ScenesKinds, EveryKindHasADescription) {
    for (const auto& kind : scene_kinds()) {
        const auto scene = make_scene(kind.name);
        EXPECT_EQ(scene.name, kind.name);
        EXPECT_FALSE(kind.models.empty());
        EXPECT_EQ(kind.models.find('\n'), std::string::npos);
        for (const auto& p : kind.parameters) {
            if (!p.left_out.empty())
                EXPECT_EQ(scene.key.find(p.name), std::string::npos) << "keys of old records stay";
            else
                EXPECT_THAT(scene.key, HasSubstr(p.name + "=" + p.value));
        }
    }
}

TEST(ScenesKinds, WorldsOfAPileAreInOneBox) {
    const auto one = make_scene("pile:bodies=6,worlds=01,frames=1"),
               five = make_scene("pile:bodies=6,worlds=5,frames=1");
    EXPECT_EQ(one.key, make_scene("pile:bodies=6,frames=1").key);
    EXPECT_EQ(one.world_size, 0u);
    EXPECT_THAT(five.key, HasSubstr("bodies=6,worlds=5,"));
    EXPECT_EQ(five.bodies.size(), 30u);
    EXPECT_EQ(five.world_size, 6u);
    EXPECT_EQ(world_of(five, 17), 2u);
    EXPECT_TRUE(may_meet(five, 12, 17));
    EXPECT_FALSE(may_meet(five, 11, 12));
    const auto reach = [](const Scene& scene) {
        double most = 0;
        for (const auto& pose : scene.frame(0).poses)
            most = std::max(most, pose.translation.lpNorm<Eigen::Infinity>());
        return most;
    };
    EXPECT_LT(reach(five), 2 * reach(one));
    EXPECT_NE(five.frame(0).poses[0].translation, five.frame(0).poses[6].translation);
    EXPECT_THAT(failure("pile:bodies=5000,worlds=3000"), HasSubstr("worlds"));
}

TEST(ScenesKinds, BadSpecifications) {
    EXPECT_THAT(failure("pyle"), HasSubstr("unknown scene 'pyle'; the nearest is 'pile'"));
    EXPECT_THAT(failure("pile:bodys=3"), HasSubstr("'bodys'; the nearest is 'bodies'"));
    EXPECT_THAT(failure("pile:seed"), HasSubstr("seed has no value"));
    for (const auto* value : {"bodies=0", "bodies=-1", "bodies=2.5", "bodies=", "bodies=3 ", "density=nan",
                              "density=0", "density=inf", "frames=0", "seed=x"}) {
        const auto message = failure(std::string("pile:") + value);
        EXPECT_THAT(message, HasSubstr(value));
        EXPECT_THAT(message, testing::ContainsRegex("give a number from .* to "));
    }
}

/// One tetrahedron at rest.
Scene still() {
    Scene scene;
    scene.key = "still";
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.tetrahedra = {{0, 1, 2, 3}};
    scene.meshes = {mesh};
    scene.bodies = {Body{}};
    scene.frame = [](std::size_t) { return Frame{{Pose{}}, {{}}}; };
    return scene;
}

TEST(ScenesDigest, SameOnEveryMachine) {
    EXPECT_EQ(digest_of(still()), 0x00042bb31a1b8d4bu);
    EXPECT_EQ(make_scene("plates").digest, 0xcc27aaeb8f5aef87u);
    EXPECT_EQ(make_scene("pile").digest, 0xec599913b0cb4e91u);
    EXPECT_EQ(make_scene("rod").digest, 0x16c5b6f24b242bc6u);
    EXPECT_EQ(make_scene("sheet").digest, 0x7a0bb359bef02bf9u);
    EXPECT_EQ(make_scene("column").digest, 0xe3475c0742aeb0f3u);
}

TEST(ScenesDigest, CoversEveryPart) {
    std::set<std::uint64_t> digests{digest_of(still())};
    auto scene = still();
    scene.meshes[0].vertices[2].x() = 0x1p-1074;
    digests.insert(digest_of(scene));
    scene = still();
    std::swap(scene.meshes[0].tetrahedra[0][1], scene.meshes[0].tetrahedra[0][2]);
    digests.insert(digest_of(scene));
    scene = still();
    scene.bodies[0].fixed = true;
    digests.insert(digest_of(scene));
    scene = still();
    scene.frame = [](std::size_t) { return Frame{{Pose{.translation = {1, 0, 0}}}, {{}}}; };
    digests.insert(digest_of(scene));
    EXPECT_EQ(digests.size(), 5u);
}

} // namespace
} // namespace tandem
