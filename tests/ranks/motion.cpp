// SPDX-License-Identifier: MIT
// Settings motion=linear and margin on the ranks of a job: ghosts are the bodies that could meet an own body
// on the path to the frame's successor, or come within the margin.
#include "base/error.h"
#include "tests/ranks/support.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

const SettingTexts swept{{"motion", "linear"}, {"decision", "exact"}};

class RankMotion : public RankSessions {
protected:
    void expect_paths_equal(const Scene& scene, const SettingTexts& more = {}) {
        auto given = swept;
        given.insert(more.begin(), more.end());
        for (const auto* traversal : algorithms()) {
            SCOPED_TRACE(traversal->name());
            expect_frames_equal(scene, *traversal, own_device(), given);
        }
    }
};

/// From bodies whose ghosts outlast frames to bodies that pass several others on a path.
TEST_F(RankMotion, CombinedAnswersEqualOneDevice) {
    for (const double step : {0.02, 0.35, 3.0}) {
        SCOPED_TRACE(step);
        expect_paths_equal(soft_procession(24, 3, step));
    }
}

/// Neighbours in frames 0 and 1 are the same; halfway every other body passes the next one.
Scene leaping_row(std::uint32_t bodies) {
    auto scene = procession(bodies, 3, 0);
    scene.frame = [bodies](std::size_t number) {
        Frame frame;
        frame.deformed.resize(bodies);
        for (std::uint32_t i = 0; i < bodies; ++i)
            frame.poses.push_back(
                {Eigen::Quaterniond::Identity(), {3.0 * i + (i % 2 == 1 && number % 2 == 1 ? 12 : 0), 0, 0}});
        return frame;
    };
    scene.bodies.assign(bodies, Body{});
    scene.digest = digest_of(scene);
    return scene;
}

TEST_F(RankMotion, GhostsAreWithinTheMargin) {
    for (const std::string margin : {"0.3", "2.5"}) {
        SCOPED_TRACE(margin);
        expect_paths_equal(soft_procession(24, 3, 0.35), {{"margin", margin}});
    }
    expect_frames_equal(leaping_row(24), algorithm("tiled"), own_device(), {{"margin", "2.5"}});
    for (const std::string output : {"pairs", "distances"})
        expect_frames_equal(procession(24, 3, 0.35), algorithm("tiled"), own_device(),
                            {{"margin", "0.5"}, {"contact_rule", "distance"}, {"output", output}});
}

/// Arcs about distant origins of meshes are longer than skins.
TEST_F(RankMotion, CentredMeshesMoveOnArcs) {
    expect_paths_equal(with_distant_meshes(procession(24, 3, 0.02), {1e4}), {{"origin", "auto"}});
}

/// Bodies that overlap in no frame, only on the path between two.
TEST_F(RankMotion, BodiesMeetOnThePathOnly) {
    const auto scene = leaping_row(24);
    const auto still = alone(algorithm("tiled"), scene);
    EXPECT_EQ(still->run(scene.frame(0)).count + still->run(scene.frame(1)).count, 0u);
    expect_paths_equal(scene);
}

/// A deformable body's pairs with itself are found by its owner; rounding bounds of placement=exact hold too.
TEST_F(RankMotion, SelfPairsAndExactPlacement) {
    expect_paths_equal(soft_procession(12, 3, 0.1), {{"self", "on"}, {"placement", "exact"}});
}

/// A tetrahedron that one of two frames skips has no path.
TEST_F(RankMotion, TetrahedraSkippedInEitherFrame) {
    expect_paths_equal(skipping(soft_procession(16, 3, 0.1), [](std::uint32_t body, std::uint32_t frame) {
        return std::vector{body % 5, 40 - frame};
    }));
}

TEST_F(RankMotion, NeedsASuccessor) {
    const auto scene = procession(6, 2, 0.1);
    const auto& tiled = algorithm("tiled");
    const auto session = tiled.prepare(own_device(), scene, settings_of(tiled, swept), *job);
    EXPECT_THAT([&] { session->run(scene.frame(0)); },
                testing::ThrowsMessage<InputError>(testing::HasSubstr("needs the frame's successor")));
    const auto still = tiled.prepare(own_device(), scene, settings_of(tiled), *job);
    EXPECT_THAT(
        [&] {
            still->run({scene.frame(0), scene.frame(1)});
        },
        testing::ThrowsMessage<InputError>(testing::HasSubstr("set motion=linear")));
}

} // namespace
} // namespace tandem
