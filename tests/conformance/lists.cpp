// SPDX-License-Identifier: MIT
// Algorithm listed: lists are kept while bodies move by less than the pad, and every frame has the answer of
// a walk.
#include "tests/support/cells.h"
#include "tests/support/flawed.h"
#include "tests/support/frames_there.h"
#include "tests/support/limited.h"
#include "tests/support/scenes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace tandem {
namespace {

using namespace support;

/// Boxes in a row that overlap their neighbours; in a frame they move by about a hundredth of a tetrahedron.
Scene slow_row() { return procession(7, 40, 0.002); }

class Lists : public testing::TestWithParam<std::string> {
protected:
    std::unique_ptr<Session> listed_on(const Scene& scene, const SettingTexts& given = {}) {
        return prepare_on(on, algorithm("listed"), scene, given);
    }
    /// Runs a frame, compares the answer with brute force, and returns whether the list was kept.
    static bool keeps(Session& session, const Scene& scene, const Frame& frame) {
        const auto result = session.run(frame);
        const auto right = reference(scene, frame, geometry_of(session.settings()), true, Method::brute_force,
                                     contact_settings_of(session.settings()));
        EXPECT_EQ(result.count, right.digest.count);
        EXPECT_EQ(result.digest(), right.digest);
        EXPECT_EQ(result.contact_digest(), right.contact_digest);
        EXPECT_LE(result.rebuilds, 1u);
        return result.rebuilds == 0;
    }
    /// Runs frames until one keeps its list; returns its number.
    static std::size_t run_until_kept(Session& session, const Scene& scene) {
        std::size_t index = 0;
        while (index < scene.frame_count && !keeps(session, scene, scene.frame(index))) ++index;
        EXPECT_LT(index, scene.frame_count) << "no list was kept";
        return index;
    }

    Device& on = device(GetParam());
};

TEST_P(Lists, AreKeptAndMadeAgainInEveryGeometry) {
    const auto scene = slow_row();
    for (const auto& given : std::vector<SettingTexts>{{{"k", "6"}},
                                                       {{"k", "18"}},
                                                       {{"k", "26"}, {"precision", "double"}},
                                                       {{"k", "8"}, {"rounding", "published"}},
                                                       {{"k", "14"}, {"placement", "exact"}},
                                                       {{"k", "18"}, {"group_size", "32"}},
                                                       {{"k", "18"}, {"self", "on"}, {"group_size", "64"}}}) {
        SCOPED_TRACE(text(given));
        const auto session = listed_on(scene, given);
        std::size_t kept = 0, last_made = 0;
        for (std::size_t i = 0; i < 24; ++i) {
            if (keeps(*session, scene, scene.frame(i)))
                ++kept;
            else
                last_made = i;
        }
        EXPECT_GE(kept, 12u) << "lists last several frames";
        EXPECT_GT(last_made, 2u) << "a list is made again once bodies have moved by the pad";
    }
}

/// The pad of a list is far below a body, so that one frame crosses it.
TEST_P(Lists, EndWhenABodyCrossesThePadOrTeleports) {
    const auto scene = slow_row();
    for (const double distance : {0.05, 1.7}) {
        const auto session = listed_on(scene);
        const auto index = run_until_kept(*session, scene);
        auto frame = scene.frame(index);
        frame.poses[3].translation.x() += distance;
        EXPECT_FALSE(keeps(*session, scene, frame));
        EXPECT_FALSE(keeps(*session, scene, scene.frame(index))) << "and back";
        for (auto& vertex : frame.deformed[1]) vertex.x() += distance; // a deformable body
        keeps(*session, scene, scene.frame(index));
        EXPECT_TRUE(keeps(*session, scene, scene.frame(index)));
        frame.poses = scene.frame(index).poses;
        EXPECT_FALSE(keeps(*session, scene, frame));
    }
}

TEST_P(Lists, AnswerFramesOutOfOrder) {
    const auto scene = slow_row();
    const auto session = listed_on(scene);
    std::size_t kept = 0;
    for (const std::size_t i : {0u, 1u, 2u, 3u, 39u, 2u, 3u, 2u, 1u, 20u, 0u, 0u, 0u, 1u})
        kept += keeps(*session, scene, scene.frame(i)) ? 1 : 0;
    EXPECT_GE(kept, 4u);
}

TEST_P(Lists, EndWithTheTetrahedraThatFramesSkip) {
    const auto scene = slow_row();
    const auto session = listed_on(scene);
    auto frame = scene.frame(run_until_kept(*session, scene));
    const auto all = frame;
    frame.skipped.resize(scene.bodies.size());
    frame.skipped[2] = {0, 5, 17};
    EXPECT_FALSE(keeps(*session, scene, frame));
    keeps(*session, scene, frame);
    EXPECT_TRUE(keeps(*session, scene, frame));
    EXPECT_FALSE(keeps(*session, scene, all)) << "tetrahedra that come back";
}

TEST_P(Lists, EndWithReset) {
    const auto scene = slow_row();
    const auto session = listed_on(scene);
    const auto frame = scene.frame(run_until_kept(*session, scene));
    session->reset();
    EXPECT_FALSE(keeps(*session, scene, frame));
    EXPECT_FALSE(keeps(*session, scene, frame)) << "the first list after a reset";
    EXPECT_TRUE(keeps(*session, scene, frame));
}

/// Two bodies whose volumes are apart when the list is made, and overlap in a later frame that keeps it.
TEST_P(Lists, HaveBodyPairsThatMeetLater) {
    Scene scene;
    scene.meshes = {tetrahedra_at({{0, 0, 0}, {0.2, 0, 0}, {0.4, 0, 0}}, 0.2)};
    scene.bodies = {{.mesh = 0, .fixed = true}, {.mesh = 0}, {.mesh = 0}, {.mesh = 0}};
    scene.frame = [](std::size_t index) {
        Frame frame;
        frame.poses.resize(4);
        frame.deformed.resize(4);
        frame.poses[1].translation.x() = 0.6 + 0.0016 - 0.0003 * static_cast<double>(index);
        frame.poses[2].translation.y() = 2; // two bodies that always meet
        frame.poses[3].translation.y() = 2.01;
        return frame;
    };
    constexpr std::size_t first_meeting = 6;
    for (const std::string broad : {"device", "sphere", "tight"}) {
        SCOPED_TRACE(broad);
        const auto session = listed_on(scene, {{"broad", broad}});
        const auto always = reference(scene, scene.frame(0), {}, false, Method::brute_force).digest.count;
        for (std::size_t i = 0; i <= first_meeting; ++i) {
            const auto frame = scene.frame(i);
            const auto result = session->run(frame);
            EXPECT_EQ(result.digest(), reference(scene, frame, {}, false, Method::brute_force).digest);
            EXPECT_EQ(result.count > always, i == first_meeting);
            EXPECT_EQ(result.rebuilds, i < 2 ? 1u : 0u) << "frame " << i;
        }
    }
}

/// Given pairs replace those that a session finds, also while a list is valid.
TEST_P(Lists, HaveOnlyGivenBodyPairs) {
    const auto scene = slow_row();
    const auto session = listed_on(scene);
    const auto frame = scene.frame(run_until_kept(*session, scene));
    const auto whole = session->run(frame).download();
    for (const auto& given : std::vector<std::vector<BodyPair>>{{{2, 3}}, {{2, 3}, {4, 5}}, {{0, 6}}}) {
        auto right = whole;
        std::erase_if(right, [&](const Pair& pair) {
            return std::ranges::find(given, BodyPair{pair.body_a, pair.body_b}) == given.end();
        });
        for (int again = 0; again < 4; ++again) {
            const auto result = session->run(frame, given);
            EXPECT_EQ(result.download(), right);
            EXPECT_EQ(result.rebuilds, again < 2 ? 1u : 0u) << "given again, pairs have a list";
        }
    }
    EXPECT_EQ(session->run(frame).download(), whole);
    EXPECT_EQ(session->run(frame, {}).count, 0u);
    EXPECT_EQ(session->run(frame).download(), whole);
}

TEST_P(Lists, GrowFromTheSmallestCapacities) {
    const auto scene = slow_row();
    SettingTexts smallest;
    for (const auto* name :
         {"list_capacity", "tile_pair_capacity", "pair_capacity", "contact_capacity", "body_pair_capacity"})
        smallest[name] = "1";
    for (const std::string layout : {"slots", "items"}) {
        smallest["pair_layout"] = layout;
        const auto session = listed_on(scene, smallest);
        std::uint64_t retries = 0, kept = 0;
        for (std::size_t i = 0; i < 6; ++i) {
            const auto frame = scene.frame(i);
            const auto result = session->run(frame);
            const auto right = reference(scene, frame, {}, true, Method::brute_force);
            EXPECT_EQ(result.digest(), right.digest);
            EXPECT_EQ(result.contact_digest(), right.contact_digest);
            retries += i > 0 ? result.retries : 0;
            kept += result.rebuilds == 0 ? 1 : 0;
            EXPECT_EQ(result.rebuilds, i < 2 ? 1u : 0u) << "frame " << i;
        }
        EXPECT_GT(retries, 0u) << "the list grew";
        EXPECT_GT(kept, 0u);
    }
}

TEST_P(Lists, AreCountedAndSummed) {
    const auto scene = slow_row();
    for (const std::string output : {"pairs", "count", "digest"}) {
        SCOPED_TRACE(output);
        const auto session = listed_on(scene, {{"output", output}});
        session->count_work(true);
        std::map<std::string_view, std::uint64_t> work;
        for (std::size_t i = 0; i < 5; ++i) {
            const auto frame = scene.frame(i);
            const auto result = session->run(frame);
            const auto right = reference(scene, frame, {}, false, Method::brute_force);
            EXPECT_EQ(result.count, right.digest.count);
            if (output != "count") {
                EXPECT_EQ(result.digest(), right.digest);
            }
            for (const auto& [name, value] : result.work) work[name] += value;
        }
        EXPECT_EQ(work["direct_walks"], 1u);
        EXPECT_EQ(work["lists"], 1u);
        EXPECT_GT(work["certain_pairs"], 0u);
        EXPECT_GT(work["open_pairs"], 0u);
        EXPECT_GT(work["upper_tests"] + work["leaf_tile_pairs"], 0u);
    }
}

TEST_P(Lists, AnswerFramesInTheMemoryOfTheDevice) {
    const auto scene = slow_row();
    const auto session = listed_on(scene);
    std::uint64_t kept = 0;
    for (std::size_t i = 0; i < 8; ++i) {
        const Rows rows(scene.frame(i), i % 2 == 0);
        const auto result = session->run(rows.uploaded_to(on));
        EXPECT_EQ(result.digest(), reference(scene, rows.host, {}, false, Method::brute_force).digest);
        kept += result.rebuilds == 0 ? 1 : 0;
    }
    EXPECT_GE(kept, 5u);
}

/// The commands of a frame do not depend on whether its list is kept.
TEST_P(Lists, HaveOneSequenceOfCommands) {
    const auto scene = slow_row();
    const auto session = listed_on(scene, {{"contact_rule", "none"}});
    for (std::size_t i = 0; i < 3; ++i) session->run(scene.frame(i));
    on.set_clocks(Clocks::on);
    std::set<std::vector<std::string>> sequences;
    std::set<std::uint64_t> rebuilds;
    for (std::size_t i = 3; i < 24; ++i) {
        const auto result = session->run(scene.frame(i));
        ASSERT_EQ(result.retries, 0u);
        rebuilds.insert(result.rebuilds);
        std::vector<std::string> commands;
        std::uint64_t waits = 0;
        for (const auto& event : on.finish().events) {
            waits += event.blocked ? 1 : 0;
            commands.emplace_back(event.label);
        }
        EXPECT_EQ(waits, 1u);
        sequences.insert(commands);
    }
    on.set_clocks(Clocks::off);
    EXPECT_EQ(rebuilds, (std::set<std::uint64_t>{0, 1}));
    EXPECT_EQ(sequences.size(), 1u);
}

INSTANTIATE_TEST_SUITE_P(Devices, Lists, testing::ValuesIn(device_names()),
                         [](const auto& test) { return device_label(test.param); });

} // namespace
} // namespace tandem
