// SPDX-License-Identifier: MIT
// Setting order=canonical: pairs and contacts in the order of their numbers, in the device's memory.
#include "tests/support/flawed.h"
#include "tests/support/limited.h"
#include "tests/support/long_form.h"
#include "tests/support/on_device.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

class CanonicalOrder : public OnDevice {};

std::vector<Pair> stored_pairs(const FrameResult& result) {
    std::vector<Pair> pairs;
    for (const auto& part : result.parts) part->append_pairs(pairs);
    return pairs;
}

std::vector<ContactPoint> stored_contacts(const FrameResult& result) {
    std::vector<ContactPoint> contacts;
    for (const auto& part : result.parts) part->append_contacts(contacts);
    return contacts;
}

/// The parts have the order of the sorted downloads, which do not depend on the device's order.
void expect_sorted(const FrameResult& result) {
    EXPECT_EQ(stored_pairs(result), result.download());
    const auto contacts = stored_contacts(result), sorted = result.download_contacts();
    ASSERT_EQ(contacts.size(), sorted.size());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        EXPECT_EQ(contacts[i].pair, sorted[i].pair) << i;
        EXPECT_EQ(contacts[i].feature, sorted[i].feature) << i;
        EXPECT_EQ(contacts[i].depth, sorted[i].depth) << i;
        EXPECT_EQ(contacts[i].point, sorted[i].point) << i;
    }
}

TEST_P(CanonicalOrder, IsThatOfTheNumbers) {
    const auto scene = crowd(81, 12, 0.8);
    const std::vector<SettingTexts> cases{
        {{"broad", "device"}},
        {{"self", "on"}, {"pair_layout", "items"}, {"contact_rule", "sat"}},
        {{"precision", "double"}, {"pair_capacity", "1"}, {"contact_capacity", "1"}},
        {{"output", "contacts"}, {"builder", "hilbert"}}};
    std::size_t number = 0;
    for (const auto* traversal : walks()) {
        ++number;
        for (std::size_t c = 0; c < cases.size(); ++c) {
            if (compiles_briefly() && c % 2 != number % 2) continue;
            const auto& given = cases[c];
            auto canonical = given;
            canonical["order"] = "canonical";
            SCOPED_TRACE(std::string(traversal->name()) + text(canonical));
            const auto any = prepare_on(on, *traversal, scene, given);
            const auto session = prepare_on(on, *traversal, scene, canonical);
            for (const std::size_t i : {0u, 1u, 0u}) {
                const auto result = session->run(scene.frame(i));
                ASSERT_GT(result.count, 100u);
                ASSERT_GT(result.contacts, 50u);
                expect_sorted(result);
                const auto right = any->run(scene.frame(i));
                expect_same_digests(result, right);
            }
        }
    }
}

/// Runs of hundreds of pairs: each tetrahedron of one body meets all of the other.
TEST_P(CanonicalOrder, OfLongRuns) {
    Random random(9);
    std::vector<Eigen::Vector3d> positions;
    for (int i = 0; i < 300; ++i)
        positions.emplace_back(random.uniform(), random.uniform(), random.uniform());
    Scene scene;
    scene.name = scene.key = "long runs";
    scene.meshes = {tetrahedra_at(positions, 0.01), tetrahedra_at({{-9, -9, -9}, {-8, -8, -8}}, 40)};
    scene.bodies = {{.mesh = 1}, {.mesh = 0}, {.mesh = 1}};
    scene.frame = [](std::size_t) { return Frame{.poses = std::vector<Pose>(3), .deformed = {{}, {}, {}}}; };
    scene.digest = digest_of(scene);
    const auto result =
        prepare_on(on, algorithm("tiled"), scene, {{"order", "canonical"}})->run(scene.frame(0));
    ASSERT_GE(result.count, 4u * 300);
    expect_sorted(result);
}

/// Twenty runs have equal bytes, also on another algorithm and device.
TEST_P(CanonicalOrder, GivesEqualBytes) {
    TANDEM_LONG_FORM_ONLY(GetParam());
    const auto scene = crowd(83, 10, 0.7);
    const SettingTexts given{{"order", "canonical"}, {"k", "18"}};
    const auto right = prepare_on(device("host"), algorithm("chunked"), scene, given)->run(scene.frame(0));
    for (const auto* traversal : algorithms()) {
        SCOPED_TRACE(traversal->name());
        const auto session = prepare_on(on, *traversal, scene, given);
        for (int i = 0; i < 20; ++i) {
            const auto result = session->run(scene.frame(0));
            ASSERT_EQ(stored_pairs(result), stored_pairs(right));
            const auto contacts = stored_contacts(result), expected = stored_contacts(right);
            ASSERT_EQ(contacts.size(), expected.size());
            for (std::size_t c = 0; c < contacts.size(); ++c)
                ASSERT_EQ(contacts[c].normal, expected[c].normal);
        }
    }
}

/// Without memory for the sort, the frame runs in batches, which the host merges.
TEST_P(CanonicalOrder, RunsInBatchesWithoutMemoryForTheSort) {
    const auto scene = boxes_scene(7, 2);
    const auto& tiled = algorithm("tiled");
    const SettingTexts given{{"order", "canonical"}};
    const auto right = prepare_on(on, tiled, scene)->run(scene.frame(0));
    const Limited limit(on, least_bytes(on, tiled, scene, given) + 40 * right.count);
    const auto session = prepare_on(on, tiled, scene, given);
    const auto result = session->run(scene.frame(0));
    EXPECT_GT(result.batches, 1u);
    expect_same_digests(result, right);
}

TANDEM_ON_DEVICES(CanonicalOrder);

} // namespace
} // namespace tandem
