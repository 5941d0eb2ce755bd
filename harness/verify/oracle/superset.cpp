// SPDX-License-Identifier: MIT
#include "harness/verify/oracle/superset.h"

#include <algorithm>
#include <cmath>
#include <iterator>
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

void add(Box& box, const Box& other) {
    add(box, std::array{other[0], other[1], other[2]});
    add(box, std::array{other[3], other[4], other[5]});
}

bool is_empty(const Box& box) { return box[0] > box[3]; }

/// Widens by at least `off`, rounding outwards.
void widen(Box& box, double off) {
    for (unsigned axis = 0; axis < 3; ++axis) {
        box[axis] = std::nextafter(box[axis] - off, -infinity);
        box[3 + axis] = std::nextafter(box[3 + axis] + off, infinity);
    }
}

} // namespace

Boxes::Boxes(std::span<const TetraCorners> corners, std::span<const std::uint32_t> skipped, double off)
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
        auto& box = tetrahedra[i];
        for (const auto& corner : corners[i]) add(box, corner);
        if (off > 0) widen(box, off);
        add(whole, box);
    }
}

void Boxes::join(const Boxes& other) {
    std::vector<std::uint32_t> both;
    std::ranges::set_union(invalid, other.invalid, std::back_inserter(both));
    invalid = std::move(both);
    whole = empty_box;
    for (std::size_t i = 0; i < tetrahedra.size(); ++i) {
        auto& box = tetrahedra[i];
        if (is_empty(box) || is_empty(other.tetrahedra[i])) {
            box = empty_box;
            continue;
        }
        add(box, other.tetrahedra[i]);
        add(whole, box);
    }
}

std::vector<std::array<std::uint32_t, 2>> invalid_of(std::span<const Boxes> boxes) {
    std::vector<std::array<std::uint32_t, 2>> result;
    for (std::uint32_t body = 0; body < boxes.size(); ++body)
        for (const auto tetrahedron : boxes[body].invalid) result.push_back({body, tetrahedron});
    return result;
}

/// Empty boxes overlap nothing, so that invalid and skipped tetrahedra need no special case.
std::vector<std::uint32_t> near(const Boxes& body, const Box& other) {
    std::vector<std::uint32_t> result;
    for (std::uint32_t i = 0; i < body.tetrahedra.size(); ++i)
        if (boxes_overlap(body.tetrahedra[i], other)) result.push_back(i);
    std::sort(result.begin(), result.end(),
              [&](auto i, auto j) { return body.tetrahedra[i][0] < body.tetrahedra[j][0]; });
    return result;
}

} // namespace tandem::oracle
