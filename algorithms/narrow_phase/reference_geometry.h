// SPDX-License-Identifier: MIT
// Arithmetic that the parts of the serial reference share.
#pragma once

#include "algorithms/narrow_phase/reference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace tandem::narrow_phase {

template<class Real>
using Vector = std::array<Real, 3>;

/// Corners of edges and of faces, in the order of features. Face i is opposite corner i.
constexpr unsigned edge_ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
constexpr unsigned face_corners[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};

template<class Real>
constexpr Real unit_roundoff = std::numeric_limits<Real>::epsilon() / 2;

template<class Real>
Vector<Real> operator-(const Vector<Real>& a, const Vector<Real>& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

template<class Real>
Vector<Real> operator+(const Vector<Real>& a, const Vector<Real>& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

template<class Real>
Vector<Real> operator*(const Vector<Real>& a, Real b) {
    return {a[0] * b, a[1] * b, a[2] * b};
}

template<class Real>
Vector<Real> operator/(const Vector<Real>& a, Real b) {
    return {a[0] / b, a[1] / b, a[2] / b};
}

/// Adds x and y first, then z, as the kernels do.
template<class Real>
Real dot(const Vector<Real>& a, const Vector<Real>& b) {
    const Real xy = a[0] * b[0] + a[1] * b[1];
    return xy + a[2] * b[2];
}

template<class Real>
Vector<Real> cross(const Vector<Real>& a, const Vector<Real>& b) {
    Vector<Real> result;
    for (unsigned i = 0; i < 3; ++i) {
        const unsigned j = (i + 1) % 3, k = (i + 2) % 3;
        result[i] = a[j] * b[k] - a[k] * b[j];
    }
    return result;
}

template<class Real>
Real largest(const Vector<Real>& a) {
    return std::max({std::abs(a[0]), std::abs(a[1]), std::abs(a[2])});
}

/// The power of two that scales `length` into [1, 2), bounded by the largest finite one.
template<class Real>
Real scale_of(Real length) {
    int exponent = 0;
    std::frexp(length, &exponent);
    return std::ldexp(Real(1), std::min(1 - exponent, std::numeric_limits<Real>::max_exponent - 1));
}

/// A tetrahedron and its planes.
template<class Real>
struct Tetrahedron {
    Corners<Real> corners; ///< relative to A's first corner and scaled
    Corners<Real> normals; ///< outward, of the face opposite each corner

    /// Distance of p along the face's normal, times the normal's length; negative inside.
    Real distance(unsigned face, const Vector<Real>& p) const {
        return dot(normals[face], p - corners[face_corners[face][0]]);
    }
};

/// Outward normals of any length; empty if the volume may be zero.
template<class Real>
std::optional<Corners<Real>> outward_normals(const Corners<Real>& world) {
    Vector<Real> extent;
    for (unsigned axis = 0; axis < 3; ++axis) {
        const auto [low, high] =
            std::minmax({world[0][axis], world[1][axis], world[2][axis], world[3][axis]});
        extent[axis] = high - low;
    }
    const Real scale = scale_of(largest(extent));
    Corners<Real> corners;
    for (unsigned i = 0; i < 4; ++i) corners[i] = (world[i] - world[0]) * scale;
    extent = extent * scale;
    const Real determinant = dot(corners[1], cross(corners[2], corners[3]));
    if (std::abs(determinant) <= 48 * unit_roundoff<Real> * (extent[0] * extent[1] * extent[2]))
        return std::nullopt;
    Corners<Real> normals;
    for (unsigned face = 0; face < 4; ++face) {
        const auto& [first, second, third] = face_corners[face];
        Vector<Real> normal = cross(corners[second] - corners[first], corners[third] - corners[first]);
        if (largest(normal) == 0) return std::nullopt;
        const bool inward = face % 2 == 0 ? determinant < 0 : determinant > 0;
        normals[face] = inward ? normal * Real(-1) : normal;
    }
    return normals;
}

/// Divides by the largest component first, so that its square neither overflows nor underflows.
template<class Real>
Vector<Real> unit(const Vector<Real>& a) {
    const auto shorter = a / largest(a);
    return shorter / std::sqrt(dot(shorter, shorter));
}

template<class Real>
Real taxicab(const Vector<Real>& a) {
    return std::abs(a[0]) + std::abs(a[1]) + std::abs(a[2]);
}

} // namespace tandem::narrow_phase
