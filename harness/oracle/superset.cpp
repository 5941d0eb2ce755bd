// SPDX-License-Identifier: MIT
#include "harness/oracle/superset.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tandem::oracle {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Box empty_box{infinity, infinity, infinity, -infinity, -infinity, -infinity};

void add(Box& box, const std::array<double, 3>& point) {
    for (unsigned axis = 0; axis < 3; ++axis) {
        box[axis] = std::min(box[axis], point[axis]);
        box[3 + axis] = std::max(box[3 + axis], point[axis]);
    }
}

/// Tetrahedra that meet the whole of another body, by their lower bounds along x.
std::vector<std::uint32_t> near(const Boxes& body, const Box& other) {
    std::vector<std::uint32_t> result;
    for (std::uint32_t i = 0; i < body.tetrahedra.size(); ++i)
        if (boxes_meet(body.tetrahedra[i], other)) result.push_back(i);
    std::sort(result.begin(), result.end(),
              [&](auto i, auto j) { return body.tetrahedra[i][0] < body.tetrahedra[j][0]; });
    return result;
}

} // namespace

bool boxes_meet(const Box& p, const Box& q) {
    return p[0] <= q[3] && q[0] <= p[3] && p[1] <= q[4] && q[1] <= p[4] && p[2] <= q[5] && q[2] <= p[5];
}

Boxes::Boxes(std::span<const TetraCorners> corners, std::span<const std::uint32_t> skipped)
    : tetrahedra(corners.size(), empty_box), whole(empty_box) {
    for (std::uint32_t i = 0; i < corners.size(); ++i) {
        if (std::binary_search(skipped.begin(), skipped.end(), i)) continue;
        bool finite = true;
        for (const auto& corner : corners[i])
            for (const double x : corner) finite &= std::isfinite(x);
        if (!finite) {
            invalid.push_back(i);
            continue;
        }
        for (const auto& corner : corners[i]) {
            add(tetrahedra[i], corner);
            add(whole, corner);
        }
    }
}

void add_near_pairs(const Boxes& a, const Boxes& b, std::uint32_t body_a, std::uint32_t body_b,
                    std::vector<Pair>& pairs) {
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
                if (boxes_meet(p, b.tetrahedra[*k])) pairs.push_back({body_a, *i, body_b, *k});
            ++i;
        } else {
            for (auto k = i; k != list_a.end() && a.tetrahedra[*k][0] <= q[3]; ++k)
                if (boxes_meet(q, a.tetrahedra[*k])) pairs.push_back({body_a, *k, body_b, *j});
            ++j;
        }
    }
}

} // namespace tandem::oracle
