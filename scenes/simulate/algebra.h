// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace tandem::simulate {

// Sums in a fixed order. The order in Eigen's reductions and products can depend on version, compiler and
// vector width; only Eigen's elementwise operations are reproducible.

inline double dot(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return (a.x() * b.x() + a.y() * b.y()) + a.z() * b.z();
}

inline Eigen::Vector3d cross(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}

inline double length(const Eigen::Vector3d& v) { return std::sqrt(dot(v, v)); }

inline Eigen::Vector3d apply(const Eigen::Matrix3d& m, const Eigen::Vector3d& v) {
    return {(m(0, 0) * v.x() + m(0, 1) * v.y()) + m(0, 2) * v.z(),
            (m(1, 0) * v.x() + m(1, 1) * v.y()) + m(1, 2) * v.z(),
            (m(2, 0) * v.x() + m(2, 1) * v.y()) + m(2, 2) * v.z()};
}

/// a b
inline Eigen::Matrix3d multiply(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
    Eigen::Matrix3d result;
    for (int column = 0; column < 3; ++column) result.col(column) = apply(a, b.col(column));
    return result;
}

inline double determinant(const Eigen::Matrix3d& m) { return dot(m.col(0), cross(m.col(1), m.col(2))); }

/// Transpose of the matrix of cofactors; inverse(m) = adjugate(m) / determinant(m).
inline Eigen::Matrix3d adjugate(const Eigen::Matrix3d& m) {
    Eigen::Matrix3d result;
    result.row(0) = cross(m.col(1), m.col(2)).transpose();
    result.row(1) = cross(m.col(2), m.col(0)).transpose();
    result.row(2) = cross(m.col(0), m.col(1)).transpose();
    return result;
}

inline double trace(const Eigen::Matrix3d& m) { return (m(0, 0) + m(1, 1)) + m(2, 2); }

/// Sum of the squares of all entries.
inline double squared_norm(const Eigen::Matrix3d& m) {
    return (dot(m.col(0), m.col(0)) + dot(m.col(1), m.col(1))) + dot(m.col(2), m.col(2));
}

} // namespace tandem::simulate
