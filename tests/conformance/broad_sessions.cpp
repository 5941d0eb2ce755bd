// SPDX-License-Identifier: MIT
// Sessions that find their body pairs on the device: every algorithm and preset with every broad phase
// against brute force, capacities of the body pair buffer, and the commands of a frame.
#include "tests/support/broad.h"
#include "tests/support/long_form.h"

#include "algorithms/bounds/geometry.h"
#include "harness/verify/reference.h"
#include "base/error.h"
#include "tests/support/on_device.h"

#include <fmt/format.h>

namespace tandem {
namespace {

using namespace support;

class BroadSessions : public OnDevice {};

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
    TANDEM_LONG_FORM_ONLY(GetParam());
    const auto scene = crowd(5, 12, 1.5);
    std::uint64_t cells = 0;
    for (const auto* traversal : algorithms()) {
        for (const auto& p : traversal->presets()) {
            // Presets of one algorithm for several GPUs differ in sizes only.
            if (!long_form() && p.name.starts_with("published-")) continue;
            for (const std::string broad : {"sphere", "sphere_boxes", "tight", "device"}) {
                SettingTexts given{{"broad", broad}};
                if (declares(*traversal, "queue_capacity")) given["queue_capacity"] = "4096";
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
                    const auto right = reference(scene, frame, geometry_of(settings), true,
                                                 Method::brute_force, contact_settings_of(settings));
                    const auto result = session->run(frame);
                    ASSERT_GT(result.count, 0u);
                    expect_same_digests(result, right);
                    EXPECT_GT(result.body_pairs, 0u);
                    EXPECT_LT(result.body_pairs, all_pairs(scene).size());
                }
                ++cells;
            }
        }
    }
    EXPECT_GE(cells, 20u);
}

/// Bodies of one tetrahedron, moved along the x axis. Its widths along the directions of k = 8 are 4, the
/// diameter of its sphere is 3.46: bodies 3.7 apart have overlapping k-DOPs, and boxes of spheres that do
/// not.
Scene tetrahedra_on_a_line(std::initializer_list<double> positions) {
    Mesh mesh;
    mesh.vertices = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    mesh.tetrahedra = {{0, 1, 2, 3}};
    complete_mesh(mesh, "one");
    mesh.name = "one";
    std::vector<Eigen::Vector3d> frame;
    for (const double x : positions) frame.emplace_back(x, 0, 0);
    return still_scene(std::move(mesh), {frame});
}

/// At k = 8 no direction is a coordinate axis, so that root k-DOPs overlap where boxes of spheres do not. The
/// pairs of such bodies are left out and counted, and none of them meets.
TEST_P(BroadSessions, BoxesOfSpheresLeaveOutOnlyPairsThatDoNotMeet) {
    const auto scene = tetrahedra_on_a_line({0, 3.7, 1});
    const auto settings_of_broad = [](const std::string& broad) {
        return resolved(algorithm("chunked"), {{"k", "8"}, {"broad", broad}});
    };
    const auto boxes = settings_of_broad("sphere_boxes"), spheres = settings_of_broad("sphere");
    const auto geometry = geometry_of(boxes);
    const auto within = contact_settings_of(boxes);
    const auto frame = scene.frame(0);
    const auto kept = reference(scene, frame, geometry, true, Method::sweep, within);
    const auto all = reference(scene, frame, geometry, true, Method::sweep);
    EXPECT_EQ(kept.dropped_body_pairs, 1u);
    EXPECT_EQ(kept.dropped_pairs, 1u);
    EXPECT_EQ(kept.pairs.size(), 2u);
    EXPECT_EQ(all.pairs.size(), 3u);
    EXPECT_GT(all.contacts, 0u);
    EXPECT_EQ(kept.contact_digest, all.contact_digest); // exact contacts of the same pairs
    EXPECT_EQ((reference(scene, frame, geometry, false, Method::brute_force, within).digest), kept.digest);
    const auto result = prepare_on(on, algorithm("chunked"), scene, boxes)->run(frame);
    const auto more = prepare_on(on, algorithm("chunked"), scene, spheres)->run(frame);
    EXPECT_EQ(result.digest(), kept.digest);
    EXPECT_EQ(more.digest(), all.digest);
    EXPECT_LT(result.body_pairs, more.body_pairs);
    // A walk that needs no body pairs asks for them where the broad phase leaves out some.
    const SettingTexts whole{{"k", "8"}, {"broad", "sphere_boxes"}, {"tree", "scene"}};
    const auto& leaf_query = algorithm("leaf_query");
    const auto asked = resolved(leaf_query, whole);
    EXPECT_EQ(prepare_on(on, leaf_query, scene, asked)->run(frame).digest(), kept.digest);
}

/// Parts of a frame's body pairs have together the frame's pairs, and each the reference's.
TEST_P(BroadSessions, PartsOfAFrameAddUp) {
    const auto scene = crowd(5, 12, 1.5);
    const std::array devices{&on};
    const auto frame = scene.frame(0);
    const auto answer = [&](const SettingTexts& part) {
        SettingTexts given{{"broad", "sphere_boxes"}, {"residency", "published"}};
        given.insert(part.begin(), part.end());
        const auto settings = resolved(algorithm("chunked"), given);
        const auto expected = reference(scene, frame, geometry_of(settings), true, Method::brute_force,
                                        contact_settings_of(settings));
        auto result = algorithm("chunked").prepare(devices, scene, settings)->run(frame);
        expect_same_digests(result, expected);
        return std::pair{result.body_pairs, expected.digest};
    };
    const auto [pairs, whole] = answer({});
    ASSERT_GT(pairs, 7u);
    const auto first = answer({{"most_body_pairs", "3"}}), rest = answer({{"first_body_pair", "3"}});
    const auto middle = answer({{"first_body_pair", "3"}, {"most_body_pairs", "4"}});
    EXPECT_EQ(first.first, 3u);
    EXPECT_EQ(middle.first, 4u);
    EXPECT_EQ(first.first + rest.first, pairs);
    auto sum = first.second;
    sum += rest.second;
    EXPECT_EQ(sum, whole);
    EXPECT_LT(middle.second.count, rest.second.count);
    EXPECT_EQ(answer({{"first_body_pair", "1000000"}}).first, 0u);
    const auto wrong = resolved(algorithm("chunked"), {{"most_body_pairs", "3"}});
    EXPECT_TRUE(rejected(algorithm("chunked"), devices, wrong));
}

/// A buffer that lacks one pair grows once; a buffer of exactly all pairs does not grow.
TEST_P(BroadSessions, ACapacityOfExactlyTheBodyPairsNeedsNoRetry) {
    const auto scene = crowd(8, 14, 1.5);
    const auto frame = scene.frame(0);
    const auto right = reference(scene, frame, {}, true, Method::brute_force);
    Search search(on, scene, {}, 32, 100);
    search.sort_by(0);
    search.go_to(0);
    const auto pairs = search.expected().size();
    for (const auto* traversal : walks()) {
        for (const std::uint64_t capacity : {std::uint64_t{1}, pairs - 1, pairs}) {
            const auto session =
                prepare_on(on, *traversal, scene,
                           {{"broad", "device"}, {"body_pair_capacity", std::to_string(capacity)}});
            const auto result = session->run(frame);
            EXPECT_EQ(result.body_pairs, pairs);
            EXPECT_EQ(result.retries, capacity < pairs ? 1u : 0u);
            expect_same_digests(result, right);
        }
    }
}

/// Explicit body pairs replace those of any broad phase, for that run only.
TEST_P(BroadSessions, ExplicitPairsReplaceTheBroadPhase) {
    const auto scene = crowd(8, 6, 0.5);
    const auto frame = scene.frame(0);
    const auto right = reference(scene, frame, {}, true, Method::brute_force);
    const BodyPair first{right.pairs.front().body_a, right.pairs.front().body_b};
    for (const auto* traversal : walks())
        for (const std::string broad : {"device", "tight"}) {
            const auto session = prepare_on(on, *traversal, scene, {{"broad", broad}});
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
    const auto scene = gravel(10, 300, 5, 1000);
    const auto& traversal = algorithm("chunked");
    const auto session = prepare_on(on, traversal, scene, {{"broad", "device"}});
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

TANDEM_ON_DEVICES(BroadSessions);

} // namespace
} // namespace tandem
