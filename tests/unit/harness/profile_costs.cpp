// SPDX-License-Identifier: MIT
// Costs that kernels declare, in bytes and operations: every kernel has them, and some are computed by hand.
#include "algorithms/bodies/cost.h"
#include "algorithms/kernels/sources.h"
#include "harness/sampling/replays.h"
#include "tests/support/cells.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

/// Settings that, besides presets, reach every kernel: decisions, a balance by one group, and other trees.
const std::vector<SettingTexts> variants{{},
                                         {{"decision", "recheck"}},
                                         {{"decision", "fp64"}},
                                         {{"decision", "exact"}},
                                         {{"balance", "serial"}},
                                         {{"schedule", "item"}},
                                         {{"tree", "scene"}}};

/// A crowd whose second frame skips a tetrahedron.
Scene skipping_crowd() {
    auto scene = crowd(7, 5, 1.0);
    scene.frame = [whole = scene.frame, bodies = scene.bodies.size()](std::size_t i) {
        auto frame = whole(i);
        if (i == 0) return frame;
        frame.skipped.resize(bodies);
        frame.skipped[2] = {0};
        return frame;
    };
    return scene;
}

/// Calls `visit` with the costs and the launched kernels of every algorithm, preset and variant on the host.
template<class Visit>
void for_cells(const Visit& visit) {
    const auto scene = skipping_crowd();
    const FrameRange range(scene, 0, 1);
    for (const auto* traversal : algorithms())
        for (const auto& preset : traversal->presets())
            for (auto given : variants) {
                if (std::ranges::any_of(given, [&](auto& s) { return !declares(*traversal, s.first); }))
                    continue;
                given.insert({{"pair_capacity", "4096"}, {"contact_capacity", "4096"}});
                if (declares(*traversal, "queue_capacity")) given.insert({"queue_capacity", "4096"});
                const auto cell = make_cell(*traversal, preset, given, {&device("host")});
                Replays replays(cell, scene, range);
                replays.instrumented();
                visit(describe(cell), traversal->costs(scene, replays.settings()),
                      replays.instrumented().kernels);
            }
}

TEST(ProfileCosts, EveryKernelOfAFrameHasAFloorOrAReason) {
    std::set<std::string> launched;
    for_cells([&](const std::string& cell, const std::vector<KernelCost>& costs, const auto& kernels) {
        for (const auto& [entry, sample] : kernels) {
            launched.insert(entry);
            const auto same = std::ranges::count(costs, std::string_view(entry), &KernelCost::entry);
            EXPECT_EQ(same, 1) << cell << ": " << entry << " has no entry, or several, in costs()";
        }
        for (const auto& cost : costs) EXPECT_FALSE(cost.how.empty()) << cost.entry;
    });
    // The loops above must reach these kernels, or the test checks too little.
    for (const auto* entry :
         {"refit_strips", "refit_tops", "empty_nodes", "find_body_pairs", "traverse", "traverse_in_groups",
          "traverse_queues", "move_balance_serially", "walk_leaf_tiles", "scatter_digits", "query_scene",
          "certify_pairs", "recheck_pairs", "transform_vertices"})
        EXPECT_TRUE(launched.contains(entry)) << entry;
}

/// A device other than the host packs the poses of many bodies.
TEST(ProfileCosts, ThePosesOfManyBodiesHaveAFloor) {
    const auto scene = procession(300, 1, 0);
    const auto& traversal = algorithm("tiled");
    const auto cell =
        make_cell(traversal, traversal.presets().front(), {{"contact_rule", "none"}}, {&device("opencl:0")});
    const FrameRange range(scene, 0, 0);
    Replays replays(cell, scene, range);
    const auto kernels = replays.instrumented().kernels;
    const auto costs = traversal.costs(scene, replays.settings());
    EXPECT_TRUE(kernels.contains("pack_unit_poses"));
    for (const auto& [entry, sample] : kernels)
        EXPECT_EQ(std::ranges::count(costs, std::string_view(entry), &KernelCost::entry), 1) << entry;
}

TEST(ProfileCosts, EveryDeclaredKernelExists) {
    std::string texts;
    for (const auto& source : kernel_sources()) texts += source.text;
    texts += kernel_source("tests/algorithms/lbvh.cl").text;
    const auto scene = crowd(7, 5, 1.0);
    for (const auto* traversal : algorithms())
        for (const auto& cost : traversal->costs(
                 scene, make_cell(*traversal, traversal->presets().front(), {}, {&device("host")}).settings))
            EXPECT_NE(texts.find("KERNEL void " + std::string(cost.entry) + "("), texts.npos) << cost.entry;
}

/// Two bodies that share a mesh of 40 separate tetrahedra; the second is fixed if `fixed`.
Scene two_bodies(bool fixed) {
    std::vector<Eigen::Vector3d> positions;
    for (int i = 0; i < 40; ++i) positions.emplace_back(2.0 * i, 0, 0);
    Scene scene;
    scene.meshes = {tetrahedra_at(positions)};
    scene.bodies = {{.mesh = 0}, {.mesh = 0, .fixed = fixed}};
    return scene;
}

Settings settings_of(const Traversal& traversal, const SettingTexts& given) {
    return make_cell(traversal, traversal.presets().front(), given, {&device("host")}).settings;
}

KernelCost cost_of(std::string_view name, std::string_view entry, const Scene& scene,
                   const SettingTexts& given) {
    const auto& traversal = algorithm(name);
    const auto costs = traversal.costs(scene, settings_of(traversal, given));
    return *std::ranges::find(costs, entry, &KernelCost::entry);
}

TEST(ProfileCosts, RefitOfChunks) {
    // Chunks of 16: 16 + 16 + 8 tetrahedra have 31 + 31 + 15 nodes. With k = 8, a node has 8 reals of 4
    // bytes.
    const SettingTexts given{{"k", "8"}, {"leaves", "16"}};
    const auto inputs = 40 * 16 + 160 * 16; // shared by both bodies
    const auto both = cost_of("chunked", "refit_strips", two_bodies(false), given);
    EXPECT_EQ(both.bytes({}), inputs + 2 * 48 + 2 * 77 * 32);
    EXPECT_EQ(both.operations({}), 2 * (4 * 40 + 37) * 8);
    const auto one = cost_of("chunked", "refit_strips", two_bodies(true), given);
    EXPECT_EQ(one.bytes({}), inputs + 48 + 77 * 32);
    EXPECT_EQ(cost_of("chunked", "refit_tops", two_bodies(false), given).bytes({}), (2 * 3 + 2) * 32);
}

TEST(ProfileCosts, RefitOfTilesWithThreeSlabs) {
    // 40 tetrahedra: tiles of 32 and of 8; leaves have 6 ends, roots 18.
    const auto cost =
        cost_of("tiled", "refit_leaf_tiles", two_bodies(true), {{"k", "18"}, {"slabs", "three"}});
    EXPECT_EQ(cost.bytes({}), 40 * 4 + 160 * 16 + 48 + 40 * 24 + 2 * 72);
    EXPECT_EQ(cost.operations({}), 4 * 6 * 40 + 38 * 18);
}

TEST(ProfileCosts, RefitOfTouchedTiles) {
    FrameFacts facts;
    facts.touched = 10;
    const SettingTexts touched{{"k", "18"}, {"slabs", "touched"}};
    const auto refit = cost_of("tiled", "refit_leaf_tiles", two_bodies(true), touched);
    EXPECT_EQ(refit.bytes(facts), 40 * 4 + 160 * 16 + 48 + 2 * 72);
    EXPECT_EQ(refit.operations(facts), 38 * 18);
    const auto bounds = cost_of("tiled", "bound_touched_tiles", two_bodies(true), touched);
    EXPECT_EQ(bounds.bytes(facts), 10 * 72);
    EXPECT_EQ(bounds.operations(facts), 4 * 18 * 10);
}

TEST(ProfileCosts, Walks) {
    FrameFacts facts;
    facts.candidate_pairs = 100;
    facts.touched = 10;
    facts.work = {{"bvtt_nodes", 1000}, {"upper_tests", 200}, {"leaf_tile_pairs", 3}};
    const auto chunked = cost_of("chunked", "traverse_in_groups", two_bodies(false), {{"k", "18"}});
    EXPECT_EQ(chunked.bytes(facts), 10 * 72 + 100 * 8);
    EXPECT_EQ(chunked.operations(facts), 18000);
    const auto counting =
        cost_of("chunked", "traverse_in_groups", two_bodies(false), {{"k", "18"}, {"output", "count"}});
    EXPECT_EQ(counting.bytes(facts), 10 * 72);
    const SettingTexts three{{"k", "18"}, {"slabs", "three"}};
    const auto leaves = cost_of("tiled", "walk_leaf_tiles", two_bodies(false), three);
    EXPECT_EQ(leaves.bytes(facts), 3 * 8 + 10 * 24 + 100 * 8);
    EXPECT_EQ(leaves.operations(facts), 6 * 800 + 12 * 100);
    EXPECT_EQ(cost_of("tiled", "walk_upper_tiles", two_bodies(false), three).operations(facts), 18 * 200);
}

TEST(ProfileCosts, TetrahedraOfCandidatePairs) {
    const auto scene = two_bodies(false);
    const auto settings = settings_of(algorithm("chunked"), {});
    const std::vector<Pair> pairs{{0, 1, 1, 1}, {0, 1, 1, 2}, {0, 3, 1, 1}};
    FrameFacts facts;
    add_touched(facts, scene, settings, pairs);
    EXPECT_EQ(facts.touched, 4);      // tetrahedra 1 and 3 of body 0, and 1 and 2 of body 1
    EXPECT_EQ(facts.touched_rows, 3); // rows of the mesh
    EXPECT_EQ(facts.touched_vertices, 12);
    FrameFacts apart;
    add_touched(apart, scene,
                settings_of(algorithm("chunked"), {{"residency", "published"}, {"broad", "sphere"}}), pairs);
    EXPECT_EQ(apart.touched_rows, 4);
    EXPECT_EQ(apart.touched_vertices, 16);
}

/// Boxes tested above tetrahedra are a subset of all, and tiles of tetrahedra need at least 32 tests.
TEST(ProfileCosts, TiledCountsItsTilesSeparately) {
    const auto scene = make_scene("plates");
    const FrameRange range(scene, 60, 60);
    const auto& tiled = algorithm("tiled");
    const auto cell = make_cell(tiled, tiled.presets().front(), {}, {&device("host")});
    Replays replays(cell, scene, range);
    auto work = replays.counted();
    EXPECT_GT(work["upper_tests"], 0u);
    EXPECT_GT(work["leaf_tile_pairs"], 0u);
    EXPECT_GE(work["bvtt_nodes"], work["upper_tests"] + 32 * work["leaf_tile_pairs"]);
    EXPECT_EQ(work["upper_tests"] % 32, 0u);
}

} // namespace
} // namespace tandem
