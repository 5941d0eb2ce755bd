// SPDX-License-Identifier: MIT
#include "scenes/simulate/polar.h"

#include "scenes/simulate/algebra.h"
#include "scenes/simulate/rotation.h"

#include <cmath>

namespace tandem::simulate {

namespace {

using Symmetric = Eigen::Matrix4d;

/// Iterates R <- (R + R^-T) / 2, which converges quadratically near a rotation. False when it does not
/// converge.
bool newton(Eigen::Matrix3d& r) {
    for (int iteration = 0; iteration < 12; ++iteration) {
        const double det = determinant(r);
        if (!(det > 0.05)) return false;
        const Eigen::Matrix3d next = 0.5 * (r + adjugate(r).transpose() / det);
        const double change = squared_norm(next - r);
        r = next;
        if (change < 1e-16) return true; // the error is of the order of the change squared
    }
    return false;
}

/// Horn's matrix: q'Nq = tr(R(q)'F) for unit quaternions q = (w, x, y, z).
Symmetric horn_matrix(const Eigen::Matrix3d& f) {
    Symmetric n;
    n(0, 0) = (f(0, 0) + f(1, 1)) + f(2, 2);
    n(1, 1) = (f(0, 0) - f(1, 1)) - f(2, 2);
    n(2, 2) = (f(1, 1) - f(0, 0)) - f(2, 2);
    n(3, 3) = (f(2, 2) - f(0, 0)) - f(1, 1);
    n(0, 1) = n(1, 0) = f(2, 1) - f(1, 2);
    n(0, 2) = n(2, 0) = f(0, 2) - f(2, 0);
    n(0, 3) = n(3, 0) = f(1, 0) - f(0, 1);
    n(1, 2) = n(2, 1) = f(1, 0) + f(0, 1);
    n(1, 3) = n(3, 1) = f(2, 0) + f(0, 2);
    n(2, 3) = n(3, 2) = f(2, 1) + f(1, 2);
    return n;
}

/// One rotation of Jacobi's method that zeroes a(p, q); `v` collects the eigenvectors as columns.
void rotate(Symmetric& a, Symmetric& v, int p, int q) {
    if (a(p, q) == 0) return;
    const double theta = (a(q, q) - a(p, p)) / (2 * a(p, q));
    const double t = (theta < 0 ? -1.0 : 1.0) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
    const double c = 1 / std::sqrt(t * t + 1);
    const double s = t * c;
    for (int i = 0; i < 4; ++i) {
        const double ip = a(i, p), iq = a(i, q);
        a(i, p) = c * ip - s * iq;
        a(i, q) = s * ip + c * iq;
    }
    for (int i = 0; i < 4; ++i) {
        const double pi = a(p, i), qi = a(q, i);
        a(p, i) = c * pi - s * qi;
        a(q, i) = s * pi + c * qi;
        const double vp = v(i, p), vq = v(i, q);
        v(i, p) = c * vp - s * vq;
        v(i, q) = s * vp + c * vq;
    }
}

Eigen::Quaterniond dominant(Symmetric a) {
    Symmetric v = Symmetric::Identity();
    // Convergence is quadratic: a 4x4 matrix is diagonal up to rounding after six sweeps.
    for (int sweep = 0; sweep < 8; ++sweep)
        for (int p = 0; p < 3; ++p)
            for (int q = p + 1; q < 4; ++q) rotate(a, v, p, q);
    int best = 0;
    for (int i = 1; i < 4; ++i)
        if (a(i, i) > a(best, best)) best = i;
    return unit(Eigen::Quaterniond(v(0, best), v(1, best), v(2, best), v(3, best)));
}

} // namespace

Eigen::Matrix3d closest_rotation(const Eigen::Matrix3d& f) {
    Eigen::Matrix3d r = f;
    if (newton(r)) return r;
    return rotation_matrix(dominant(horn_matrix(f)));
}

} // namespace tandem::simulate
