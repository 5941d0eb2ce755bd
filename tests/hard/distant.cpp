// SPDX-License-Identifier: MIT
// Family far: every algorithm gives the answer of the bodies near the origin at every distance, whether the
// mesh, the pose or both move them.
#include "tests/hard/support.h"
#include "tests/support/on_device.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace hard_test;
using namespace support;

constexpr std::array distances{1.0, 7.0, 30.0, 1e3, 1e6, 1e9};

Scene scene_at(double distance, int seed = 1) {
    return make_scene(fmt::format("hard:far:difficulty={},seed={}", distance, seed));
}

/// The pairs of each couple of bodies, with the numbers of the first couple.
std::array<std::set<Pair>, 3> by_couple(const auto& pairs) {
    std::array<std::set<Pair>, 3> result;
    for (const auto& pair : pairs) {
        EXPECT_EQ(pair.body_a / 2, pair.body_b / 2);
        result.at(pair.body_a / 2).insert({pair.body_a % 2, pair.tet_a, pair.body_b % 2, pair.tet_b});
    }
    return result;
}

std::set<Pair> met_in(const FrameTruth& truth) {
    std::set<Pair> met(truth.overlapping.begin(), truth.overlapping.end());
    met.insert(truth.touching.begin(), truth.touching.end());
    return met;
}

TEST(HardDistant, TruthIsThatOfTheBodiesNearTheOrigin) {
    const auto near = by_couple(met_in(rounded_truth(scene_at(1), Origin::world)))[0];
    ASSERT_EQ(3 * near.size(), hard_family("far").meeting(1));
    for (const double distance : distances)
        for (const int seed : {1, 2}) {
            const auto scene = scene_at(distance, seed);
            const auto exact = frame_truth(scene, scene.frame(0), {Precision::fp32, Placement::exact});
            for (const auto& truth : {exact, rounded_truth(scene, Origin::automatic)})
                for (const auto& met : by_couple(met_in(truth))) EXPECT_EQ(met, near) << distance;
        }
}

/// What origin=world leaves of it in single precision, whose numbers are half a size apart there.
TEST(HardDistant, RoundingInTheWorldLosesPairs) {
    const auto scene = scene_at(1e7);
    const auto couples = by_couple(met_in(rounded_truth(scene, Origin::world)));
    const auto near = by_couple(met_in(rounded_truth(scene_at(1), Origin::world)))[0];
    std::size_t lost = 0;
    for (const auto& pair : near) lost += couples[0].contains(pair) ? 0 : 1;
    EXPECT_GT(lost, near.size() / 20);
}

class HardDistances : public OnDevice {
protected:
    FrameResult run(const Traversal& traversal, const Scene& scene, SettingTexts given) {
        given["origin"] = "auto";
        return prepare(traversal, scene, given)->run(scene.frame(0));
    }
};

/// No coordinate is rounded, so that even candidate pairs are equal.
TEST_P(HardDistances, HaveTheSameCandidates) {
    for (const auto* traversal : algorithms()) {
        const SettingTexts given{{"contact_rule", "none"}};
        const auto near = by_couple(run(*traversal, scene_at(1), given).download())[0];
        EXPECT_GT(3 * near.size(), hard_family("far").meeting(1));
        for (const double distance : distances)
            for (const auto& found : by_couple(run(*traversal, scene_at(distance), given).download()))
                EXPECT_EQ(found, near) << traversal->name() << " " << distance;
    }
}

/// Contacts of exactly the pairs that meet.
TEST_P(HardDistances, HaveContactsOfThePairsThatMeet) {
    const auto near = by_couple(met_in(rounded_truth(scene_at(1), Origin::world)))[0];
    const SettingTexts given{{"contact_rule", "sat"}, {"decision", "recheck"}};
    for (const double distance : distances) {
        std::set<Pair> pairs;
        for (const auto& contact : run(algorithm("tiled"), scene_at(distance), given).download_contacts())
            pairs.insert(contact.pair);
        for (const auto& found : by_couple(pairs)) EXPECT_EQ(found, near) << distance;
    }
}

/// placement=exact misses no pair that meets in the scene's doubles, under any rotation.
TEST_P(HardDistances, AreCoveredByExactPlacement) {
    Random random(4);
    for (const double distance : distances) {
        auto scene = scene_at(distance);
        auto frame = scene.frame(0);
        const auto turn = random.rotation();
        for (auto& pose : frame.poses) pose = {turn * pose.rotation, turn * pose.translation};
        scene.frame = [frame](std::size_t) { return frame; };
        const auto met = met_in(frame_truth(scene, frame, {Precision::fp32, Placement::exact}));
        const auto found = run(algorithm("tiled"), scene, {{"placement", "exact"}, {"contact_rule", "none"}});
        const auto pairs = found.download();
        EXPECT_GT(met.size(), 300u);
        EXPECT_TRUE(std::ranges::includes(pairs, met)) << distance;
        if (distance <= 1e6) {
            EXPECT_LT(pairs.size(), 10 * met.size()) << "the bound on drift is that of centred meshes";
        }
    }
}

TANDEM_ON_DEVICES(HardDistances);

} // namespace
} // namespace tandem
