// SPDX-License-Identifier: MIT
// Cost floors of this folder's kernels. Tests of two tetrahedra are not comparisons of slabs, so operations
// are not counted.
#include "algorithms/bodies/cost.h"

namespace tandem {

namespace {

constexpr double row_words = 4; ///< vertex numbers of a tetrahedron, or reals of a vertex

} // namespace

std::vector<KernelCost> contact_costs(const SceneFacts& scene) {
    // Every candidate pair, and every tetrahedron and vertex of one.
    const auto pairs = [=](const FrameFacts& f) {
        return scene.row_bytes * f.candidate_pairs + row_words * 4 * f.touched_rows
               + row_words * scene.real * f.touched_vertices;
    };
    const auto contacts = [=](const FrameFacts& f) { return (8 + 8 * scene.real) * f.contacts; };
    constexpr auto few = "nothing: the number of pairs that reach it is not counted";
    return {
        {"certify_pairs", pairs, {}, "reads candidate pairs, their tetrahedra and vertices"},
        {"separate_pairs", {}, {}, few},
        {"generate_contacts", contacts, {}, "writes contacts; the pairs that it reads depend on the launch"},
        {"filter_pairs", {}, {}, few},
        {"recheck_pairs", {}, {}, few},
        {"gather_corners", {}, {}, few},
        {"settle_pairs", {}, {}, few},
        {"digest_contacts", contacts, {}, "reads contacts"}};
}

} // namespace tandem
