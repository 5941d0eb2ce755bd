// SPDX-License-Identifier: MIT
// Filters of a scene: groups of bodies, and pairs of bodies that never meet, in every broad phase.
#include "tests/support/limited.h"
#include "tests/support/long_form.h"
#include "tests/support/scenes.h"
#include "harness/verify/reference.h"
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
    const auto scene = filtered(procession(40, 2, 0.1), 7);
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

TANDEM_ON_DEVICES(Filters);

} // namespace
} // namespace tandem
