// SPDX-License-Identifier: MIT
// Sessions that find their body pairs on the device: every algorithm and preset with every broad phase
// against brute force, capacities of the body pair buffer, and the commands of a frame.
#include "tests/support/broad.h"

#include "algorithms/bounds/geometry.h"
#include "harness/verify/reference.h"
#include "base/error.h"

#include <fmt/format.h>

namespace tandem {
namespace {

using namespace support;

class BroadSessions : public testing::TestWithParam<std::string> {};

bool rejected(const Traversal& traversal, std::span<Device* const> devices, const Settings& settings) {
    try {
        traversal.check(devices, settings);
        return false;
    } catch (const InputError&) {
        return true;
    }
}

/// Every preset with every broad phase gives the reference's answer, or is rejected with a reason.
TEST_P(BroadSessions, EveryPresetWithEveryBroadPhase) {
    auto& on = device(GetParam());
    const auto scene = crowd(5, 12, 1.5);
    std::uint64_t cells = 0;
    for (const auto* traversal : algorithms()) {
        for (const auto& p : traversal->presets()) {
            for (const std::string broad : {"sphere", "tight", "device"}) {
                SettingTexts given{{"broad", broad}};
                if (p.texts().contains("groups")) given["queue_bytes"] = "1048576";
                const auto settings = resolve(traversal->parameters(), p.values, given, traversal->name());
                const std::array devices{&on};
                SCOPED_TRACE(fmt::format("{} {}{}", traversal->name(), p.name, text(given)));
                if (rejected(*traversal, devices, settings)) {
                    // Only presets whose launches start from host data are rejected, never an algorithm's
                    // first preset.
                    EXPECT_EQ(broad, "device");
                    EXPECT_NE(p.name, traversal->presets().front().name);
                    continue;
                }
                const auto session = traversal->prepare(devices, scene, settings);
                for (std::size_t i = 0; i < scene.frame_count; ++i) {
                    const auto frame = scene.frame(i);
                    const auto right =
                        reference(scene, frame, geometry_of(settings), true, Method::brute_force);
                    const auto result = session->run(frame);
                    ASSERT_GT(result.count, 0u);
                    EXPECT_EQ(result.digest(), right.digest);
                    EXPECT_EQ(result.contact_digest(), right.contact_digest);
                    EXPECT_GT(result.body_pairs, 0u);
                    EXPECT_LT(result.body_pairs, all_pairs(scene).size());
                }
                ++cells;
            }
        }
    }
    EXPECT_GE(cells, 20u);
}

/// A buffer that lacks one pair grows once; a buffer of exactly all pairs does not grow.
TEST_P(BroadSessions, ACapacityOfExactlyTheBodyPairsNeedsNoRetry) {
    auto& on = device(GetParam());
    const auto scene = crowd(8, 14, 1.5);
    const auto frame = scene.frame(0);
    const auto right = reference(scene, frame, {}, true, Method::brute_force);
    Search search(on, scene, {}, 32, 100);
    search.sort_by(0);
    search.go_to(0);
    const auto pairs = search.expected().size();
    for (const auto* traversal : algorithms()) {
        for (const std::uint64_t capacity : {std::uint64_t{1}, pairs - 1, pairs}) {
            const auto settings = resolve(
                traversal->parameters(), {},
                {{"broad", "device"}, {"body_pair_capacity", std::to_string(capacity)}}, traversal->name());
            const std::array devices{&on};
            const auto session = traversal->prepare(devices, scene, settings);
            const auto result = session->run(frame);
            EXPECT_EQ(result.body_pairs, pairs);
            EXPECT_EQ(result.retries, capacity < pairs ? 1u : 0u);
            EXPECT_EQ(result.digest(), right.digest);
            EXPECT_EQ(result.contact_digest(), right.contact_digest);
        }
    }
}

/// Explicit body pairs replace those of any broad phase, for that run only.
TEST_P(BroadSessions, ExplicitPairsReplaceTheBroadPhase) {
    auto& on = device(GetParam());
    const auto scene = crowd(8, 6, 0.5);
    const auto frame = scene.frame(0);
    const auto right = reference(scene, frame, {}, true, Method::brute_force);
    const BodyPair first{right.pairs.front().body_a, right.pairs.front().body_b};
    for (const auto* traversal : algorithms())
        for (const std::string broad : {"device", "tight"}) {
            const auto settings = resolve(traversal->parameters(), {}, {{"broad", broad}}, traversal->name());
            const std::array devices{&on};
            const auto session = traversal->prepare(devices, scene, settings);
            EXPECT_EQ(session->run(frame).digest(), right.digest);
            for (const auto& pair : session->run(frame, {&first, 1}).download())
                EXPECT_EQ((BodyPair{pair.body_a, pair.body_b}), first);
            EXPECT_EQ(session->run(frame, {}).count, 0u);
            EXPECT_EQ(session->run(frame, all_pairs(scene)).contact_digest(), right.contact_digest);
            EXPECT_EQ(session->run(frame).contact_digest(), right.contact_digest);
        }
}

/// The commands of a resident chunked frame: the same for frames with different answers, with one wait; the
/// trace lists the search under the broad stage.
TEST_P(BroadSessions, ResidentChunkedIsOneSequence) {
    auto& on = device(GetParam());
    const auto scene = gravel(10, 300, 5, 1000);
    const auto& traversal = algorithm("chunked");
    const auto settings = resolve(traversal.parameters(), {}, {{"broad", "device"}}, traversal.name());
    const std::array devices{&on};
    const auto session = traversal.prepare(devices, scene, settings);
    session->run(scene.frame(0)); // the first run sorts the bodies
    on.set_clocks(Clocks::on);
    std::vector<std::vector<std::string>> sequences;
    std::vector<std::uint64_t> found;
    for (const std::size_t frame : {0u, 1u}) {
        const auto result = session->run(scene.frame(frame));
        EXPECT_EQ(result.retries, 0u);
        found.push_back(result.body_pairs);
        std::uint64_t waits = 0, searches = 0;
        sequences.emplace_back();
        for (const auto& e : on.finish().events) {
            if (e.command == Command::host_work) continue;
            waits += e.blocked ? 1 : 0;
            searches += e.command == Command::launch && e.stage == Stage::broad ? 1 : 0;
            sequences.back().push_back(fmt::format("{} {} {}", e.label, e.groups, e.group_size));
        }
        EXPECT_EQ(waits, 1u);
        EXPECT_EQ(searches, 2u);
    }
    on.set_clocks(Clocks::off);
    EXPECT_NE(found[0], found[1]);
    EXPECT_EQ(sequences[0], sequences[1]);
}

INSTANTIATE_TEST_SUITE_P(Devices, BroadSessions, testing::ValuesIn(device_names()),
                         [](const auto& test) { return device_label(test.param); });

} // namespace
} // namespace tandem
