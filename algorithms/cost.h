// SPDX-License-Identifier: MIT
// What a kernel has to move and to compute at least, whatever way it is written: the floor that its time is
// held against. Each folder declares it for its own kernels, beside them.
#pragma once

#include "algorithms/traversal.h"

#include <functional>
#include <map>
#include <span>
#include <string_view>
#include <vector>

namespace tandem {

/// The mean frame of a replay.
struct FrameFacts {
    double body_pairs = 0, candidate_pairs = 0, contacts = 0;
    /// Of tetrahedra that are in a candidate pair: these, each of a body once; their rows in the table of
    /// vertex numbers; and the rows of their vertices. Bodies with one mesh have rows in common. 0 where
    /// the answer was not looked at: floors are then lower, and still floors.
    double touched = 0, touched_rows = 0, touched_vertices = 0;
    std::map<std::string_view, double> work{}; ///< by counter of the algorithm; empty where none was counted

    /// A counter's value; 0 where it is not known.
    double counted(std::string_view counter) const;
};

/// One kernel's floor, for a whole frame however many launches it takes. Bytes are compulsory ones: each
/// input read once and each output written once. Operations are comparisons of two ends of slabs, or the
/// lesser or greater of two, of which an overlap test of two k-DOPs takes k (test_overlaps in
/// bounds/ceilings.cl does those from registers, as fast as a device can). Either may be none: it is not
/// counted; what hardly has any says 0.
struct KernelCost {
    std::string_view entry;
    std::function<double(const FrameFacts&)> bytes, operations;
    std::string_view how; ///< what is counted, or why nothing is; one line
};

/// Operations of a kernel that only moves.
inline double no_operations(const FrameFacts&) { return 0; }

/// What of scene and settings costs are made of. Rows: as the device has them.
struct SceneFacts {
    SceneFacts(const Scene& scene, const Settings& settings);

    double bodies = 0, moving = 0;           ///< that are refitted in every frame
    double tetrahedron_rows = 0;             ///< that moving bodies have: 4 vertex numbers each
    double vertex_rows = 0;                  ///< of 4 reals
    double pose_bytes = 0, real = 4, k = 18; ///< bytes of a pose and of a real; ends of a k-DOP
    double pair_bytes = 0;                   ///< that a candidate pair takes in the answer; 0: it keeps none
    double row_bytes = 0;                    ///< of a row of pairs, where there are any
    std::vector<std::uint32_t> tetrahedra;   ///< of each moving body
    std::vector<std::uint32_t> mesh_tetrahedra; ///< of each mesh that a moving body has

    double dop() const { return k * real; } ///< bytes of a k-DOP
};

/// Adds what candidate pairs of a frame touch.
void add_touched(FrameFacts& facts, const Scene& scene, const Settings& settings,
                 std::span<const Pair> pairs);

/// Of a walk over chunk trees that counts counters::bvtt_nodes: the nodes of tetrahedra that are in candidate
/// pairs come in, these pairs go out.
KernelCost walk_cost(const SceneFacts& scene, std::string_view entry);

/// Kernels that every algorithm may launch; each in its folder.
std::vector<KernelCost> broad_costs(const SceneFacts& scene);
std::vector<KernelCost> contact_costs(const SceneFacts& scene);
std::vector<KernelCost> answer_costs(const SceneFacts& scene);
std::vector<KernelCost> published_costs(const SceneFacts& scene);
/// Refits. `leaves`: tetrahedra of a chunk.
std::vector<KernelCost> chunk_tree_costs(const SceneFacts& scene, std::uint32_t leaves);
std::vector<KernelCost> tile_tree_costs(const SceneFacts& scene, double leaf_words);

} // namespace tandem
