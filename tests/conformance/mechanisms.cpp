// SPDX-License-Identifier: MIT
// Mechanisms of single algorithms: each of them runs and has the intended effect.
#include "tests/support/on_device.h"
#include "tests/support/flawed.h"
#include "tests/support/long_form.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

class Mechanisms : public OnDevice {};

/// Eight queues, tiny local queues and a low idle limit force balancing, refills, spills and growth.
TEST_P(Mechanisms, GproximityIsForcedThroughEveryMechanism) {
    const auto scene = crowd(41, 12, 0.6);
    const auto frame = scene.frame(0);
    const auto expected = reference(scene, frame, {}, true, Method::brute_force);
    const auto& traversal = algorithm("gproximity");
    for (const std::string balance : {"parallel", "serial"}) {
        const auto session = prepare_on(on, traversal, scene,
                                        texts("groups=8 group_size=8 local_queue=4 initial_items=2 "
                                              "queue_capacity=16 idle_limit=8 balance_group_size=8 balance="
                                              + balance));
        const auto timed = run_among_all(*session, scene, frame);
        expect_same_digests(timed, expected);
        EXPECT_GT(timed.retries, 0u);
        session->count_work(true); // the counting build makes no contacts
        const auto result = run_among_all(*session, scene, frame);
        EXPECT_EQ(result.digest(), expected.digest);
        EXPECT_GT(result.work.at("balances"), 0u);
        EXPECT_GT(result.work.at("refills"), 0u);
        EXPECT_GT(result.work.at("spills"), 0u);
        fmt::print("{} balances, {} refills, {} spills, {} retries\n", result.work.at("balances"),
                   result.work.at("refills"), result.work.at("spills"), timed.retries);
    }
}

/// A seed target divided among the pairs of a frame gives the same seeds as the equivalent threshold per
/// pair.
TEST_P(Mechanisms, ChunkedDividesItsSeedTargetAmongPairs) {
    TANDEM_LONG_FORM_ONLY(GetParam());
    const auto scene = crowd(53, 10, 0.9);
    const auto& traversal = algorithm("chunked");
    const auto seeds = [&](const std::string& threshold, const std::string& target, std::uint64_t& pairs) {
        const auto session = prepare_on(
            on, traversal, scene, {{"leaves", "2"}, {"seed_threshold", threshold}, {"seed_target", target}});
        session->count_work(true);
        const auto body_pairs = all_pairs(scene);
        pairs = body_pairs.size();
        return session->run(scene.frame(0), body_pairs).work.at("seeds");
    };
    std::uint64_t pairs = 0;
    const auto coarse = seeds("1", "1", pairs);
    const auto middle = seeds("40", "1", pairs);
    const auto fine = seeds("1e7", "1", pairs);
    ASSERT_GT(pairs, 1u);
    ASSERT_NE(coarse, middle);
    ASSERT_NE(middle, fine);
    EXPECT_EQ(seeds("0", "1", pairs), coarse);
    EXPECT_EQ(seeds("0", std::to_string(40 * pairs), pairs), middle);
    EXPECT_EQ(seeds("0", "1e9", pairs), fine);
}

/// Boxes of 1296 tetrahedra next to boxes a tenth of their size. Descending both nodes at once tests many
/// small parts of the small box against large parts of the large one. Both schedules count the same tests.
TEST_P(Mechanisms, DescendingTheLargerOfUnlikeNodesNeedsFewerTests) {
    auto scene = boxes_scene(6, 4);
    scene.meshes.push_back(scene.meshes[0]);
    for (auto& vertex : scene.meshes.back().vertices) vertex *= 0.1;
    for (std::uint32_t body = 0; body < scene.bodies.size(); body += 2)
        scene.bodies[body].mesh = static_cast<std::uint32_t>(scene.meshes.size() - 1);
    const auto& traversal = algorithm("chunked");
    std::set<std::uint64_t> pairs;
    const auto tests = [&](const Traversal& walk, SettingTexts given) {
        given["contact_rule"] = "none";
        const auto session = prepare_on(on, walk, scene, given);
        session->count_work(true);
        const auto result = run_among_all(*session, scene, scene.frame(0));
        pairs.insert(result.digest().count);
        return result.work.at("bvtt_nodes");
    };
    std::map<std::string, std::uint64_t> by_descent;
    for (const std::string descent : {"both", "larger", "unlike"}) {
        by_descent[descent] = tests(traversal, {{"descent", descent}, {"schedule", "group"}});
        EXPECT_EQ(tests(traversal, {{"descent", descent}, {"schedule", "item"}}), by_descent[descent]);
    }
    EXPECT_LT(5 * by_descent["unlike"], 4 * by_descent["both"]);
    // Trees of one chunk, in which gProximity descends as the paper's biggest first does.
    EXPECT_EQ(tests(traversal, {{"descent", "larger"}, {"leaves", "2048"}, {"builder", "morton"}}),
              tests(algorithm("gproximity"), {{"builder", "morton"}}));
    EXPECT_GT(*pairs.begin(), 1000u);
    EXPECT_EQ(pairs.size(), 1u);
}

TEST_P(Mechanisms, ResidentChunkedWaitsOnce) {
    const auto scene = crowd(51, 10, 0.9);
    const auto& traversal = algorithm("chunked");
    for (const std::string threshold : {"1", "1e7"}) {
        const auto session =
            prepare_on(on, traversal, scene, {{"leaves", "4"}, {"seed_threshold", threshold}});
        for (std::size_t i = 0; i < scene.frame_count; ++i) {
            on.set_clocks(Clocks::on);
            const auto count = run_among_all(*session, scene, scene.frame(i)).count;
            const auto trace = on.finish();
            on.set_clocks(Clocks::off);
            ASSERT_GT(count, 0u);
            EXPECT_EQ(std::count_if(trace.events.begin(), trace.events.end(),
                                    [](const auto& e) { return e.blocked; }),
                      1);
        }
    }
}

TANDEM_ON_DEVICES(Mechanisms);

} // namespace
} // namespace tandem
