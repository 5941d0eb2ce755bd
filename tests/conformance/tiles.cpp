// SPDX-License-Identifier: MIT
// Trees of tiles: the bounds equal those of the chunk trees, bit for bit, on every device and for every
// level. Skipped tetrahedra are in no bound.
#include "algorithms/orders/heap.h"
#include "algorithms/hierarchy/tile_trees.h"
#include "tests/support/cells.h"
#include "tests/support/flawed.h"
#include "tests/support/long_form.h"
#include "tests/support/prepared_trees.h"
#include "tests/support/sanitized.h"
#include "tests/support/scenes.h"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace tandem {
namespace {

using namespace support;

/// Boxes in order of their items, each with its lower ends, then its upper ends.
using Boxes = std::vector<std::vector<float>>;

/// The unions of 32 boxes each.
Boxes merged_by_tile(const Boxes& boxes) {
    Boxes merged;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (i % 32 == 0) merged.push_back(boxes[i]);
        auto& all = merged.back();
        for (std::size_t word = 0; word < all.size(); ++word)
            all[word] = word < all.size() / 2 ? std::min(all[word], boxes[i][word])
                                              : std::max(all[word], boxes[i][word]);
    }
    return merged;
}

/// The bounds of tile trees, downloaded. Boxes of level 0 have the first `directions` of k / 2 directions.
struct TileBounds {
    const TileTrees& tiles;
    std::size_t k, directions;
    std::vector<float> leaves, uppers, roots;

    bool has(std::uint32_t level, std::size_t word) const { return level > 0 || word % (k / 2) < directions; }
    float word_of(std::uint32_t body, std::uint32_t level, std::uint32_t box, std::size_t word) const {
        const auto tile = tiles.first_tile(body, level) + box / 32;
        const auto lane = box % 32;
        if (level > 0) return uppers[((tile - tiles.first_upper()) * k + word) * 32 + lane];
        const auto own = word < k / 2 ? word : directions + word % (k / 2);
        return leaves[(tile * 2 * directions + own) * 32 + lane];
    }
    void expect_boxes(std::uint32_t body, std::uint32_t level, const Boxes& expected) const {
        for (std::uint32_t box = 0; box < expected.size(); ++box)
            for (std::size_t word = 0; word < k; ++word) {
                if (!has(level, word)) continue;
                ASSERT_EQ(word_of(body, level, box, word), expected[box][word])
                    << "body " << body << " level " << level << " box " << box;
            }
    }
    /// Compares the roots of the tiles of a level.
    void expect_roots(std::uint32_t body, std::uint32_t level, const Boxes& expected) const {
        for (std::uint32_t tile = 0; tile < expected.size(); ++tile)
            for (std::size_t word = 0; word < k; ++word)
                ASSERT_EQ(roots[(tiles.first_tile(body, level) + tile) * k + word], expected[tile][word]);
    }
};

class Tiles : public testing::TestWithParam<std::string> {
protected:
    Device& on = device(GetParam());
    std::uint32_t group_size = on.info().max_group_size == 1 ? 1 : 64;

    std::vector<float> words_of(const Buffer& buffer) {
        std::vector<float> words(buffer.bytes() / 4);
        const StageScope scope(on, Stage::read);
        on.download(buffer, std::as_writable_bytes(std::span(words)));
        return words;
    }

    /// Compares leaves, every root and every box above with the leaves of chunk trees over the same bodies.
    /// The refit runs in units of 32 leaf tiles, and in units for a device that could run more units at once
    /// than there are.
    void expect_the_same_bounds(const Scene& scene, const Frame& frame, const Geometry& geometry,
                                Slabs slabs) {
        for (const std::uint32_t units_at_once : {0u, 100000u})
            expect_the_same_bounds(scene, frame, geometry, slabs, units_at_once);
    }
    void expect_the_same_bounds(const Scene& scene, const Frame& frame, const Geometry& geometry, Slabs slabs,
                                std::uint32_t units_at_once) {
        SCOPED_TRACE(units_at_once);
        PreparedTrees chunks(on, scene, geometry, 4096, group_size, Bodies::Sharing::by_mesh);
        chunks.update(frame);
        Bodies bodies(on, scene, geometry, Bodies::Sharing::by_mesh);
        TileTrees tiles(bodies, slabs, SelfPairs::off, group_size, 1, units_at_once);
        bodies.update(frame);
        tiles.refit(frame);
        const auto k = static_cast<std::size_t>(geometry.k);
        const auto nodes = chunks.nodes<float>();
        const auto directions = slabs == Slabs::three ? std::min<std::size_t>(3, k / 2) : k / 2;
        const TileBounds found{tiles,
                               k,
                               directions,
                               words_of(tiles.leaves()),
                               words_of(tiles.uppers()),
                               words_of(tiles.roots())};
        EXPECT_EQ(words_of(tiles.volumes()), chunks.volumes<float>());
        for (std::uint32_t body = 0; body < bodies.count(); ++body) {
            Boxes boxes; // of one level
            for (std::uint32_t item = 0; item < bodies.row(body).tetrahedron_count; ++item)
                boxes.push_back(chunk_leaf(chunks, nodes, body, item, k));
            for (std::uint32_t level = 0; level < tiles.levels_of(body); ++level) {
                ASSERT_NO_FATAL_FAILURE(found.expect_boxes(body, level, boxes));
                boxes = merged_by_tile(boxes);
                ASSERT_NO_FATAL_FAILURE(found.expect_roots(body, level, boxes));
            }
            EXPECT_EQ(boxes.size(), 1u);
        }
    }

    static std::vector<float> chunk_leaf(const PreparedTrees& trees, const std::vector<float>& nodes,
                                         std::uint32_t body, std::uint32_t item, std::size_t k) {
        const auto& level = trees.trees.levels(body)[0];
        const auto first = item / trees.trees.leaves() * trees.trees.leaves();
        const auto items = std::min(trees.trees.leaves(), level.items - first);
        const auto slot =
            trees.trees.first_slot(body) + level.slot + 2 * first + heap::leaf_node(item - first, items);
        const auto* values = &nodes[slot * k];
        return {values, values + k};
    }
};

TEST_P(Tiles, HaveTheBoundsOfChunkTrees) {
    TANDEM_LONG_FORM_ONLY(GetParam());
    const auto scene = boxes_scene(7, 4); // 2058 tetrahedra: three levels of tiles
    auto frame = scene.frame(1);
    for (const int k : sanitized() ? std::vector<int>{8, 18} : std::vector<int>{6, 8, 18})
        for (const auto slabs : {Slabs::three, Slabs::all}) {
            SCOPED_TRACE(fmt::format("k={}", k));
            expect_the_same_bounds(scene, frame, {.k = k}, slabs);
        }
    frame.skipped.resize(scene.bodies.size());
    for (std::uint32_t t = 0; t < 600; ++t) frame.skipped[1].push_back(3 * t);
    expect_the_same_bounds(scene, frame, {.k = 18}, Slabs::three);
}

/// One tetrahedron, 32, 33, 1024 and 1025: full tiles, and tiles with a single box.
TEST_P(Tiles, OfEverySize) {
    for (const std::uint32_t items : {1u, 31u, 32u, 33u, 1023u, 1024u, 1025u}) {
        SCOPED_TRACE(items);
        Random random(items);
        Scene scene;
        scene.name = scene.key = "sizes";
        auto mesh = shaken_box(6, random); // 1296
        mesh.tetrahedra.resize(items);
        mesh.boundary.clear();
        complete_mesh(mesh, "part");
        scene.meshes = {mesh};
        scene.bodies = {{.mesh = 0}, {.mesh = 0, .fixed = true}};
        scene.frame_count = 1;
        Frame frame;
        frame.poses.resize(2);
        frame.deformed.resize(2);
        frame.poses[1].translation = {0.1, 0.05, 0};
        scene.frame = [frame](std::size_t) { return frame; };
        expect_the_same_bounds(scene, frame, {.k = 18}, Slabs::three);
        const auto right = reference(scene, frame, {}, false, Method::brute_force);
        const auto& traversal = algorithm("tiled");
        const std::array devices{&on};
        const auto session = traversal.prepare(
            devices, scene,
            resolve(traversal.parameters(), preset(traversal, "resident").values, {}, "tiled"));
        EXPECT_EQ(session->run(frame).download(), right.pairs);
    }
}

/// A frame launches as many groups as the previous frame had work for. Here that is almost none because the
/// bodies were far apart.
TEST_P(Tiles, AFrameWithMuchMoreWorkThanTheLast) {
    const auto scene = boxes_scene(5, 3);
    const auto frame = scene.frame(0);
    auto apart = frame;
    for (std::size_t i = 0; i < apart.poses.size(); ++i)
        apart.poses[i].translation += Eigen::Vector3d(100.0 * static_cast<double>(i), 0, 0);
    for (std::size_t i = 0; i < apart.deformed.size(); ++i)
        for (auto& p : apart.deformed[i]) p += Eigen::Vector3d(100.0 * static_cast<double>(i), 0, 0);
    const auto right = reference(scene, frame, {}, false, Method::sweep);
    ASSERT_GT(right.pairs.size(), 1000u);
    const auto& traversal = algorithm("tiled");
    const std::array devices{&on};
    const auto session = traversal.prepare(
        devices, scene, resolve(traversal.parameters(), {}, {{"broad", "device"}}, "tiled"));
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(session->run(apart).count, 0u);
        EXPECT_EQ(session->run(frame).download(), right.pairs);
    }
}

/// Bodies of scattered tetrahedra that overlap; `counts` has the number of tetrahedra of each mesh.
Scene scattered_scene(const std::vector<std::size_t>& counts, std::size_t bodies) {
    Random random(9);
    Scene scene;
    for (const auto count : counts) {
        std::vector<Eigen::Vector3d> positions;
        for (std::size_t i = 0; i < count; ++i)
            positions.push_back({random.uniform(), random.uniform(), random.uniform()});
        scene.meshes.push_back(tetrahedra_at(positions, 0.05));
    }
    for (std::uint32_t body = 0; body < bodies; ++body)
        scene.bodies.push_back({.mesh = body % static_cast<std::uint32_t>(counts.size())});
    scene.frame = [bodies](std::size_t) {
        Frame frame;
        frame.poses.resize(bodies);
        frame.deformed.resize(bodies);
        for (std::size_t i = 0; i < bodies; ++i)
            frame.poses[i].translation.x() = 0.03 * static_cast<double>(i);
        return frame;
    };
    return scene;
}

std::unique_ptr<Session> tiled_session(Device& on, const Scene& scene, const std::string& broad,
                                       std::uint32_t most_seeds) {
    const auto& traversal = algorithm("tiled");
    const std::array devices{&on};
    const SettingTexts settings{{"broad", broad}, {"most_seeds", std::to_string(most_seeds)}};
    return traversal.prepare(devices, scene, resolve(traversal.parameters(), {}, settings, "tiled"));
}

/// Few bodies with few tiles below their top tiles start the traversal at those tiles. Many bodies, or bodies
/// without such tiles, start at the tops.
TEST_P(Tiles, FewBodiesStartBelowTheirTops) {
    struct Case {
        std::vector<std::size_t> counts;
        std::size_t bodies;
        std::uint32_t most_seeds, levels, walked, starts;
    };
    for (const auto& [counts, count, most_seeds, levels, walked, starts] :
         {Case{{64}, 3, 12, 2, 1, 2}, Case{{64}, 3, 11, 2, 2, 1}, Case{{40, 96, 128}, 4, 96, 2, 1, 4},
          Case{{1100, 2100}, 2, 256, 3, 2, 3}, Case{{1100, 2100}, 2, 16384, 3, 1, 66},
          Case{{129}, 3, 256, 2, 1, 5}, Case{{64, 20}, 4, 256, 2, 1, 2}, Case{{1100, 20}, 2, 256, 3, 3, 1},
          Case{{40}, 33, 256, 2, 2, 1}}) {
        SCOPED_TRACE(
            fmt::format("{} bodies of {} tetrahedra and more, {} seeds", count, counts.front(), most_seeds));
        const auto scene = scattered_scene(counts, count);
        const Bodies bodies(on, scene, {}, Bodies::Sharing::by_mesh);
        const TileTrees trees(bodies, Slabs::three, SelfPairs::off, group_size, most_seeds);
        EXPECT_EQ(trees.levels(), levels);
        EXPECT_EQ(trees.walked_levels(), walked);
        EXPECT_EQ(trees.begins(walked - 1), starts);
        const auto right = reference(scene, scene.frame(0), {}, true, Method::brute_force);
        ASSERT_GT(right.digest.count, 0u);
        for (const std::string broad : {"device", "sphere"}) {
            const auto session = tiled_session(on, scene, broad, most_seeds);
            for (int i = 0; i < 2; ++i) EXPECT_EQ(session->run(scene.frame(0)).download(), right.pairs);
        }
        if (starts < 8) continue;
        // Start pairs whose roots are disjoint, here most of them, are not tested.
        const auto session = tiled_session(on, scene, "sphere", most_seeds);
        session->count_work(true);
        const auto seeds = session->run(scene.frame(0)).work.at("seeds");
        EXPECT_GT(seeds, 0u);
        EXPECT_LT(seeds, (counts[0] + 31) / 32 * ((counts[1] + 31) / 32) / 2);
    }
}

/// Bodies in a row, ten of them fixed. In every third frame they overlap by half, otherwise only at their
/// ends.
Scene row_of_bodies(std::uint32_t count) {
    auto scene = scattered_scene({100, 20, 40}, count);
    for (std::uint32_t body = 0; body < 10; ++body) scene.bodies[body].fixed = true;
    scene.frame = [start = scene.frame(0)](std::size_t index) {
        auto frame = start;
        for (std::size_t body = 0; body < frame.poses.size(); ++body) {
            const double spacing = index % 3 == 2 && body >= 10 ? 0.5 : 0.98;
            const double moved = body < 10 ? 0 : 0.01 * static_cast<double>(index);
            frame.poses[body].translation.x() = spacing * static_cast<double>(body) + moved;
        }
        return frame;
    };
    return scene;
}

/// With slabs=touched, a frame after one with few pairs of tiles bounds the tetrahedra of touched tiles only,
/// and finds the same pairs. Bodies of one tile and fixed bodies are among them.
TEST_P(Tiles, BoundsOfTouchedTilesGiveTheSamePairs) {
    const auto scene = row_of_bodies(3 * std::max(60u, on.info().compute_units));
    const auto& traversal = algorithm("tiled");
    const std::array devices{&on};
    for (const std::string k : {"6", "18"}) {
        const SettingTexts settings{{"slabs", "touched"}, {"k", k}, {"contact_rule", "none"}};
        const auto session =
            traversal.prepare(devices, scene, resolve(traversal.parameters(), {}, settings, "tiled"));
        std::vector<std::ptrdiff_t> launches;
        for (std::size_t index = 0; index < 7; ++index) {
            SCOPED_TRACE(fmt::format("k = {}, frame {}", k, index));
            const auto frame = scene.frame(index);
            on.set_clocks(Clocks::on);
            EXPECT_EQ(session->run(frame).download(),
                      reference(scene, frame, {.k = std::stoi(k)}, true, Method::brute_force).pairs);
            launches.push_back(std::ranges::count(on.finish().events, "bound_touched_tiles", &Event::label));
            on.set_clocks(Clocks::off);
        }
        EXPECT_EQ(launches, (std::vector<std::ptrdiff_t>{0, 1, 1, 0, 1, 1, 0}));
    }
}

/// Explicit body pairs are rejected if 32 bits cannot number their start pairs of tiles. The session then
/// continues.
TEST_P(Tiles, StartPairsPastTheRangeOfAWordAreRejected) {
    std::vector<Eigen::Vector3d> positions(66 * 32, Eigen::Vector3d::Zero());
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i].x() = static_cast<double>(i);
    Scene scene;
    scene.meshes = {tetrahedra_at(positions, 0.5)};
    scene.bodies = {{.mesh = 0}, {.mesh = 0}};
    Frame frame;
    frame.poses.resize(2);
    frame.deformed.resize(2);
    scene.frame = [frame](std::size_t) { return frame; };
    const auto& traversal = algorithm("tiled");
    const std::array devices{&on};
    const auto session = traversal.prepare(
        devices, scene, resolve(traversal.parameters(), {}, {{"most_seeds", "16384"}}, "tiled"));
    const std::vector<BodyPair> most(0xffffffffu / (66 * 66) + 1, BodyPair{0, 1});
    EXPECT_THROW(session->run(frame, most), InputError);
    EXPECT_EQ(session->run(frame, std::span(most).first(1)).count, positions.size());
}

INSTANTIATE_TEST_SUITE_P(Devices, Tiles, testing::ValuesIn(device_names()),
                         [](const auto& name) { return device_label(name.param); });

} // namespace
} // namespace tandem
