// SPDX-License-Identifier: MIT
// Cost models of the kernels in digest.cl.
#include "algorithms/cost.h"

namespace tandem {

std::vector<KernelCost> answer_costs(const SceneFacts& scene) {
    const auto pairs = [=](const FrameFacts& f) {
        return scene.row_bytes * f.candidate_pairs + 4 * f.touched_rows;
    };
    return {{"digest_pairs", pairs, {}, "candidate pairs and numbers of their tetrahedra in"},
            {"expand_pairs",
             [=](const FrameFacts& f) { return pairs(f) + 16 * f.candidate_pairs; },
             {},
             "candidate pairs and numbers of their tetrahedra in, four words a pair out"}};
}

} // namespace tandem
