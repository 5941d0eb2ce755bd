// SPDX-License-Identifier: MIT
#include "scenes/error.h"
#include "scenes/scene.h"

#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace tandem {

namespace {

using testing::HasSubstr;

/// A folder per test, with scene.json and whatever else the test writes.
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
        try {
            load(text);
        } catch (const InputError& error) {
            return error.what();
        }
        return "no error";
    }
    /// The failure of a scene of one jack with these further names of its body.
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
    EXPECT_THAT(body_failure(R"("spin": [0, 0, 0, 1])"), HasSubstr("/bodies/0/spin: must have an axis"));
    EXPECT_THAT(body_failure(R"("poses": [[0, 0, 0, 1, 0, 0, 0]])"), HasSubstr("one pose a frame, 2 in all"));
    EXPECT_THAT(body_failure(R"("fixed": true, "velocity": [1, 0, 0])"), HasSubstr("is fixed and moves"));
    EXPECT_THAT(body_failure(R"("spin": [0, 0, 1, 1e300])"),
                HasSubstr("/bodies/0/spin: must turn by no more"));
    EXPECT_THAT(body_failure(R"("poses": [[0,0,0,1,0,0,0], [0,0,0,1,0,0,0]], "spin": [0, 0, 1, 1])"),
                HasSubstr("/bodies/0/spin: is replaced by poses"));
}

TEST_F(ScenesDescription, DigestSeesEveryFrame) {
    const auto digest = [&](const std::string& middle) {
        return load(R"({"frames": 3, "meshes": {"j": {"builtin": "jack"}}, "bodies": [{"mesh": "j", "poses": [
                    [0, 0, 0, 1, 0, 0, 0], )"
                    + middle + ", [1, 0, 0, 1, 0, 0, 0]]}]}")
            .digest;
    };
    EXPECT_NE(digest("[0, 0, 0, 1, 0, 0, 0]"), digest("[9, 0, 0, 1, 0, 0, 0]"));
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
