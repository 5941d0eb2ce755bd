// SPDX-License-Identifier: MIT
// Filters of a scene: groups of bodies, and pairs of bodies that never meet, in every broad phase.
#include "tests/support/limited.h"
#include "tests/support/long_form.h"
#include "tests/support/scenes.h"
#include "algorithms/bodies/nothing_meets.h"
#include "algorithms/bodies/self_pairs.h"
#include "harness/verify/reference.h"
#include "tests/support/message_of.h"
#include "tests/support/on_device.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

/// The scene with groups and lists by chance.
Scene filtered(Scene scene, std::uint64_t seed) {
    Random random(seed);
    const auto count = static_cast<std::uint32_t>(scene.bodies.size());
    for (auto& body : scene.bodies) {
        body.groups = 1u << random.next() % 3 | 1u << 31;
        body.meets = random.next() % 3 == 0 ? 5u : 0xffff'ffffu;
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto a = static_cast<std::uint32_t>(random.next() % count);
        const auto b = static_cast<std::uint32_t>(random.next() % count);
        scene.never_meet.push_back({std::min(a, b), std::max(a, b)});
    }
    std::ranges::sort(scene.never_meet);
    const auto repeated = std::ranges::unique(scene.never_meet);
    scene.never_meet.erase(repeated.begin(), repeated.end());
    scene.digest = digest_of(scene);
    return scene;
}

/// The definition, one condition a line.
bool meet(const Scene& scene, const Pair& pair) {
    const auto& a = scene.bodies[pair.body_a];
    const auto& b = scene.bodies[pair.body_b];
    for (const auto& [one, other] : scene.never_meet)
        if (one == pair.body_a && other == pair.body_b) return false;
    if (pair.body_a == pair.body_b) return true;
    if ((a.groups & b.meets) == 0) return false;
    return (b.groups & a.meets) != 0;
}

std::vector<Pair> kept(const Scene& scene, std::vector<Pair> pairs) {
    std::erase_if(pairs, [&](const Pair& pair) { return !meet(scene, pair); });
    return pairs;
}

class Filters : public OnDevice {};

/// More bodies than the device's broad phase has in a tile.
TEST_P(Filters, KeepBodiesApartInEveryBroadPhase) {
    TANDEM_LONG_FORM_ONLY(GetParam());
    const auto whole = crowd(61, 90, 2);
    const auto scene = filtered(whole, 3);
    for (const auto* traversal : algorithms())
        for (const std::string broad : {"device", "tight", "sphere"}) {
            // In short form, devices that compile take every broad phase with one algorithm only.
            if (!long_form() && GetParam() != "host" && broad != "device" && traversal->name() != "tiled")
                continue;
            const SettingTexts given{{"broad", broad}, {"self", "on"}, {"contact_rule", "none"}};
            SCOPED_TRACE(std::string(traversal->name()) + text(given));
            const auto all = prepare_on(on, *traversal, whole, given)->run(whole.frame(0)).download();
            const auto right = kept(scene, all);
            ASSERT_GT(right.size(), all.size() / 8);
            ASSERT_LT(right.size(), all.size() * 7 / 8);
            EXPECT_EQ(prepare_on(on, *traversal, scene, given)->run(scene.frame(0)).download(), right);
        }
}

/// Worlds of sizes about that of a tile of the broad phase, which are all in the same place, and fixed bodies
/// in each.
Scene in_worlds(std::uint32_t size, std::uint32_t count) {
    auto scene = crowd(71, size * count, 1.5);
    for (std::uint32_t body = 2; body < scene.bodies.size(); body += 5) scene.bodies[body].fixed = true;
    scene.world_size = size;
    return scene;
}

TEST_P(Filters, WorldsAreApartInEveryBroadPhase) {
    for (const auto& [size, count] :
         {std::pair(1u, 40u), {2u, 70u}, {5u, 13u}, {16u, 9u}, {31u, 3u}, {32u, 3u}, {33u, 4u}, {70u, 2u}}) {
        const auto scene = in_worlds(size, count);
        auto whole = scene;
        whole.world_size = 0;
        for (const std::string broad : {"device", "tight"}) {
            if (compiles_briefly() && broad == "tight") continue; // a broad phase of the host
            SCOPED_TRACE(fmt::format("{} worlds of {}, broad={}", count, size, broad));
            const SettingTexts given{{"broad", broad}, {"self", "deformable"}, {"contact_rule", "none"}};
            const auto& tiled = algorithm("tiled");
            auto right = prepare_on(device("host"), tiled, whole, given)->run(whole.frame(0)).download();
            std::erase_if(right, [&](const Pair& pair) { return pair.body_a / size != pair.body_b / size; });
            const auto session = prepare_on(on, tiled, scene, given);
            const auto result = session->run(scene.frame(0));
            EXPECT_EQ(result.download(), right);
            EXPECT_LE(result.body_pairs, most_body_pairs(scene, SelfPairs::deformable));
            if (size > 1) {
                EXPECT_GT(right.size(), 0u);
            }
            if (!long_form()) continue;
            EXPECT_EQ(prepare_on(on, algorithm("leaf_query"), scene,
                                 {{"tree", "scene"}, {"contact_rule", "none"}, {"self", "deformable"}})
                          ->run(scene.frame(0))
                          .download(),
                      right);
        }
    }
}

TEST(FilteredScenes, AWorldThatDoesNotDivideTheBodiesIsRefused) {
    auto scene = crowd(5, 6, 1.5);
    scene.world_size = 4;
    EXPECT_THAT(message_of([&] { prepare_on(device("host"), algorithm("tiled"), scene); }),
                testing::HasSubstr("world_size is 4, which does not divide 6 bodies"));
    scene.world_size = 1;
    EXPECT_NE(why_nothing_meets(scene, SelfPairs::off), "");
    EXPECT_EQ(why_nothing_meets(scene, SelfPairs::on), "");
    scene.world_size = 3;
    EXPECT_EQ(why_nothing_meets(scene, SelfPairs::off), "");
    scene.never_meet = {{0, 1}, {0, 2}, {1, 2}, {3, 4}, {3, 5}, {4, 5}};
    EXPECT_NE(why_nothing_meets(scene, SelfPairs::off), "");
    scene.never_meet.pop_back();
    EXPECT_EQ(why_nothing_meets(scene, SelfPairs::off), "");
}

/// Body pairs of the caller are all walked.
TEST_P(Filters, DoNotApplyToGivenPairs) {
    auto scene = crowd(62, 4, 0.5);
    const auto pairs = all_pairs(scene);
    const auto expected = prepare_on(on, algorithm("tiled"), scene)->run(scene.frame(0), pairs).digest();
    for (auto& body : scene.bodies) body.meets = 0;
    const auto session = prepare_on(on, algorithm("tiled"), scene);
    EXPECT_EQ(session->run(scene.frame(0), pairs).digest(), expected);
    EXPECT_EQ(session->run(scene.frame(0)).count, 0u);
}

TEST_P(Filters, HaveAReference) {
    const auto whole = crowd(63, 12, 0.9);
    const auto scene = filtered(whole, 5);
    const ContactSettings self{.self = SelfPairs::on};
    for (const auto method : {Method::brute_force, Method::sweep}) {
        const auto all = reference(whole, whole.frame(0), {}, false, method, self).pairs;
        const auto right = kept(scene, all);
        ASSERT_LT(right.size(), all.size());
        EXPECT_EQ(reference(scene, scene.frame(0), {}, false, method, self).pairs, right);
    }
}

TEST(FilteredParts, OfTwoDevicesAddUp) {
    for (const std::uint32_t world_size : {0u, 8u}) {
        auto scene = filtered(procession(40, 2, 0.1), 7);
        scene.world_size = world_size;
        const std::array both{&device("host"), &device("opencl:0")};
        for (const std::string broad : {"device", "tight"}) {
            SCOPED_TRACE(broad);
            const auto& tiled = algorithm("tiled");
            const auto settings = resolved(tiled, {{"broad", broad}, {"self", "on"}});
            const auto one = tiled.prepare(std::span(both).first(1), scene, settings);
            const auto two = tiled.prepare(both, scene, settings);
            for (const std::size_t i : {0u, 1u}) {
                const auto right = one->run(scene.frame(i));
                const auto result = two->run(scene.frame(i));
                ASSERT_GT(right.count, 0u);
                EXPECT_EQ(result.digest(), right.digest());
                EXPECT_EQ(result.body_pairs, right.body_pairs);
            }
        }
    }
}

TANDEM_ON_DEVICES(Filters);

} // namespace
} // namespace tandem
