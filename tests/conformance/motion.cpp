// SPDX-License-Identifier: MIT
// Setting motion: bounds of a frame and its successor, by every algorithm, against brute force and against
// the exact truth of frames in between.
#include "tests/support/frames_there.h"
#include "tests/support/limited.h"
#include "tests/support/message_of.h"
#include "tests/support/scenes.h"
#include "harness/verify/oracle/frame_truth.h"
#include "tests/support/on_device.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using ::testing::HasSubstr;

/// Settings of a cell that bounds motion; contacts need exact decisions.
SettingTexts moving(SettingTexts more = {}) {
    more["motion"] = "linear";
    if (!more.contains("decision")) more["contact_rule"] = "none";
    return more;
}

/// The frame at time `s` between two others, by straight lines and by the shorter rotation at constant speed.
Frame between(const Frame& frame, const Frame& next, double s) {
    Frame result = frame;
    for (std::size_t body = 0; body < frame.poses.size(); ++body) {
        result.poses[body].rotation = frame.poses[body].rotation.slerp(s, next.poses[body].rotation);
        result.poses[body].translation =
            (1 - s) * frame.poses[body].translation + s * next.poses[body].translation;
        for (std::size_t i = 0; i < frame.deformed[body].size(); ++i)
            result.deformed[body][i] = (1 - s) * frame.deformed[body][i] + s * next.deformed[body][i];
    }
    return result;
}

class MotionOf : public OnDevice {
protected:
    /// The reference of this session.
    static ReferenceAnswer right_for_motion(const Session& session, const Scene& scene,
                                            const FrameInput& input) {
        return reference(scene, input, geometry_of(session.settings()), true, Method::brute_force,
                         contact_settings_of(session.settings()));
    }

    Scene scene_ = crowd(11, 9, 2);
    Frame frame_ = scene_.frame(0), next_ = scene_.frame(1);
};

TEST_P(MotionOf, EveryAlgorithmFindsThePairsOfTheReference) {
    std::vector<SettingTexts> cells{{{"broad", "device"}}, {{"broad", "device"}, {"decision", "exact"}}};
    if (walks().size() > 2) {
        cells.push_back({{"broad", "tight"}, {"k", "8"}, {"precision", "double"}});
        cells.push_back({{"broad", "sphere"}, {"rounding", "nearest"}, {"pair_layout", "items"}});
        cells.push_back({{"broad", "device"}, {"placement", "exact"}, {"self", "deformable"}});
        cells.push_back({{"broad", "device"}, {"origin", "auto"}, {"k", "26"}});
    }
    for (const auto* traversal : walks())
        for (const auto& given : cells) {
            SCOPED_TRACE(std::string(traversal->name()) + text(given));
            const auto session = prepare(*traversal, scene_, moving(given));
            for (const auto& [from, to] : {std::pair{frame_, next_}, std::pair{next_, frame_}}) {
                const auto right = right_for_motion(*session, scene_, {from, &to});
                const auto still = right_for_motion(*session, scene_, from);
                const auto result = session->run({from, to});
                EXPECT_GT(result.count, still.digest.count + 100);
                EXPECT_EQ(result.digest(), right.digest);
                EXPECT_EQ(result.download(), right.pairs);
                if (!given.contains("decision")) continue;
                EXPECT_EQ(result.contact_digest(), right.contact_digest);
            }
        }
}

/// A frame that does not move has the pairs of one frame: nothing is widened.
TEST_P(MotionOf, WithoutMotionIsThatOfOneFrame) {
    for (const auto* traversal : walks())
        for (const std::string rounding : {"safe", "nearest"}) {
            if (walks().size() == 2 && rounding != "safe") continue;
            SCOPED_TRACE(std::string(traversal->name()) + " " + rounding);
            const auto session = prepare(*traversal, scene_, moving({{"rounding", rounding}}));
            const auto still = prepare(*traversal, scene_, {{"rounding", rounding}});
            EXPECT_EQ(session->run({frame_, frame_}).digest(), still->run(frame_).digest());
        }
}

/// Neither frame has pairs: a body passes through another between them.
TEST_P(MotionOf, FindsABodyThatPassesThroughAnother) {
    Scene two;
    two.name = two.key = "two";
    two.meshes = {one_tetrahedron(1)};
    two.bodies.resize(2);
    const auto at = [](double x, double angle) {
        Frame state;
        state.poses = {{Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())), {x, 0, 0}},
                       {}};
        state.deformed.resize(2);
        return state;
    };
    for (const auto* traversal : walks()) {
        SCOPED_TRACE(traversal->name());
        const auto session = prepare(*traversal, two, moving());
        EXPECT_EQ(session->run({at(-5, 0), at(-4, 0)}).count, 0u);
        EXPECT_EQ(session->run({at(-5, 0), at(5, 0)}).count, 1u);
        EXPECT_EQ(session->run({at(5, 0), at(-5, 0)}).count, 1u);
        EXPECT_EQ(session->run({at(5, 0), at(4, 0)}).count, 0u);
    }
    // A long bar turns by 180 degrees: it meets the other body only on the way.
    two.meshes.push_back(one_tetrahedron(1));
    for (auto& vertex : two.meshes[1].vertices) vertex = {vertex.x() * 10 + 2, vertex.y() * 0.1, vertex.z()};
    complete_mesh(two.meshes[1], "bar");
    two.bodies[0].mesh = 1;
    const auto turned = [&](double angle) {
        auto state = at(0, angle);
        state.poses[1].translation = {0, 8, 0};
        return state;
    };
    const double half = 3.141592653589793 / 2;
    EXPECT_EQ(prepare(algorithm("tiled"), two, moving())->run({turned(half - 1.5), turned(half + 1.5)}).count,
              1u);
}

/// Contacts are those of the frame, as without motion.
TEST_P(MotionOf, ContactsAreThoseOfTheFrame) {
    const SettingTexts exact{{"decision", "exact"}, {"broad", "device"}};
    for (const auto* traversal : walks()) {
        SCOPED_TRACE(traversal->name());
        const auto result = prepare(*traversal, scene_, moving(exact))->run({frame_, next_});
        const auto right = prepare(*traversal, scene_, exact)->run(frame_);
        ASSERT_GT(right.contacts, 20u);
        EXPECT_EQ(result.contacts, right.contacts);
        EXPECT_EQ(result.contact_digest(), right.contact_digest());
    }
}

TEST_P(MotionOf, BatchesGiveTheSameAnswer) {
    for (const auto* traversal : walks()) {
        SCOPED_TRACE(traversal->name());
        const auto given = moving({{"broad", "device"}});
        const auto right = prepare(*traversal, scene_, given)->run({frame_, next_});
        const Limited limit(on, least_bytes(on, *traversal, scene_, given) + 6 * right.count);
        const auto result = prepare(*traversal, scene_, given)->run({frame_, next_});
        EXPECT_GT(result.batches, 1u);
        EXPECT_EQ(result.digest(), right.digest());
    }
}

/// A tetrahedron that one of the two frames skips is in no pair.
TEST_P(MotionOf, LeavesOutWhatEitherFrameSkips) {
    frame_.skipped = {{1, 2, 3}, {}, {}, {}, {5}, {}, {}, {}, {}};
    next_.skipped = {{2, 9}, {0, 40}, {}, {}, {}, {}, {}, {}, {}};
    auto both = frame_;
    both.skipped = {{1, 2, 3, 9}, {0, 40}, {}, {}, {5}, {}, {}, {}, {}};
    auto both_next = next_;
    both_next.skipped = both.skipped;
    for (const auto* traversal : walks()) {
        SCOPED_TRACE(traversal->name());
        const auto session = prepare(*traversal, scene_, moving());
        const auto right = right_for_motion(*session, scene_, {both, &both_next});
        EXPECT_EQ(session->run({frame_, next_}).download(), right.pairs);
        EXPECT_EQ(session->run({both, next_}).download(), right.pairs);
    }
}

/// Frames in the device's memory have the bits of those in the host's.
TEST_P(MotionOf, FramesOnTheDeviceGiveTheSameAnswer) {
    for (const SettingTexts& given :
         {SettingTexts{{"broad", "device"}},
          SettingTexts{{"broad", "device"}, {"precision", "double"}, {"origin", "auto"}}})
        for (const bool floats : {false, true}) {
            const Rows rows(frame_, floats), next_rows(next_, floats);
            const auto session = prepare(algorithm("tiled"), scene_, moving(given));
            const auto right = session->run({rows.host, next_rows.host});
            const auto on_device = rows.uploaded_to(on), next_on_device = next_rows.uploaded_to(on);
            const auto other = prepare(algorithm("tiled"), scene_, moving(given));
            for (int i = 0; i < 2; ++i)
                EXPECT_EQ(other->run({on_device, next_on_device}).download(), right.download());
            EXPECT_EQ(session->run({on_device, next_on_device}, all_pairs(scene_)).digest(), right.digest());
        }
}

TEST_P(MotionOf, RefusesWhatDoesNotFit) {
    const auto& tiled = algorithm("tiled");
    const auto session = prepare(tiled, scene_, moving()), still = prepare(tiled, scene_, {});
    EXPECT_THAT(message_of([&] { session->run(frame_); }), HasSubstr("needs the frame's successor"));
    EXPECT_THAT(message_of([&] { still->run({frame_, next_}); }), HasSubstr("set motion=linear"));
    auto shorter = next_;
    shorter.deformed[1].pop_back();
    EXPECT_THAT(message_of([&] {
                    session->run({frame_, shorter});
                }),
                HasSubstr("body 1 has 27 vertices in the frame and 26 in its successor"));
    shorter = next_;
    shorter.poses.pop_back();
    EXPECT_THAT(message_of([&] {
                    session->run({frame_, shorter});
                }),
                HasSubstr("9 bodies and its successor has 8"));
    EXPECT_THAT(message_of([&] {
                    prepare(tiled, scene_, {{"motion", "linear"}});
                }),
                HasSubstr("choose decision=exact or contact_rule=none"));
    EXPECT_THAT(message_of([&] {
                    prepare(tiled, scene_, moving({{"rounding", "published"}}));
                }),
                HasSubstr("choose rounding=safe"));
    EXPECT_THAT(message_of([&] {
                    prepare(tiled, scene_, moving({{"slabs", "three"}}));
                }),
                HasSubstr("choose slabs=all"));
    EXPECT_THAT(message_of([&] {
                    prepare(algorithm("chunked"), scene_, moving({{"residency", "published"}}));
                }),
                HasSubstr("leave residency and preset out"));
    EXPECT_EQ(session->run({frame_, next_}).digest(),
              right_for_motion(*session, scene_, {frame_, &next_}).digest)
        << "the session remains usable";
}

/// The exact truth of frames in between, of which none is missed. Bodies turn by large angles.
TEST(ExactMotion, IsMissedByNoPairOnTheWay) {
    const auto scene = crowd(11, 9, 2);
    const auto frame = scene.frame(0), next = scene.frame(1);
    for (const SettingTexts& given :
         {SettingTexts{{"k", "6"}, {"placement", "exact"}}, SettingTexts{{"k", "18"}, {"placement", "exact"}},
          SettingTexts{{"k", "26"}, {"precision", "double"}}}) {
        SCOPED_TRACE(text(given));
        const auto found = prepare_on(device("host"), algorithm("tiled"), scene, moving(given))
                               ->run({frame, next})
                               .download();
        const auto still = prepare_on(device("host"), algorithm("tiled"), scene, given);
        const auto ends =
            pair_errors(frame_truth(scene, between(frame, next, 0.5), {Precision::fp64, Placement::exact}),
                        still->run(frame).download());
        EXPECT_GT(ends.missed_overlapping, 100u) << "bounds of one frame miss what happens on the way";
        for (const double s : {0.0, 0.1, 0.25, 0.5, 0.7, 0.9, 1.0}) {
            const auto truth =
                frame_truth(scene, between(frame, next, s), {Precision::fp64, Placement::exact});
            ASSERT_GT(truth.overlapping.size(), 100u);
            EXPECT_EQ(pair_errors(truth, found).missed_overlapping, 0u) << s;
        }
    }
}

/// Two devices share the bodies, which move further than the skin of the first partition.
TEST(SharedMotion, IsFoundByOneDeviceOrTheOther) {
    const auto scene = crowd(5, 24, 6);
    const std::array devices{&device("host"), &device("opencl:0")};
    for (const std::string broad : {"device", "tight"})
        for (const auto* traversal : {&algorithm("tiled"), &algorithm("chunked")}) {
            SCOPED_TRACE(std::string(traversal->name()) + " " + broad);
            const auto given = moving({{"broad", broad}});
            const auto session = traversal->prepare(devices, scene, resolved(*traversal, given));
            for (std::size_t i = 0; i < 3; ++i) {
                const auto frame = scene.frame(i % 2), next = scene.frame((i + 1) % 2);
                EXPECT_EQ(session->run({frame, next}).download(),
                          reference(scene, {frame, &next}, geometry_of(session->settings()), false,
                                    Method::brute_force, contact_settings_of(session->settings()))
                              .pairs);
            }
        }
}

TANDEM_ON_DEVICES(MotionOf);

} // namespace
} // namespace tandem
