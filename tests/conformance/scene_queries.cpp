// SPDX-License-Identifier: MIT
// Queries of one tree over all bodies (leaf_query with tree=scene): trees that are kept over frames, lists of
// partners, and bodies that never meet. Tests of all algorithms cover the rest.
#include "tests/support/limited.h"
#include "tests/support/scenes.h"
#include "tests/support/on_device.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

class SceneLeafQueries : public OnDevice {
protected:
    std::unique_ptr<Session> prepare(const Scene& scene, SettingTexts given = {}) {
        given.insert({"tree", "scene"});
        return prepare_on(on, algorithm("leaf_query"), scene, given);
    }
    static void expect_equal(const FrameResult& result, const Scene& scene, const Frame& frame) {
        const auto right = reference(scene, frame, {}, true, Method::brute_force);
        ASSERT_GT(right.digest.count, 0u);
        expect_same_digests(result, right);
    }
};

/// Bodies move and rotate by more than their size, so that a kept tree has leaves far from their neighbours.
TEST_P(SceneLeafQueries, OfAKeptTreeFindEveryPair) {
    const auto scene = procession(9, 9, 1.3);
    for (const auto& [rebuild, built] : {std::pair{"1", std::vector{1, 1, 1, 1, 1, 1, 1, 1, 1}},
                                         std::pair{"3", std::vector{1, 0, 0, 1, 0, 0, 1, 0, 0}},
                                         std::pair{"100", std::vector{1, 0, 0, 0, 0, 0, 0, 0, 0}}}) {
        SCOPED_TRACE(rebuild);
        const auto session = prepare(scene, {{"rebuild", rebuild}, {"broad", "device"}});
        for (std::size_t i = 0; i < scene.frame_count; ++i) {
            const auto frame = scene.frame(i);
            const auto result = session->run(frame);
            expect_equal(result, scene, frame);
            EXPECT_EQ(result.rebuilds, static_cast<std::uint64_t>(built[i])) << "frame " << i;
        }
        session->reset();
        EXPECT_EQ(session->run(scene.frame(0)).rebuilds, 1u) << "the first frame after a reset";
    }
}

/// Two fixed bodies that overlap are in no pair unless the caller gives it.
TEST_P(SceneLeafQueries, FindPairsOfFixedBodiesOnlyIfGiven) {
    auto scene = procession(4, 1, 0);
    for (const auto body : {2u, 3u}) scene.bodies[body].fixed = true;
    const auto frame = scene.frame(0);
    const auto session = prepare(scene);
    const auto found = session->run(frame).download();
    ASSERT_FALSE(found.empty());
    for (const auto& pair : found) EXPECT_FALSE(pair.body_a == 2 && pair.body_b == 3);
    const auto given = session->run(frame, std::array{BodyPair{2, 3}});
    EXPECT_GT(given.count, 0u);
    EXPECT_EQ(given.digest(),
              prepare_on(on, algorithm("chunked"), scene)->run(frame, std::array{BodyPair{2, 3}}).digest());
    EXPECT_EQ(session->run(frame).download(), found);
}

/// The number of tests shows that queries leave out nodes of their own body.
TEST_P(SceneLeafQueries, LeaveOutNodesOfTheirOwnBody) {
    const auto scene = procession(2, 1, 0);
    const auto tests = [&](const std::string& self) {
        const auto session = prepare(scene, {{"self", self}, {"contact_rule", "none"}});
        session->count_work(true);
        return session->run(scene.frame(0)).work.at("bvtt_nodes");
    };
    const auto apart = tests("off");
    EXPECT_GT(apart, 0u);
    EXPECT_LT(2 * apart, tests("on"));
}

TANDEM_ON_DEVICES(SceneLeafQueries);

} // namespace
} // namespace tandem
