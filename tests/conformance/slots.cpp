// SPDX-License-Identifier: MIT
// Candidate pairs of 8 and of 16 bytes: slots map to their tetrahedra, and both layouts give the same pairs.
#include "algorithms/bodies/bodies.h"
#include "tests/support/on_device.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

class Slots : public OnDevice {
protected:
    template<class T>
    std::vector<T> contents(const Buffer& buffer, std::size_t count) {
        std::vector<T> values(count);
        const StageScope scope(on, Stage::read);
        on.download(buffer, std::as_writable_bytes(std::span(values)));
        return values;
    }
};

/// Bodies of 1, 32, 33 and more tetrahedra, some of them fixed, two with the same mesh.
Scene uneven() {
    Random random(5);
    Scene scene;
    for (const std::size_t count : {1, 32, 33, 70}) {
        std::vector<Eigen::Vector3d> positions;
        for (std::size_t i = 0; i < count; ++i)
            positions.push_back({random.uniform(), random.uniform(), random.uniform()});
        scene.meshes.push_back(tetrahedra_at(positions));
    }
    for (const std::uint32_t mesh : {2u, 0u, 1u, 3u, 2u, 0u})
        scene.bodies.push_back({mesh, scene.bodies.size() % 2 == 0, false});
    return scene;
}

TEST_P(Slots, NumberEveryTetrahedronOnce) {
    const auto scene = uneven();
    const Bodies bodies(on, scene, {}, Bodies::Sharing::by_mesh);
    ASSERT_EQ(bodies.pair_layout(), PairLayout::slots);
    const auto rows =
        contents<Bodies::BodyRow>(bodies.owners(), bodies.owners().bytes() / sizeof(Bodies::BodyRow));
    std::set<std::uint32_t> seen;
    for (std::uint32_t body = 0; body < bodies.count(); ++body) {
        const auto& own = bodies.row(body);
        EXPECT_EQ(bodies.first_slot(body) % Bodies::block_slots, 0u);
        for (std::uint32_t item = 0; item < own.tetrahedron_count; ++item) {
            const auto slot = bodies.first_slot(body) + item;
            EXPECT_TRUE(seen.insert(slot).second);
            EXPECT_EQ(bodies.slot_owner(slot).body, body);
            EXPECT_EQ(bodies.slot_owner(slot).item, item);
            const auto& block = rows.at(slot / Bodies::block_slots);
            EXPECT_EQ(block.tetrahedron_count, body); // stored in that field (rows.clh)
            EXPECT_EQ(block.tetrahedra + slot % Bodies::block_slots, own.tetrahedra + item);
            EXPECT_EQ(block.vertices, own.vertices);
        }
        for (std::uint32_t other = 0; other < bodies.count(); ++other) { // moving bodies come first
            if (scene.bodies[body].fixed || !scene.bodies[other].fixed) continue;
            EXPECT_LT(bodies.first_slot(body), bodies.first_slot(other));
        }
    }
}

TEST_P(Slots, FallBackToItemsAboveTheirLimit) {
    auto scene = uneven();
    Random random(6);
    std::vector<Eigen::Vector3d> positions;
    for (std::size_t i = 0; i < 100'000; ++i)
        positions.push_back({random.uniform(), random.uniform(), random.uniform()});
    scene.meshes = {tetrahedra_at(positions)};
    constexpr std::size_t blocks_of_body = 3125, most_blocks = std::size_t{1} << 27;
    scene.bodies.assign(most_blocks / blocks_of_body, {});
    scene.bodies.push_back({}); // one more than fits
    const Bodies bodies(on, scene, {}, Bodies::Sharing::by_mesh);
    EXPECT_EQ(bodies.pair_layout(), PairLayout::items);
    EXPECT_EQ(bodies.owners().bytes(), bodies.row_table().bytes());
    EXPECT_EQ(bodies.row(bodies.count() - 1).flags, 0u);
}

/// Rows of every algorithm in both layouts, expanded on the device, completely and in part.
TEST_P(Slots, ExpandToTheSamePairs) {
    const auto scene = crowd(53, 6, 0.8);
    const auto right = reference(scene, scene.frame(0), {}, true, Method::brute_force);
    for (const auto* traversal : algorithms())
        for (const std::string layout : {"slots", "items"}) {
            SCOPED_TRACE(std::string(traversal->name()) + " " + layout);
            const auto session = prepare_on(on, *traversal, scene, {{"pair_layout", layout}});
            EXPECT_EQ(session->settings().text("pair_layout"), layout);
            const auto result = session->run(scene.frame(0));
            ASSERT_EQ(result.parts.size(), 1u);
            const auto& part = *result.parts.front();
            const auto pairs = part.pairs();
            EXPECT_EQ(pairs.rows.bytes() / pairs.capacity, layout == "slots" ? 8u : 16u);
            EXPECT_EQ(pairs.layout, layout == "slots" ? PairLayout::slots : PairLayout::items);
            ASSERT_EQ(pairs.count, right.pairs.size());
            const auto half = pairs.count / 2;
            const auto expanded = on.allocate(pairs.count * sizeof(Pair), "expanded pairs");
            part.expand(0, pairs.count, expanded);
            const auto all = contents<Pair>(expanded, pairs.count);
            part.expand(half, pairs.count - half, expanded);
            const auto rest = contents<Pair>(expanded, pairs.count - half);
            EXPECT_TRUE(
                std::equal(rest.begin(), rest.end(), all.begin() + static_cast<std::ptrdiff_t>(half)));
            auto sorted = all;
            std::sort(sorted.begin(), sorted.end());
            EXPECT_EQ(sorted, right.pairs);
            EXPECT_EQ(result.download(), right.pairs);
            EXPECT_EQ(result.contact_digest(), right.contact_digest);
        }
}

/// The published data path uses the release's rows whatever layout is requested.
TEST_P(Slots, AreUnusedOnThePublishedPath) {
    const auto scene = crowd(53, 3, 0.8);
    const auto& chunked = algorithm("chunked");
    const auto session = prepare_on(on, chunked, scene, {{"residency", "published"}});
    EXPECT_EQ(session->settings().text("pair_layout"), "items");
    const auto result = session->run(scene.frame(0));
    EXPECT_EQ(result.parts.front()->pairs().layout, PairLayout::items);
}

TANDEM_ON_DEVICES(Slots);

} // namespace
} // namespace tandem
