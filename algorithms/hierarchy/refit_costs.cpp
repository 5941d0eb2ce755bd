// SPDX-License-Identifier: MIT
// The floors of refit.cl and refit_tiles.cl: of bodies that move, all of a frame's launches together.
#include "algorithms/cost.h"
#include "algorithms/hierarchy/levels.h"

#include <cmath>
#include <numeric>

namespace tandem {

namespace {

constexpr double tile_boxes = 32, corners = 4;

double parts_of(double count, double each) { return std::ceil(count / each); }

/// What leaves are made from: vertex numbers, vertices and poses.
double leaf_inputs(const SceneFacts& scene) {
    return scene.tetrahedron_rows * corners * 4 + scene.vertex_rows * 4 * scene.real
           + scene.moving * scene.pose_bytes;
}

double sum_of(const std::vector<std::uint32_t>& counts, const auto& of) {
    return std::accumulate(counts.begin(), counts.end(), 0.0,
                           [&](double sum, std::uint32_t count) { return sum + of(count); });
}

} // namespace

/// A chunk over n tetrahedra has 2n - 1 nodes. Levels above the lowest are few, and left to either kernel:
/// they are in no floor.
std::vector<KernelCost> chunk_tree_costs(const SceneFacts& scene, std::uint32_t leaves) {
    const auto items = sum_of(scene.tetrahedra, [](double n) { return n; });
    const auto chunks = sum_of(scene.tetrahedra, [&](double n) { return parts_of(n, leaves); });
    const auto strip_bytes = leaf_inputs(scene) + (2 * items - chunks) * scene.dop();
    const auto strip_operations = (corners * items + (items - chunks)) * scene.k;
    const auto top_bytes = (chunks + scene.moving) * scene.dop();
    return {{"refit_strips", [=](const FrameFacts&) { return strip_bytes; },
             [=](const FrameFacts&) { return strip_operations; },
             "vertex numbers, vertices and poses in, nodes of chunks out; k a corner and an inner node"},
            {"refit_tops", [=](const FrameFacts&) { return top_bytes; },
             [=, k = scene.k](const FrameFacts&) { return chunks * k; },
             "roots of chunks in, volumes of bodies out; k a root"},
            {"empty_nodes", {}, {}, "nothing: how many nodes skipped tetrahedra change is not counted"}};
}

/// Tiles of level 1 are made by either kernel, and in neither floor.
std::vector<KernelCost> tile_tree_costs(const SceneFacts& scene, double leaf_words) {
    const auto tiles = sum_of(scene.tetrahedra, [](double n) { return parts_of(n, tile_boxes); });
    const auto items = sum_of(scene.tetrahedra, [](double n) { return n; });
    const auto leaf_bytes = leaf_inputs(scene) - scene.tetrahedron_rows * (corners * 4 - 4)
                            + items * leaf_words * scene.real + tiles * scene.dop();
    const auto leaf_operations = corners * leaf_words * items + (items - tiles) * scene.k;
    const auto boxes = sum_of(scene.tetrahedra, [](double n) { // of levels above 1, a box for a tile below
        double sum = 0;
        auto below = parts_of(parts_of(n, tile_boxes), tile_boxes);
        while (below > 1) {
            sum += below;
            below = parts_of(below, tile_boxes);
        }
        return sum;
    });
    const auto upper_bytes = 2 * boxes * scene.dop();
    return {{"refit_leaf_tiles", [=](const FrameFacts&) { return leaf_bytes; },
             [=](const FrameFacts&) { return leaf_operations; },
             "a word of corners a tetrahedron, vertices and poses in, bounds and roots of tiles out; as many "
             "as a leaf has ends a corner, k a tetrahedron for roots"},
            {"refit_upper_tiles", [=](const FrameFacts&) { return upper_bytes; },
             [=, k = scene.k](const FrameFacts&) { return boxes * k; },
             "roots of tiles in, the same as boxes out, above level 1; k a box"}};
}

} // namespace tandem
