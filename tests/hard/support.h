// SPDX-License-Identifier: MIT
// Measurements on families of hard cases: the truth, and methods that are known to fail.
#pragma once

#include "algorithms/bodies/origin.h"
#include "geometry/decision.h"
#include "harness/verify/oracle/frame_truth.h"
#include "scenes/hard/hard.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace tandem::hard_test {

inline TetraCorners widened(const FloatCorners& corners) {
    TetraCorners result;
    for (unsigned i = 0; i < 4; ++i)
        for (unsigned axis = 0; axis < 3; ++axis) result[i][axis] = static_cast<double>(corners[i][axis]);
    return result;
}

inline Relation relation_of(const HardPair& pair) { return relation(widened(pair.a), widened(pair.b)); }

inline bool meets(Relation relation) {
    return relation == Relation::touching || relation == Relation::overlapping;
}

/// Whether the oracle's relation agrees with the one known by construction.
inline bool agrees(Known known, Relation relation) {
    switch (known) {
    case Known::disjoint:
        return relation == Relation::disjoint;
    case Known::touching:
        return relation == Relation::touching;
    case Known::overlapping:
        return relation == Relation::overlapping;
    case Known::invalid:
        return relation == Relation::invalid;
    default:
        return true;
    }
}

template<class Real>
using RealVector = std::array<Real, 3>;

template<class Real>
RealVector<Real> difference_of(const std::array<float, 3>& p, const std::array<float, 3>& q) {
    return {Real(p[0]) - Real(q[0]), Real(p[1]) - Real(q[1]), Real(p[2]) - Real(q[2])};
}

/// Whether the axis separates the tetrahedra strictly, ignoring rounding.
template<class Real>
bool axis_separates(const HardPair& pair, const RealVector<Real>& axis) {
    Real low[2], high[2];
    for (unsigned body = 0; body < 2; ++body)
        for (unsigned i = 0; i < 4; ++i) {
            const auto d = difference_of<Real>((body == 0 ? pair.a : pair.b)[i], pair.a[0]);
            const Real x = d[0] * axis[0] + d[1] * axis[1] + d[2] * axis[2];
            low[body] = i == 0 ? x : std::min(low[body], x);
            high[body] = i == 0 ? x : std::max(high[body], x);
        }
    return high[0] < low[1] || high[1] < low[0];
}

template<class Real>
RealVector<Real> product_of(const RealVector<Real>& p, const RealVector<Real>& q) {
    return {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
}

/// Textbook test of the 44 separating axes in the given precision.
template<class Real>
bool plain_meets(const HardPair& pair) {
    constexpr unsigned ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    constexpr unsigned faces[4][2] = {{0, 1}, {0, 2}, {1, 2}, {3, 4}}; // edges that span them
    RealVector<Real> edges[2][6];
    for (unsigned body = 0; body < 2; ++body)
        for (unsigned e = 0; e < 6; ++e) {
            const auto& corners = body == 0 ? pair.a : pair.b;
            edges[body][e] = difference_of<Real>(corners[ends[e][1]], corners[ends[e][0]]);
        }
    for (const auto& own : edges)
        for (const auto& face : faces)
            if (axis_separates(pair, product_of(own[face[0]], own[face[1]]))) return false;
    for (const auto& p : edges[0])
        for (const auto& q : edges[1])
            if (axis_separates(pair, product_of(p, q))) return false;
    return true;
}

/// Whether slabs along {-1, 0, 1} directions overlap in single precision. Sums are rounded to nearest,
/// directions are normalised if `unit`, and slabs at most `tolerance` apart count as overlapping.
inline bool slabs_overlap(const HardPair& pair, const std::vector<std::array<int, 3>>& directions, bool unit,
                          float tolerance) {
    for (const auto& d : directions) {
        const int terms = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        const float length = unit ? 1 / std::sqrt(static_cast<float>(terms)) : 1.0F;
        float low[2], high[2];
        for (unsigned body = 0; body < 2; ++body)
            for (unsigned i = 0; i < 4; ++i) {
                const auto& c = (body == 0 ? pair.a : pair.b)[i];
                float x = 0;
                for (unsigned axis = 0; axis < 3; ++axis) x += static_cast<float>(d[axis]) * length * c[axis];
                low[body] = i == 0 ? x : std::min(low[body], x);
                high[body] = i == 0 ? x : std::max(high[body], x);
            }
        if (low[1] - high[0] > tolerance || low[0] - high[1] > tolerance) return false;
    }
    return true;
}

/// Setting origin of the cells that a family is made for.
inline Origin origin_for(const HardFamily& family) {
    return family.distant ? Origin::automatic : Origin::world;
}

/// The truth of a scene's first frame as cells in single precision with this origin round it.
inline FrameTruth rounded_truth(const Scene& scene, Origin origin, SelfPairs self = SelfPairs::off) {
    return frame_truth(scene, counted_from(origin_of(scene, origin), scene.frame(0)),
                       {Precision::fp32, Placement::rounded, origin, self});
}

inline std::vector<const HardFamily*> pair_families(bool rigid) {
    std::vector<const HardFamily*> result;
    for (const auto& family : hard_families())
        if (family.pair != nullptr && (family.pose != nullptr) == rigid) result.push_back(&family);
    return result;
}

} // namespace tandem::hard_test
