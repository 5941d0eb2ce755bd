// SPDX-License-Identifier: MIT
#include "base/error.h"
#include "scenes/scene.h"
#include "tests/support/message_of.h"
#include "tests/support/test.h"

#include <unistd.h>

namespace tandem {
namespace {

using testing::HasSubstr;

/// A folder per test, with scene.json and other files of the test.
class ScenesDescription : public testing::Test {
protected:
    void SetUp() override { std::filesystem::create_directories(folder_); }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name) << text;
        return (folder_ / name).string();
    }
    Scene load(const std::string& text) const { return make_scene(write("scene.json", text)); }
    std::string failure(const std::string& text) const {
        return support::message_of([&] { load(text); });
    }
    /// The error for a scene of one jack whose body has these further fields.
    std::string body_failure(const std::string& names) const {
        return failure(R"({"frames": 2, "meshes": {"j": {"builtin": "jack"}}, "bodies": [{"mesh": "j", )"
                       + names + "}]}");
    }

private:
    std::filesystem::path folder_ = std::filesystem::path(testing::TempDir())
                                    / ("tandem-" + std::to_string(getpid())
                                       + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(ScenesDescription, BodiesMove) {
    const auto scene = load(R"({
        "name": "two jacks", "units": "cm", "frames": 3,
        "meshes": {"jack": {"builtin": "jack"}, "big": {"builtin": "jack", "scale": 2}},
        "bodies": [
            {"mesh": "big", "fixed": true, "position": [1, 2, 3]},
            {"mesh": "jack", "velocity": [0, 0.5, 0], "spin": [0, 0, 2, 1.5707963267948966]},
            {"mesh": "jack", "poses": [[0, 0, 0, 1, 0, 0, 0], [4, 0, 0, 0, 2, 0, 0], [0, 0, 5, 1, 0, 0, 0]]}
        ]})");
    EXPECT_EQ(scene.name, "two jacks");
    EXPECT_EQ(scene.units, "cm");
    EXPECT_EQ(scene.frame_count, 3u);
    ASSERT_EQ(scene.bodies.size(), 3u);
    EXPECT_TRUE(scene.bodies[0].fixed);
    EXPECT_FALSE(scene.bodies[1].fixed);
    const auto& big = scene.meshes[scene.bodies[0].mesh];
    const auto& jack = scene.meshes[scene.bodies[1].mesh];
    EXPECT_EQ(scene.bodies[1].mesh, scene.bodies[2].mesh) << "bodies share meshes";
    EXPECT_EQ(big.vertices[7], Eigen::Vector3d(2 * jack.vertices[7]));
    const auto frame = scene.frame(2);
    EXPECT_EQ(frame.poses[0].translation, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(frame.poses[1].translation, Eigen::Vector3d(0, 1, 0));
    EXPECT_LT((frame.poses[1].rotation * Eigen::Vector3d::UnitX() + Eigen::Vector3d::UnitX()).norm(), 1e-14);
    EXPECT_EQ(frame.poses[2].translation, Eigen::Vector3d(0, 0, 5));
    EXPECT_EQ(scene.frame(1).poses[2].rotation.x(), 1) << "quaternions are normalised";
}

TEST_F(ScenesDescription, FilesAreFoundBesideIt) {
    write("one.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
                      "Tetrahedra 1\n1 2 3 4 0\nEnd\n");
    const auto scene = load(R"({"meshes": {"m": {"file": "one.mesh"}}, "bodies": [{"mesh": "m"}]})");
    EXPECT_EQ(scene.name, "scene") << "the file's name";
    EXPECT_EQ(load("\xef\xbb\xbf"
                   R"({"meshes": {"m": {"file": "one.mesh"}}, "bodies": [{"mesh": "m"}]})")
                  .digest,
              scene.digest)
        << "with a byte-order mark";
    EXPECT_EQ(tetrahedron_count(scene), 1u);
    EXPECT_THAT(failure(R"({"meshes": {"m": {"file": "two.mesh"}}, "bodies": [{"mesh": "m"}]})"),
                HasSubstr("two.mesh"));
}

TEST_F(ScenesDescription, ErrorsNameThePath) {
    const std::string meshes = R"({"meshes": {"j": {"builtin": "jack"}}, )";
    EXPECT_THAT(failure("{"), HasSubstr("scene.json:1: not JSON"));
    EXPECT_THAT(failure(meshes + R"("bodys": []})"),
                HasSubstr("unknown name 'bodys'; the nearest is 'bodies'"));
    EXPECT_THAT(failure(meshes + R"("bodies": []})"), HasSubstr("has no bodies"));
    EXPECT_THAT(failure(meshes + R"("frames": 1.5, "bodies": [{"mesh": "j"}]})"), HasSubstr("/frames: "));
    EXPECT_THAT(failure(meshes + R"("bodies": [{"mesh": "k"}]})"),
                HasSubstr("/bodies/0/mesh: unknown mesh 'k'"));
    EXPECT_THAT(failure(R"({"meshes": {"j": {"builtin": "jak"}}, "bodies": [{"mesh": "j"}]})"),
                HasSubstr("/meshes/j/builtin: unknown mesh 'jak'; the nearest is 'jack'"));
    EXPECT_THAT(failure(R"({"meshes": {"j": {"builtin": "jack", "scale": -1}}, "bodies": [{"mesh": "j"}]})"),
                HasSubstr("/meshes/j/scale: must be above 0"));
    EXPECT_THAT(body_failure(R"("position": [0, 1])"), HasSubstr("/bodies/0/position: must be 3 numbers"));
    EXPECT_THAT(body_failure(R"("position": [0, 1, "2"])"),
                HasSubstr("/bodies/0/position/2: must be a finite"));
    EXPECT_THAT(body_failure(R"("rotation": [0, 0, 0, 0])"),
                HasSubstr("/bodies/0/rotation: must not be the zero"));
    for (const auto* axis : {"0, 0, 0", "1e200, 0, 0", "0, 1e-200, 0"})
        EXPECT_THAT(body_failure(fmt::format(R"("spin": [{}, 1])", axis)),
                    HasSubstr("/bodies/0/spin: must have an axis of length 1e-150 to 1e150"));
    EXPECT_THAT(body_failure(R"("poses": [[0, 0, 0, 1, 0, 0, 0]])"), HasSubstr("one pose a frame, 2 in all"));
    EXPECT_THAT(body_failure(R"("fixed": true, "velocity": [1, 0, 0])"), HasSubstr("is fixed and moves"));
    EXPECT_THAT(body_failure(R"("spin": [0, 0, 1, 1e300])"),
                HasSubstr("/bodies/0/spin: must turn by no more"));
    EXPECT_THAT(body_failure(R"("poses": [[0,0,0,1,0,0,0], [0,0,0,1,0,0,0]], "spin": [0, 0, 1, 1])"),
                HasSubstr("/bodies/0/spin: is replaced by poses"));
}

TEST_F(ScenesDescription, DigestCoversEveryFrame) {
    const auto digest = [&](const std::string& middle) {
        return load(R"({"frames": 3, "meshes": {"j": {"builtin": "jack"}}, "bodies": [{"mesh": "j", "poses": [
                    [0, 0, 0, 1, 0, 0, 0], )"
                    + middle + ", [1, 0, 0, 1, 0, 0, 0]]}]}")
            .digest;
    };
    EXPECT_NE(digest("[0, 0, 0, 1, 0, 0, 0]"), digest("[9, 0, 0, 1, 0, 0, 0]"));
}

/// A stone above a ground, with these further fields of the dynamics, the bodies and the stone.
std::string dynamic_scene(const std::string& dynamics, const std::string& bodies = "",
                          const std::string& stone = "") {
    return R"({"meshes": {"g": {"box": [10, 1, 10]}, "s": {"builtin": "jack", "scale": 2}},
        "dynamics": {"materials": {"stone": 2000, "earth": 5500}, "surfaces": [
            {"a": "earth", "b": "stone", "friction": 0.75, "restitution": 0.3}])"
           + dynamics + R"(},
        "bodies": [{"mesh": "g", "fixed": true, "material": "earth"},
                   {"mesh": "s", "position": [0, 3, 0], "material": "stone")"
           + stone + "}" + bodies + "]}";
}

constexpr const char* dynamics_of_every_field = R"(, "gravity": [0, -1.6, 0], "step": 0.005, "steps": 7,
           "solver": {"method": "jacobi", "iterations": 20, "absolute_tolerance": 0.5, "relative_tolerance": 0.25, "warm_start": true},
           "stepping": {"pre_stabilize": true, "post_stabilize": true, "bounce": false, "linear_damping": 0.125,
                        "surface_normals": false, "contact_layer": 0.0625,
                        "angular_damping": 0.25, "adaptive_tolerance": 0.001, "least_step": 0.0001, "couple_contacts": false},
           "reduction": {"distance": 0.001, "per_pair": 4})";

TEST_F(ScenesDescription, DynamicsAreRead) {
    const auto scene = load(
        dynamic_scene(dynamics_of_every_field, "", R"(, "velocity": [1, 2, 3], "spin": [0, 0, 2, 1.5])"));
    EXPECT_EQ(scene.frame_count, 1u);
    ASSERT_NE(scene.dynamics, nullptr);
    const auto& d = *scene.dynamics;
    EXPECT_EQ(d.gravity, Eigen::Vector3d(0, -1.6, 0));
    EXPECT_EQ(d.steps, 7u);
    ASSERT_THAT(d.materials.names, testing::ElementsAre("earth", "stone"));
    EXPECT_THAT(d.materials.densities, testing::ElementsAre(5500, 2000));
    EXPECT_EQ(d.materials.surface(0, 1).friction, 0.75);
    EXPECT_EQ(d.materials.surface(1, 0).restitution, 0.3);
    ASSERT_EQ(d.bodies.size(), 2u);
    EXPECT_EQ(d.bodies[0].material, 0u);
    EXPECT_EQ(d.bodies[1].material, 1u);
    EXPECT_EQ(d.bodies[1].velocity, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(d.bodies[1].spin, Eigen::Vector3d(0, 0, 1.5));
    EXPECT_EQ(d.reduction.distance, 0.001);
    EXPECT_EQ(d.reduction.per_pair, 4u);
    EXPECT_EQ(scene.frame(0).poses[1].translation, Eigen::Vector3d(0, 3, 0));
    EXPECT_NE(load(dynamic_scene(R"(, "steps": 7)")).digest, load(dynamic_scene(R"(, "steps": 8)")).digest);
}

TEST_F(ScenesDescription, SolverAndSteppingAreRead) {
    const auto scene = load(dynamic_scene(dynamics_of_every_field));
    const auto& d = *scene.dynamics;
    EXPECT_EQ(d.solver.method, SolverSettings::Method::jacobi);
    EXPECT_EQ(d.solver.iterations, 20u);
    EXPECT_EQ(d.solver.absolute_tolerance, 0.5);
    EXPECT_EQ(d.solver.relative_tolerance, 0.25);
    EXPECT_TRUE(d.solver.warm_start);
    EXPECT_EQ(d.stepping.step, 0.005);
    EXPECT_TRUE(d.stepping.pre_stabilize && d.stepping.post_stabilize && !d.stepping.bounce);
    EXPECT_FALSE(d.stepping.surface_normals);
    EXPECT_EQ(d.stepping.contact_layer, 0.0625);
    EXPECT_EQ(d.stepping.linear_damping, 0.125);
    EXPECT_EQ(d.stepping.angular_damping, 0.25);
    EXPECT_EQ(d.stepping.adaptive_tolerance, 0.001);
    EXPECT_EQ(d.stepping.least_step, 0.0001);
    EXPECT_FALSE(d.stepping.couple_contacts);
}

TEST_F(ScenesDescription, DynamicsHaveDefaults) {
    const auto plain = load(dynamic_scene(""));
    EXPECT_EQ(plain.dynamics->solver.iterations, 1000u);
    EXPECT_EQ(plain.dynamics->solver.absolute_tolerance, 0);
    EXPECT_TRUE(plain.dynamics->stepping.post_stabilize && plain.dynamics->stepping.surface_normals);
    EXPECT_EQ(plain.dynamics->stepping.contact_layer, 2e-5);
    EXPECT_EQ(plain.dynamics->gravity, Eigen::Vector3d(0, -9.82, 0));
}

TEST_F(ScenesDescription, ElasticBodiesAreDeformable) {
    const auto scene = load(dynamic_scene("", "", R"(, "rotation": [0, 1, 0, 0],
            "elastic": {"law": "saint_venant_kirchhoff", "young": 1e4, "poisson": 0.3, "damping": 0.1, "pinned": [0, 5]})"));
    EXPECT_TRUE(scene.bodies[1].deformable);
    const auto& d = *scene.dynamics;
    EXPECT_EQ(d.bodies[1].elastic, 0);
    EXPECT_EQ(d.bodies[0].elastic, -1);
    ASSERT_EQ(d.elastics.size(), 1u);
    EXPECT_EQ(d.elastics[0].law, Elastic::Law::saint_venant_kirchhoff);
    EXPECT_THAT(d.elastics[0].pinned, testing::ElementsAre(0, 5));
    const auto frame = scene.frame(0);
    const auto& rest = scene.meshes[scene.bodies[1].mesh].vertices;
    ASSERT_EQ(frame.deformed[1].size(), rest.size());
    EXPECT_EQ(frame.deformed[1][9], Eigen::Vector3d(rest[9].x(), 3 - rest[9].y(), -rest[9].z()));
    EXPECT_TRUE(frame.poses[1].translation.isZero());
}

TEST_F(ScenesDescription, ErrorsOfDynamicsNameThePath) {
    const auto dynamics = [&](const std::string& names) { return failure(dynamic_scene(", " + names)); };
    const auto body = [&](const std::string& names) { return failure(dynamic_scene("", ", " + names)); };
    const auto stone = [&](const std::string& names) { return failure(dynamic_scene("", "", ", " + names)); };
    EXPECT_THAT(dynamics(R"("step": 0)"), HasSubstr("scene.json: /dynamics/step: must be from 1e-09 to 10"));
    EXPECT_THAT(dynamics(R"("stepp": 1)"),
                HasSubstr("/dynamics: unknown name 'stepp'; the nearest is 'step'"));
    EXPECT_THAT(dynamics(R"("steps": 0)"), HasSubstr("/dynamics/steps: must be an integer from 1"));
    EXPECT_THAT(dynamics(R"("gravity": 9.82)"), HasSubstr("/dynamics/gravity: must be 3 numbers"));
    EXPECT_THAT(dynamics(R"("solver": {"method": "jacoby"})"),
                HasSubstr("/dynamics/solver/method: unknown method 'jacoby'; the nearest is 'jacobi'"));
    EXPECT_THAT(dynamics(R"("solver": {"iterations": 1.5})"), HasSubstr("/dynamics/solver/iterations: "));
    EXPECT_THAT(dynamics(R"("stepping": {"linear_damping": -1})"),
                HasSubstr("/dynamics/stepping/linear_damping: must be from 0 to"));
    EXPECT_THAT(dynamics(R"("stepping": {"bounce": 1})"), HasSubstr("/bounce: must be true or false"));
    EXPECT_THAT(dynamics(R"("reduction": {"per_pair": -1})"), HasSubstr("/dynamics/reduction/per_pair: "));
    EXPECT_THAT(body(R"({"mesh": "g", "fixed": true, "material": "earth", "position": [9, 0.5, 0]})"),
                HasSubstr("/bodies/2: overlaps body 0, and both are fixed; move one"));
    EXPECT_EQ(body(R"({"mesh": "g", "fixed": true, "material": "earth", "position": [10, 0.5, 0]})"),
              "no error")
        << "touching";
    EXPECT_EQ(failure(dynamic_scene(
                  R"(, "gravity": [0, 0, 0])",
                  R"(, {"mesh": "g", "fixed": true, "material": "earth", "position": [0, 3, 0]})")),
              "no error")
        << "a moving body may overlap";
    EXPECT_THAT(body(R"({"mesh": "g", "fixed": true})"), HasSubstr("/bodies/2: has no material"));
    EXPECT_THAT(body(R"({"mesh": "k", "material": "earth"})"), HasSubstr("/bodies/2/mesh: unknown mesh 'k'"));
    EXPECT_THAT(body(R"({"mesh": "s", "material": "iron"})"),
                HasSubstr("/bodies/2/material: unknown material 'iron' (there are: "));
    EXPECT_THAT(body(R"({"mesh": "s", "material": "stone"})"),
                HasSubstr("/dynamics/surfaces: has no entry for stone and stone"));
    EXPECT_THAT(stone(R"("poses": [[0,0,0,1,0,0,0]])"), HasSubstr("is replaced by poses"));
    EXPECT_THAT(body(R"({"mesh": "s", "material": "earth", "poses": [[0, 0, 0, 1, 0, 0, 0]]})"),
                HasSubstr("/bodies/2/poses: cannot be used"));
    EXPECT_THAT(stone(R"("elastic": {"young": 1, "poisson": 0.5})"),
                HasSubstr("/bodies/1/elastic/poisson: must be from 0 to 0.499"));
    EXPECT_THAT(stone(R"("elastic": {"poisson": 0.3})"), HasSubstr("/bodies/1/elastic: has no young"));
    EXPECT_THAT(stone(R"("elastic": {"young": 1, "poisson": 0.3, "pinned": [800]})"),
                HasSubstr("/bodies/1/elastic/pinned/0: must be an integer from 0 to 799"));
    EXPECT_THAT(stone(R"("elastic": {"young": 1, "poisson": 0.3}, "spin": [0, 0, 1, 1])"),
                HasSubstr("/bodies/1/spin: cannot be given"));
}

TEST_F(ScenesDescription, FiltersOfBodies) {
    const auto described = [](const std::string& body, const std::string& top) {
        return R"({"meshes": {"m": {"builtin": "jack"}}, "bodies": [{"mesh": "m"}, {"mesh": "m")" + body
               + "}]" + top + "}";
    };
    const auto plain = load(described("", ""));
    EXPECT_FALSE(has_filters(plain));
    EXPECT_TRUE(may_meet(plain, 0, 1) && may_meet(plain, 1, 1));
    const auto scene =
        load(described(R"(, "groups": [3, 31], "meets": [])", R"(, "never_meet": [[1, 0], [0, 1], [1, 1]])"));
    EXPECT_TRUE(has_filters(scene));
    EXPECT_EQ(scene.bodies[0].groups, 1u);
    EXPECT_EQ(scene.bodies[1].groups, 0x8000'0008u);
    EXPECT_EQ(scene.bodies[1].meets, 0u);
    EXPECT_EQ(scene.never_meet, (std::vector<std::array<std::uint32_t, 2>>{{0, 1}, {1, 1}}));
    EXPECT_TRUE(may_meet(scene, 0, 0));
    EXPECT_FALSE(may_meet(scene, 1, 0) || may_meet(scene, 1, 1));
    EXPECT_NE(scene.digest, plain.digest);
    EXPECT_THAT(failure(described(R"(, "groups": [32])", "")),
                HasSubstr("/bodies/1/groups/0: must be an integer from 0 to 31"));
    EXPECT_THAT(failure(described(R"(, "meets": 1)", "")),
                HasSubstr("/bodies/1/meets: must be an array of groups"));
    EXPECT_THAT(failure(described("", R"(, "never_meet": [[0, 2]])")),
                HasSubstr("/never_meet/0/1: must be an integer from 0 to 1"));
    EXPECT_THAT(failure(described("", R"(, "never_meet": [[0]])")),
                HasSubstr("/never_meet/0: must be a pair of bodies"));
}

std::string repeated(const std::string& text, std::size_t times) {
    std::string all;
    for (std::size_t i = 0; i < times; ++i) all += text;
    return all;
}

/// Input that would exhaust memory, and JSON that readers interpret differently, is refused while parsing.
TEST_F(ScenesDescription, JsonHasABudget) {
    const std::string jack = R"("meshes": {"j": {"builtin": "jack"}}, "bodies": [{"mesh": "j"}])";
    EXPECT_EQ(failure("{" + jack + "}"), "no error");
    EXPECT_THAT(failure(R"({"frames": 1e999, )" + jack + "}"),
                HasSubstr("has a number that is too large for a double"));
    for (const auto& [open, close] : {std::pair{"[", "]"}, {R"({"a":)", "}"}})
        for (const std::size_t depth : {65u, 60000u})
            EXPECT_THAT(
                body_failure(R"("material": )" + repeated(open, depth) + "1" + repeated(close, depth)),
                HasSubstr("is nested deeper than 64 levels"));
    EXPECT_THAT(body_failure(R"("material": )" + repeated("[", 60000)), HasSubstr("is nested deeper than"));
    EXPECT_THAT(body_failure(R"("material": )" + repeated("[", 50) + repeated("]", 50)),
                HasSubstr("needs a scene with dynamics"));
    EXPECT_THAT(failure(R"({"frames": 2, "frames": 3, )" + jack + "}"),
                HasSubstr(R"(has the name "frames" twice in one object)"));
    EXPECT_THAT(failure(R"({"frames": 2, "fr\u0061mes": 3, )" + jack + "}"), HasSubstr(R"("frames" twice)"));
    EXPECT_THAT(failure(R"({"meshes": {"a\nb": {"builtin": "jack"}, "a\nb": {"builtin": "jack"}}})"),
                HasSubstr(R"("a\nb" twice)"));
    EXPECT_EQ(failure(R"({"meshes": {"j": {"builtin": "jack"}, "k": {"builtin": "jack"}},
                          "bodies": [{"mesh": "j"}, {"mesh": "k"}, {"mesh": "j"}]})"),
              "no error")
        << "one name in several objects";
    EXPECT_THAT(failure("{" + jack + std::string(std::size_t{64} << 20, ' ') + "}"),
                HasSubstr("is longer than the 64 MiB that a scene description or plan may have"));
}

/// A table of all pairs of materials would take 6 GB.
TEST_F(ScenesDescription, ThousandsOfMaterialsWithFewPairs) {
    std::string materials = R"("s": 1)";
    for (int i = 0; i < 14000; ++i) materials += fmt::format(R"(, "m{}": 1)", i);
    const auto scene = load(
        R"({"meshes": {"j": {"builtin": "jack"}}, "bodies": [{"mesh": "j", "material": "s"}, {"mesh": "j",
                 "material": "m7", "position": [5, 0, 0]}], "dynamics": {"materials": {)"
        + materials + R"(}, "surfaces": [{"a": "m7", "b": "s", "friction": 1, "restitution": 0}]}})");
    EXPECT_EQ(scene.dynamics->materials.names.size(), 14001u);
    EXPECT_EQ(scene.dynamics->materials.surfaces.size(), 1u);
    const auto& [m7, s] = scene.dynamics->materials.surfaces.begin()->first;
    EXPECT_EQ(scene.dynamics->materials.surface(s, m7).friction, 1);
}

TEST_F(ScenesDescription, ErrorsOfMaterialsNameThePath) {
    const auto materials = [&](const std::string& text) {
        return failure(R"({"meshes": {"j": {"builtin": "jack"}}, "bodies": [{"mesh": "j"}], "dynamics": {)"
                       + text + "}}");
    };
    EXPECT_EQ(materials(R"("materials": {"stone": 1})"), "no error")
        << "the only material is that of all bodies";
    EXPECT_THAT(materials(""), HasSubstr("/dynamics: has no materials"));
    EXPECT_THAT(materials(R"("materials": {"stone": 0})"),
                HasSubstr("/dynamics/materials/stone: must be above 0"));
    const auto surfaces = [&](const std::string& text) {
        return materials(R"("materials": {"s": 1}, "surfaces": [{"a": "s", "b": "s", )" + text + "]");
    };
    EXPECT_THAT(surfaces(R"("friction": -1, "restitution": 0})"),
                HasSubstr("/dynamics/surfaces/0/friction: must be from 0 to"));
    EXPECT_THAT(surfaces(R"("friction": 1, "restitution": 1.5})"),
                HasSubstr("/dynamics/surfaces/0/restitution: must be from 0 to 1"));
    EXPECT_THAT(surfaces(R"("friction": 1})"), HasSubstr("/dynamics/surfaces/0: has no restitution"));
    EXPECT_THAT(
        surfaces(
            R"("friction": 1, "restitution": 0}, {"a": "s", "b": "s", "friction": 1, "restitution": 0})"),
        HasSubstr("/dynamics/surfaces/1: names a pair of materials that has a surface already"));
    EXPECT_THAT(
        surfaces(
            R"("friction": 1, "restitution": 0}, {"a": "s", "b": "t", "friction": 1, "restitution": 0})"),
        HasSubstr("/dynamics/surfaces/1/b: unknown material 't'"));
    EXPECT_THAT(failure(R"({"frames": 2, "meshes": {"j": {"builtin": "jack"}}, "bodies": [{"mesh": "j"}],
                            "dynamics": {"materials": {"s": 1}}})"),
                HasSubstr("/frames: must be 1 or left out"));
    EXPECT_THAT(body_failure(R"("material": "s")"),
                HasSubstr("/bodies/0/material: needs a scene with dynamics"));
    EXPECT_THAT(failure(R"({"meshes": {"b": {"box": [1, 0, 1]}}, "bodies": [{"mesh": "b"}]})"),
                HasSubstr("/meshes/b/box: must have sides above 0"));
    EXPECT_THAT(
        failure(R"({"meshes": {"b": {"box": [1, 1, 1], "builtin": "jack"}}, "bodies": [{"mesh": "b"}]})"),
        HasSubstr("/meshes/b: must name one builtin, file or box"));
}

TEST_F(ScenesDescription, AdHocScenesTakePosesInOrder) {
    const auto path = write("one.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n"
                                        "0 1 0 0\n0 0 1 0\nTetrahedra 1\n1 2 3 4 0\nEnd\n");
    const std::vector<std::string> files{path, path};
    const std::vector<Pose> poses{{.translation = {1, 2, 3}}};
    const auto scene = scene_from_meshes(files, poses);
    ASSERT_EQ(scene.bodies.size(), 2u);
    EXPECT_EQ(vertex_count(scene), 8u);
    EXPECT_EQ(scene.frame(0).poses[0].translation, Eigen::Vector3d(1, 2, 3));
    EXPECT_TRUE(scene.frame(0).poses[1].translation.isZero());
    EXPECT_NE(scene.digest, scene_from_meshes(files, {}).digest);
}

} // namespace
} // namespace tandem
