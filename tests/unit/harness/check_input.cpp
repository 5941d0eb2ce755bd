// SPDX-License-Identifier: MIT
// Mistakes in scenes and frames of an embedding program: each gives one line before anything is read.
#include "algorithms/traversal.h"
#include "base/error.h"
#include "tests/support/cells.h"
#include "tests/support/message_of.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using testing::HasSubstr;

/// Four boxes, of which the first is fixed and the second deformable.
class CheckInput : public testing::Test {
protected:
    CheckInput() : session_(prepared(scene_)) {}

    static std::unique_ptr<Session> prepared(const Scene& scene, const SettingTexts& given = {}) {
        const std::array one{&device("host")};
        const auto& tiled = algorithm("tiled");
        return tiled.prepare(one, scene, tiled.settings(given));
    }
    /// The mistake of a frame that `change` has spoiled.
    std::string of_frame(const std::function<void(Frame&)>& change) {
        auto frame = scene_.frame(0);
        change(frame);
        return message_of([&] { session_->run(frame); });
    }
    /// The mistake of a scene that `change` has spoiled.
    std::string of_scene(const std::function<void(Scene&)>& change) const {
        auto scene = scene_;
        change(scene);
        return message_of([&] { prepared(scene); });
    }

    Scene scene_ = procession(4, 3, 0.1);
    std::unique_ptr<Session> session_;
};

TEST_F(CheckInput, FramesAreCheckedBeforeTheyAreRead) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<std::pair<std::function<void(Frame&)>, std::string>> mistakes{
        {[](Frame& frame) { frame.poses.resize(3); }, "the frame has 3 poses for 4 bodies"},
        {[](Frame& frame) { frame.poses.resize(5); }, "the frame has 5 poses for 4 bodies"},
        {[](Frame& frame) { frame.deformed.clear(); }, "the frame has 0 lists of vertices"},
        {[](Frame& frame) { frame.deformed[1].pop_back(); },
         "body 1 is deformable and has 26 vertices in the frame and 27"},
        {[](Frame& frame) { frame.deformed[1].clear(); }, "body 1 is deformable and has 0 vertices"},
        {[](Frame& frame) { frame.poses[2].rotation.coeffs().setZero(); },
         "body 2 has a rotation of length 0;"},
        {[](Frame& frame) { frame.poses[3].rotation.coeffs() *= 2; }, "body 3 has a rotation of length 2;"},
        {[](Frame& frame) { frame.poses[3].rotation.x() = nan; }, "body 3 has a rotation of length nan;"},
        {[](Frame& frame) { frame.poses[2].translation.y() = nan; },
         "body 2 has a position that is not finite"},
        {[](Frame& frame) { frame.poses[2].translation.y() = 1e37; }, "body 2 has a coordinate of 1e+37"},
        {[](Frame& frame) { frame.deformed[1][5].z() = nan; }, "body 1: vertex 5 is not finite"},
        {[](Frame& frame) { frame.skipped.resize(2); }, "the frame has 2 lists of skipped tetrahedra"},
        {[](Frame& frame) {
             frame.skipped.assign(4, {}), frame.skipped[2] = {3, 3};
         },
         "body 2: skipped tetrahedra must be ascending"},
        {[](Frame& frame) {
             frame.skipped.assign(4, {}), frame.skipped[2] = {7, 9999};
         },
         "body 2: skipped tetrahedra must be ascending and below 48"}};
    for (const auto& [change, expected] : mistakes) EXPECT_THAT(of_frame(change), HasSubstr(expected));
    EXPECT_EQ(of_frame([](Frame&) {}), "no error");
    EXPECT_GT(session_->run(scene_.frame(0)).count, 0u) << "the session can be used after mistakes";
}

TEST_F(CheckInput, BodyPairsAreCheckedBeforeTheyAreRead) {
    const auto frame = scene_.frame(0);
    EXPECT_THAT(message_of([&] {
                    session_->run(frame, std::array{BodyPair{1, 4}});
                }),
                HasSubstr("run() got the body pair 1, 4"));
    EXPECT_THAT(message_of([&] {
                    session_->run(frame, std::array{BodyPair{2, 1}});
                }),
                HasSubstr("run() got the body pair 2, 1"));
    EXPECT_THAT(message_of([&] {
                    session_->run(frame, std::array{BodyPair{2, 2}});
                }),
                HasSubstr("a pair of body 2 with itself"));
    EXPECT_GT(session_->run(frame, std::array{BodyPair{1, 2}}).count, 0u);
}

TEST_F(CheckInput, SuccessorsAreCheckedToo) {
    const auto moving = prepared(scene_, {{"motion", "linear"}, {"contact_rule", "none"}});
    const auto frame = scene_.frame(0);
    auto next = scene_.frame(1);
    next.poses[2].rotation.coeffs().setZero();
    EXPECT_THAT(message_of([&] {
                    moving->run({frame, next});
                }),
                HasSubstr("successor: body 2 has a rotation of length 0;"));
}

TEST_F(CheckInput, ScenesAreCheckedBeforeTheyArePrepared) {
    const std::vector<std::pair<std::function<void(Scene&)>, std::string>> mistakes{
        {[](Scene& scene) { scene.bodies.clear(); }, "has no bodies"},
        {[](Scene& scene) { scene.bodies[3].mesh = 7; }, "body 3 has mesh 7, and the scene has 1 meshes"},
        {[](Scene& scene) { scene.meshes[0].tetrahedra.clear(); }, "mesh 0 has no tetrahedra"},
        {[](Scene& scene) { scene.meshes[0].boundary.clear(); }, "call complete_mesh"},
        {[](Scene& scene) { scene.meshes[0].tetrahedra[4][2] = 27; },
         "mesh 0: tetrahedron 4 has vertex 27 of 27"},
        {[](Scene& scene) { scene.meshes[0].vertices[3].x() = std::numeric_limits<double>::infinity(); },
         "mesh 0: vertex 3 has a coordinate that is not finite or exceeds 1e+36"},
        {[](Scene& scene) {
             scene.never_meet = {{2, 3}, {0, 1}};
         },
         "never_meet must be ascending"},
        {[](Scene& scene) {
             scene.never_meet = {{2, 9}};
         },
         "never_meet has the pair 2, 9"}};
    for (const auto& [change, expected] : mistakes) EXPECT_THAT(of_scene(change), HasSubstr(expected));
    EXPECT_EQ(of_scene([](Scene& scene) { scene.meshes.emplace_back(); }), "no error")
        << "no body has this mesh";
    EXPECT_EQ(of_scene([](Scene& scene) { scene.frame = nullptr; }), "no error")
        << "no setting needs frame 0";
}

TEST_F(CheckInput, Devices) {
    const auto& tiled = algorithm("tiled");
    auto* host = &device("host");
    const auto refused = [&](const std::vector<Device*>& devices) {
        return message_of([&] { tiled.prepare(devices, scene_, tiled.settings({})); });
    };
    EXPECT_EQ(refused({}), "tiled needs a device to run on");
    EXPECT_THAT(refused({host, nullptr}), HasSubstr("number 1 is a null pointer"));
    EXPECT_THAT(refused({host, host}), HasSubstr("host is named twice"));
}

TEST_F(CheckInput, SettingsByName) {
    const auto& tiled = algorithm("tiled");
    EXPECT_EQ(tiled.settings({{"k", "8"}}).text("k"), "8");
    EXPECT_EQ(algorithm("chunked").settings({}, "paper").text("seed_threshold"), "10000000");
    EXPECT_THAT(message_of([&] { tiled.settings({{"kk", "8"}}); }), HasSubstr("kk"));
    EXPECT_THAT(message_of([&] { tiled.settings({}, "fast"); }), HasSubstr("fast"));
}

TEST_F(CheckInput, UncheckedFramesHaveTheSameAnswer) {
    const auto frame = scene_.frame(1);
    EXPECT_EQ(session_->run(FrameView(frame).checked()).digest(), session_->run(frame).digest());
    auto longer = frame;
    longer.poses[2].rotation.coeffs() *= 2;
    EXPECT_EQ(message_of([&] { session_->run(FrameView(longer).checked()); }), "no error");
}

} // namespace
} // namespace tandem
