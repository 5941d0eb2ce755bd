// SPDX-License-Identifier: MIT
#include "geometry/common_point.h"

#include "geometry/facets.h"

#include <algorithm>

namespace tandem::geometry {

namespace {

/// The half-space normal . x >= offset.
struct HalfSpace {
    Vector<double> normal;
    double offset;
};

std::array<HalfSpace, 4> half_spaces(const TetraCorners& corners) {
    std::array<HalfSpace, 4> result;
    for (unsigned i = 0; i < 4; ++i) {
        const auto& p = corners[faces[i][0]];
        auto normal = cross(minus(corners[faces[i][1]], p), minus(corners[faces[i][2]], p));
        if (dot(normal, minus(corners[i], p)) < 0) normal = minus({0, 0, 0}, normal);
        result[i] = {normal, dot(normal, p)};
    }
    return result;
}

/// Sum and number of the ends of edges' parts.
struct Ends {
    Vector<double> sum{};
    unsigned count = 0;

    void add(const Vector<double>& p, const Vector<double>& along, double t) {
        for (unsigned axis = 0; axis < 3; ++axis) sum[axis] += p[axis] + t * along[axis];
        ++count;
    }
    /// Adds the ends of the edges' parts inside all half-spaces.
    void add_parts(const TetraCorners& corners, const std::array<HalfSpace, 4>& inside) {
        for (const auto& edge : edges) {
            const auto& p = corners[edge.from];
            const auto along = minus(corners[edge.to], p);
            double low = 0, high = 1;
            for (const auto& half : inside) {
                const double height = dot(half.normal, p) - half.offset, slope = dot(half.normal, along);
                if (slope > 0) low = std::max(low, -height / slope);
                if (slope < 0) high = std::min(high, -height / slope);
                if (slope == 0 && height < 0) high = -1;
            }
            if (low > high) continue;
            add(p, along, low);
            add(p, along, high);
        }
    }
};

} // namespace

std::optional<std::array<double, 3>> common_point(const TetraCorners& a, const TetraCorners& b) {
    Ends ends;
    ends.add_parts(a, half_spaces(b));
    ends.add_parts(b, half_spaces(a));
    if (ends.count == 0) return std::nullopt;
    for (double& x : ends.sum) x /= ends.count;
    return ends.sum;
}

} // namespace tandem::geometry
