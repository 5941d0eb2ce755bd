// SPDX-License-Identifier: MIT
// Families about motion and about pairs of one body: the oracle confirms what the constructions define.
#include "harness/verify/oracle/motion_truth.h"
#include "scenes/hard/hard.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

Scene of_difficulty(const HardFamily& family, double difficulty, int seed = 1) {
    return make_scene(fmt::format("hard:{}:difficulty={},seed={}", family.name, difficulty, seed));
}

/// Exactly every second pair of bodies meets on the way, at every difficulty and in both precisions, and none
/// in either frame.
TEST(HardMotion, HasTheConstructedMeetings) {
    unsigned scenes = 0;
    for (const auto& family : hard_families()) {
        if (!family.motion) continue;
        for (const double e : {family.knob.least, family.knob.initial, family.knob.most})
            for (const auto precision : {Precision::fp32, Precision::fp64}) {
                SCOPED_TRACE(fmt::format("{} {} {}", family.name, e, static_cast<int>(precision)));
                const auto scene = of_difficulty(family, e);
                ASSERT_EQ(scene.frame_count, 2u);
                const auto from = scene.frame(0), to = scene.frame(1);
                const auto truth = motion_truth(scene, from, to, precision);
                std::vector<Pair> expected;
                for (std::uint32_t body = 0; body < scene.bodies.size(); body += 4)
                    expected.push_back({body, 0, body + 1, 0});
                ASSERT_NE(family.meeting, nullptr);
                EXPECT_EQ(expected.size(), family.meeting(e));
                EXPECT_EQ(truth.colliding, expected);
                EXPECT_TRUE(truth.undecided.empty());
                for (const auto& frame : {from, to}) {
                    const auto still = frame_truth(scene, frame, precision);
                    EXPECT_EQ(still.touching.size() + still.overlapping.size(), 0u);
                }
                ++scenes;
            }
    }
    EXPECT_EQ(scenes, 60u);
}

/// More seeds than one, because parameters of the constructions are random.
TEST(HardMotion, HasTheConstructedMeetingsForManySeeds) {
    for (const auto& family : hard_families())
        for (int seed = 2; family.motion && seed < 12; ++seed) {
            SCOPED_TRACE(fmt::format("{} {}", family.name, seed));
            const auto scene = of_difficulty(family, family.knob.initial, seed);
            const auto truth = motion_truth(scene, scene.frame(0), scene.frame(1), Precision::fp32);
            EXPECT_EQ(truth.colliding.size(), family.meeting(family.knob.initial));
            EXPECT_TRUE(truth.undecided.empty());
        }
}

/// Pairs of tetrahedra of each body that meet.
std::vector<std::uint64_t> meeting_within(const Scene& scene) {
    const auto truth = frame_truth(scene, scene.frame(0),
                                   {Precision::fp32, Placement::rounded, Origin::world, SelfPairs::on});
    std::vector<std::uint64_t> counts(scene.bodies.size());
    for (const auto* pairs : {&truth.touching, &truth.overlapping})
        for (const auto& pair : *pairs) {
            EXPECT_EQ(pair.body_a, pair.body_b) << "bodies of these scenes are apart";
            ++counts[pair.body_a];
        }
    return counts;
}

/// Parts of body 0 are apart at every difficulty, and those of body 1 touch.
TEST(HardWithin, PartsTouchOrAreApart) {
    for (const std::string name : {"nearly-shared", "folded-flat", "coil"}) {
        const auto& family = hard_family(name);
        for (const double e : {family.knob.least, family.knob.initial, family.knob.most})
            for (const int seed : {1, 2, 3}) {
                SCOPED_TRACE(fmt::format("{} {} {}", name, e, seed));
                const auto counts = meeting_within(of_difficulty(family, e, seed));
                ASSERT_EQ(counts.size(), 2u);
                EXPECT_EQ(counts[0], 0u);
                EXPECT_GT(counts[1], 20u);
                if (family.meeting != nullptr) {
                    EXPECT_EQ(counts[1], family.meeting(e));
                }
            }
    }
}

TEST(HardWithin, WedgesTouchAtEveryThickness) {
    const auto& family = hard_family("wedges");
    for (const double e : {family.knob.least, family.knob.initial, family.knob.most})
        EXPECT_EQ(meeting_within(of_difficulty(family, e)), std::vector{family.meeting(e)}) << e;
}

TEST(HardWithin, DisplacedVerticesInvertElements) {
    const auto scene = make_scene("hard:inverted-elements");
    EXPECT_GT(scene.meshes.front().inverted, 5u);
    EXPECT_GT(meeting_within(scene).front(), 50u);
}

} // namespace
} // namespace tandem
