// SPDX-License-Identifier: MIT
// The floors of this folder's kernels. Tests of two tetrahedra are no comparisons of slabs: of operations
// nothing is said.
#include "algorithms/cost.h"

namespace tandem {

namespace {

constexpr double row_words = 4; ///< of a tetrahedron's vertex numbers, and reals of a vertex

} // namespace

std::vector<KernelCost> contact_costs(const SceneFacts& scene) {
    // Every pair, and every tetrahedron and vertex that is in one.
    const auto pairs = [=](const FrameFacts& f) {
        return scene.row_bytes * f.candidate_pairs + row_words * 4 * f.touched_rows
               + row_words * scene.real * f.touched_vertices;
    };
    const auto contacts = [=](const FrameFacts& f) { return (8 + 8 * scene.real) * f.contacts; };
    constexpr auto few = "nothing: how many pairs are left to it is not counted";
    return {{"certify_pairs", pairs, {}, "candidate pairs, their tetrahedra and vertices in"},
            {"separate_pairs", {}, {}, few},
            {"generate_contacts", contacts, {}, "contacts out; which pairs come in depends on the launch"},
            {"filter_pairs", {}, {}, few},
            {"recheck_pairs", {}, {}, few},
            {"gather_corners", {}, {}, few},
            {"settle_pairs", {}, {}, few},
            {"digest_contacts", contacts, {}, "contacts in"}};
}

} // namespace tandem
