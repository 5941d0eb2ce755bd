// SPDX-License-Identifier: MIT
// Cost models of kernels: the bytes and operations that every implementation needs at least. They give a
// lower bound for the time of a kernel. Each folder has the models of its own kernels.
#pragma once

#include "algorithms/parameters/parameter.h"
#include "scenes/contact.h"
#include "scenes/scene.h"

#include <functional>
#include <map>
#include <span>
#include <string_view>
#include <vector>

namespace tandem {

/// Averages over the frames of a replay. Without downloaded pairs the three touched numbers are 0; the bounds
/// are then lower but valid.
struct FrameFacts {
    double body_pairs = 0,    ///< passed to run(), or found
        candidate_pairs = 0,  ///< found
        contacts = 0;         ///< contact points
    double touched = 0,       ///< distinct tetrahedra in candidate pairs
        touched_rows = 0,     ///< their rows in the table of vertex numbers; bodies with one mesh share rows
        touched_vertices = 0; ///< rows of their vertices; rigid bodies with one mesh share rows
    std::map<std::string_view, double> work{}; ///< by counter of the algorithm; empty if not counted

    /// The value of a counter; 0 if it is unknown.
    double counted(std::string_view counter) const;
};

/// The cost model of one kernel, for all its launches in a frame. Bytes are compulsory: each input is read
/// once and each output written once. Operations are comparisons, minima or maxima of two ends of slabs. An
/// overlap test of two k-DOPs needs k of them; test_overlaps in hierarchy/ceilings.cl measures their peak
/// rate. A null function means that the value is not modelled; negligible values are 0.
struct KernelCost {
    std::string_view entry;                         ///< name of the kernel's entry point
    std::function<double(const FrameFacts&)> bytes, ///< moved in a frame; null: not modelled
        operations;                                 ///< in a frame; null: not modelled
    std::string_view how;                           ///< one line: what is counted, or why nothing is
};

/// Operations of a kernel that only moves data.
inline double no_operations(const FrameFacts&) { return 0; }

/// Sizes of scene and settings that cost models use. Rows are those of the device.
struct SceneFacts {
    /// Sizes with fitted settings of an algorithm. Throws InputError as geometry_of.
    SceneFacts(const Scene& scene, const Settings& settings);

    double bodies = 0,                          ///< number of all bodies
        moving = 0;                             ///< number of bodies that are refitted in every frame
    double tetrahedron_rows = 0;                ///< of moving bodies, with 4 vertex numbers each
    double vertex_rows = 0;                     ///< of moving bodies, with 4 reals each
    double pose_bytes = 0,                      ///< of a pose
        real = 4,                               ///< bytes of a real
        k = 18;                                 ///< ends of a k-DOP
    double pair_bytes = 0;                      ///< of a candidate pair in the answer; 0: not stored
    double row_bytes = 0;                       ///< of a row of pairs
    std::vector<std::uint32_t> tetrahedra;      ///< by moving body
    std::vector<std::uint32_t> mesh_tetrahedra; ///< by mesh of a moving body

    double dop() const { return k * real; } ///< bytes of a k-DOP
};

/// Adds the tetrahedra and rows in the candidate pairs of a frame.
void add_touched(FrameFacts& facts, const Scene& scene, const Settings& settings,
                 std::span<const Pair> pairs);

/// The cost of a walk over chunk trees that counts counters::bvtt_nodes. It reads the nodes of tetrahedra in
/// candidate pairs, and writes the pairs.
KernelCost walk_cost(const SceneFacts& scene, std::string_view entry);

/// Costs of the kernels that every algorithm may launch; each is defined in the folder of its kernels.
std::vector<KernelCost> body_costs(const SceneFacts& scene);
std::vector<KernelCost> broad_costs(const SceneFacts& scene);
std::vector<KernelCost> contact_costs(const SceneFacts& scene);
std::vector<KernelCost> answer_costs(const SceneFacts& scene);
std::vector<KernelCost> published_costs(const SceneFacts& scene);
/// Costs of refits. `leaves`: tetrahedra of a chunk.
std::vector<KernelCost> chunk_tree_costs(const SceneFacts& scene, std::uint32_t leaves);
/// Those of a tree over all bodies, whose leaves are in trees of single bodies.
std::vector<KernelCost> scene_tree_costs(const SceneFacts& scene);
std::vector<KernelCost> tile_tree_costs(const SceneFacts& scene, double leaf_words, bool touched);

} // namespace tandem
