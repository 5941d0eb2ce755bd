// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/decision.h"

#include <span>
#include <vector>

namespace tandem::oracle {

/// Minima along x, y and z, then maxima.
using Box = std::array<double, 6>;

inline bool boxes_overlap(const Box& p, const Box& q) {
    return p[0] <= q[3] && q[0] <= p[3] && p[1] <= q[4] && q[1] <= p[4] && p[2] <= q[5] && q[2] <= p[5];
}

/// Boxes of a body's tetrahedra, and of the whole body, widened by `off` on all sides. A skipped tetrahedron
/// has an empty box. One with a coordinate that is not finite has an empty box and is listed in `invalid`.
struct Boxes {
    std::vector<Box> tetrahedra;
    Box whole{};
    std::vector<std::uint32_t> invalid;

    Boxes() = default;
    /// `skipped` must be ascending.
    explicit Boxes(std::span<const TetraCorners> tetrahedra, std::span<const std::uint32_t> skipped = {},
                   double off = 0);

    /// Boxes around these and others of the same body. A tetrahedron that is empty in one of both is empty.
    void join(const Boxes& other);
};

/// (body, tetrahedron) of all invalid tetrahedra, sorted; `boxes` is by body.
std::vector<std::array<std::uint32_t, 2>> invalid_of(std::span<const Boxes> boxes);

/// Valid tetrahedra of a body whose boxes overlap the other box, sorted by their lower bounds along x.
std::vector<std::uint32_t> near(const Boxes& body, const Box& other);

/// Calls visit(tetrahedron of a, of b) for every pair whose closed boxes overlap. These are a superset of the
/// intersecting pairs: boxes are minima and maxima of the coordinates that the decision uses, and only the
/// widening is rounded, outwards.
template<class Visit>
void for_near_pairs(const Boxes& a, const Boxes& b, Visit visit) {
    const auto list_a = near(a, b.whole);
    const auto list_b = near(b, a.whole);
    auto i = list_a.begin();
    auto j = list_b.begin();
    // The tetrahedron that starts first along x finds the other one.
    while (i != list_a.end() && j != list_b.end()) {
        const auto& p = a.tetrahedra[*i];
        const auto& q = b.tetrahedra[*j];
        if (p[0] <= q[0]) {
            for (auto k = j; k != list_b.end() && b.tetrahedra[*k][0] <= p[3]; ++k)
                if (boxes_overlap(p, b.tetrahedra[*k])) visit(*i, *k);
            ++i;
        } else {
            for (auto k = i; k != list_a.end() && a.tetrahedra[*k][0] <= q[3]; ++k)
                if (boxes_overlap(q, a.tetrahedra[*k])) visit(*k, *j);
            ++j;
        }
    }
}

} // namespace tandem::oracle
