// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/decision.h"

#include <span>
#include <vector>

namespace tandem::oracle {

/// Minima, then maxima.
using Box = std::array<double, 6>;

inline bool boxes_meet(const Box& p, const Box& q) {
    return p[0] <= q[3] && q[0] <= p[3] && p[1] <= q[4] && q[1] <= p[4] && p[2] <= q[5] && q[2] <= p[5];
}

/// Boxes of a body's tetrahedra, and of all of them. Those with a coordinate that is not finite are empty
/// boxes and listed; those that are skipped are empty boxes. Boxes are wider by `off` at all sides.
struct Boxes {
    std::vector<Box> tetrahedra;
    Box whole{};
    std::vector<std::uint32_t> invalid;

    Boxes() = default;
    /// `skipped`: ascending.
    explicit Boxes(std::span<const TetraCorners> tetrahedra, std::span<const std::uint32_t> skipped = {},
                   double off = 0);
};

/// Valid tetrahedra of a body whose boxes meet the other body's, by their lower bounds along x.
std::vector<std::uint32_t> near(const Boxes& body, const Box& other);

/// Calls visit(tetrahedron of a, of b) for every two whose closed boxes meet: a superset of those that meet,
/// since boxes are minima and maxima of the very coordinates the decision takes and nothing is rounded but
/// what makes them wider, outwards.
template<class Visit>
void for_near_pairs(const Boxes& a, const Boxes& b, Visit visit) {
    const auto list_a = near(a, b.whole);
    const auto list_b = near(b, a.whole);
    auto i = list_a.begin();
    auto j = list_b.begin();
    // Of two that meet, the one that starts first finds the other.
    while (i != list_a.end() && j != list_b.end()) {
        const auto& p = a.tetrahedra[*i];
        const auto& q = b.tetrahedra[*j];
        if (p[0] <= q[0]) {
            for (auto k = j; k != list_b.end() && b.tetrahedra[*k][0] <= p[3]; ++k)
                if (boxes_meet(p, b.tetrahedra[*k])) visit(*i, *k);
            ++i;
        } else {
            for (auto k = i; k != list_a.end() && a.tetrahedra[*k][0] <= q[3]; ++k)
                if (boxes_meet(q, a.tetrahedra[*k])) visit(*k, *j);
            ++j;
        }
    }
}

} // namespace tandem::oracle
