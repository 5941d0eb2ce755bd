// SPDX-License-Identifier: MIT
// Cost models of the kernels in digest.cl, sort.cl, closest.cl and wrenches.cl.
#include "algorithms/bodies/cost.h"

namespace tandem {

std::vector<KernelCost> answer_costs(const SceneFacts& scene) {
    const auto pairs = [=](const FrameFacts& f) {
        return scene.row_bytes * f.candidate_pairs + 4 * f.touched_rows;
    };
    return {{"digest_pairs", pairs, {}, "candidate pairs and numbers of their tetrahedra in"},
            {"expand_pairs",
             [=](const FrameFacts& f) { return pairs(f) + 16 * f.candidate_pairs; },
             {},
             "candidate pairs and numbers of their tetrahedra in, four words a pair out"},
            {"count_pairs", pairs, {}, "candidate pairs and numbers of their tetrahedra in"},
            {"sum_parts", {}, {}, "nothing: less than the counts that start_runs reads and writes"},
            {"start_runs", {}, {}, "nothing: a word in and out for each tetrahedron or pair that is counted"},
            {"scatter_pairs",
             [=](const FrameFacts& f) { return pairs(f) + 4 * f.candidate_pairs; },
             {},
             "candidate pairs and numbers of their tetrahedra in, a key each out"},
            {"sort_pairs",
             [=](const FrameFacts& f) { return (scene.row_bytes + 4) * f.candidate_pairs; },
             {},
             "keys in, pairs out"},
            {"mark_contacts", {}, {}, "nothing: contacts are not counted in advance"},
            {"place_contacts", {}, {}, "nothing: contacts are not counted in advance"},
            {"find_closest", {}, {}, "nothing: distances before the reduction are not counted"},
            {"keep_closest", {}, {}, "nothing: a word for each place of the table"},
            {"count_reduced", {}, {}, "nothing: two words"},
            {"add_wrenches", {}, {}, "nothing: polygons before the reduction are not counted"},
            {"write_wrenches", {}, {}, "nothing: a word for each place of the table"}};
}

} // namespace tandem
