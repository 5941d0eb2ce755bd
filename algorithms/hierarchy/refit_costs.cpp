// SPDX-License-Identifier: MIT
// Cost floors of refit.cl and refit_tiles.cl: moving bodies only, all launches of a frame together.
#include "algorithms/bodies/cost.h"
#include "algorithms/hierarchy/chunk_trees.h"
#include "backends/lanes.h"

#include <cmath>
#include <numeric>

namespace tandem {

namespace {

constexpr double tile_boxes = TANDEM_LANES, corners = 4;

double parts_of(double count, double each) { return std::ceil(count / each); }

/// Bytes that leaves are built from: vertex numbers, vertices and poses.
double leaf_inputs(const SceneFacts& scene) {
    return scene.tetrahedron_rows * corners * 4 + scene.vertex_rows * 4 * scene.real
           + scene.moving * scene.pose_bytes;
}

double sum_of(const std::vector<std::uint32_t>& counts, const auto& of) {
    return std::accumulate(counts.begin(), counts.end(), 0.0,
                           [&](double sum, std::uint32_t count) { return sum + of(count); });
}

} // namespace

/// A chunk over n tetrahedra has 2n - 1 nodes. Levels above the lowest are few, and either kernel may refit
/// them, so neither floor counts them.
std::vector<KernelCost> chunk_tree_costs(const SceneFacts& scene, std::uint32_t leaves) {
    const auto items = sum_of(scene.tetrahedra, [](double n) { return n; });
    const auto chunks = sum_of(scene.tetrahedra, [&](double n) { return parts_of(n, leaves); });
    const auto strip_bytes = leaf_inputs(scene) + (2 * items - chunks) * scene.dop();
    const auto strip_operations = (corners * items + (items - chunks)) * scene.k;
    const auto top_bytes = (chunks + scene.moving) * scene.dop();
    return {{"refit_strips", [=](const FrameFacts&) { return strip_bytes; },
             [=](const FrameFacts&) { return strip_operations; },
             "reads vertex numbers, vertices and poses, writes nodes of chunks; k operations per corner and "
             "inner node"},
            {"refit_tops", [=](const FrameFacts&) { return top_bytes; },
             [=, k = scene.k](const FrameFacts&) { return chunks * k; },
             "reads roots of chunks, writes volumes of bodies; k operations per root"},
            {"empty_nodes",
             {},
             {},
             "nothing: the number of nodes that skipped tetrahedra change is not counted"}};
}

/// An inner node reads no less than its leaf, and is written once. Boxes, and nodes of fixed bodies, are not
/// counted.
std::vector<KernelCost> scene_tree_costs(const SceneFacts& scene) {
    constexpr double node_words = 4;
    const auto items = sum_of(scene.tetrahedra, [](double n) { return n; });
    const auto read = items * (scene.dop() + node_words * 4);
    auto costs = chunk_tree_costs(scene, ChunkTrees::one_chunk_a_body);
    for (const auto* entry : {"begin_build", "code_leaves", "count_digits", "scatter_digits", "link_nodes"})
        costs.push_back({entry, {}, {}, "nothing: frames that keep their tree have no work for it"});
    costs.push_back({"copy_leaf_bounds",
                     [=, dop = scene.dop()](const FrameFacts&) { return 2 * items * dop; }, no_operations,
                     "copies bounds of leaves"});
    costs.push_back({"bound_boxes", [=](const FrameFacts&) { return read; },
                     [=, k = scene.k](const FrameFacts&) { return items * k; },
                     "reads leaves and their bounds; k operations per leaf"});
    costs.push_back(
        {"bound_inner_nodes",
         [=, dop = scene.dop()](const FrameFacts&) { return read + items * (dop + node_words * 4); },
         [=, k = scene.k](const FrameFacts&) { return items * k; },
         "reads leaves, their bounds and inner nodes, writes bounds of inner nodes; k operations "
         "per inner node"});
    return costs;
}

/// Either kernel may build the tiles of level 1, so neither floor counts them.
std::vector<KernelCost> tile_tree_costs(const SceneFacts& scene, double leaf_words, bool touched) {
    const auto tiles = sum_of(scene.tetrahedra, [](double n) { return parts_of(n, tile_boxes); });
    const auto items = sum_of(scene.tetrahedra, [](double n) { return n; });
    const double stored_words = touched ? 0 : leaf_words; // by every refit
    const auto leaf_bytes = leaf_inputs(scene) - scene.tetrahedron_rows * (corners * 4 - 4)
                            + items * stored_words * scene.real + tiles * scene.dop();
    const auto leaf_operations = corners * stored_words * items + (items - tiles) * scene.k;
    const auto boxes = sum_of(scene.tetrahedra, [](double n) { // levels above 1: one box per tile below
        double sum = 0;
        auto below = parts_of(parts_of(n, tile_boxes), tile_boxes);
        while (below > 1) {
            sum += below;
            below = parts_of(below, tile_boxes);
        }
        return sum;
    });
    const auto upper_bytes = 2 * boxes * scene.dop();
    return {
        {"refit_leaf_tiles", [=](const FrameFacts&) { return leaf_bytes; },
         [=](const FrameFacts&) { return leaf_operations; },
         "reads a word of corners per tetrahedron, vertices and poses, writes bounds and roots of tiles; an "
         "operation per corner and end of a leaf, k per tetrahedron for roots; slabs=touched: without the "
         "bounds, which not every frame writes"},
        {"bound_touched_tiles",
         [=, real = scene.real](const FrameFacts& f) { return leaf_words * real * f.touched; },
         [=](const FrameFacts& f) { return corners * leaf_words * f.touched; },
         "writes bounds of tetrahedra in candidate pairs; an operation per corner and end of a leaf"},
        {"refit_upper_tiles", [=](const FrameFacts&) { return upper_bytes; },
         [=, k = scene.k](const FrameFacts&) { return boxes * k; },
         "reads roots of tiles, writes them as boxes, above level 1; k operations per box"}};
}

} // namespace tandem
