// SPDX-License-Identifier: MIT
#include "scenes/simulate/mass.h"

#include "base/error.h"
#include "scenes/simulate/algebra.h"

#include <cmath>

namespace tandem {

namespace {

using simulate::determinant;

double tetrahedron_volume(const Mesh& mesh, const Tetrahedron& t) {
    Eigen::Matrix3d edges;
    for (int i = 0; i < 3; ++i)
        edges.col(i) = mesh.vertices[t[static_cast<std::size_t>(i) + 1]] - mesh.vertices[t[0]];
    return std::fabs(determinant(edges)) / 6;
}

/// Integral of x_i x_j over the tetrahedron with corners p: V/20 (sum_k p_ki p_kj + s_i s_j), s = sum_k p_k.
Eigen::Matrix3d second_moment(const std::array<Eigen::Vector3d, 4>& p, double volume) {
    const Eigen::Vector3d sum = (p[0] + p[1]) + (p[2] + p[3]);
    Eigen::Matrix3d result;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            double products = sum[i] * sum[j];
            for (const auto& corner : p) products += corner[i] * corner[j];
            result(i, j) = products * (volume / 20);
        }
    return result;
}

/// True when the matrix is positive definite (Sylvester's criterion).
bool definite(const Eigen::Matrix3d& m) {
    const double minor = m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0);
    return m(0, 0) > 0 && minor > 0 && determinant(m) > 0 && std::isfinite(determinant(m));
}

} // namespace

MassProperties mass_properties(const Mesh& mesh, double density) {
    MassProperties result;
    Eigen::Vector3d first = Eigen::Vector3d::Zero();
    for (std::uint32_t number = 0; number < mesh.tetrahedra.size(); ++number) {
        if (is_merged(mesh, number)) continue;
        const auto& t = mesh.tetrahedra[number];
        const double mass = tetrahedron_volume(mesh, t) * density;
        result.mass += mass;
        for (const auto vertex : t) first += mesh.vertices[vertex] * (mass / 4);
    }
    if (!(result.mass > 0) || !std::isfinite(result.mass))
        throw InputError("mesh '" + mesh.name + "' at density " + std::to_string(density) + " has mass "
                         + std::to_string(result.mass) + ": give it volume and a positive density");
    result.centre = first / result.mass;
    // Integrates about the centre of mass, which avoids cancellation for meshes far from their origin.
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
    for (std::uint32_t number = 0; number < mesh.tetrahedra.size(); ++number) {
        if (is_merged(mesh, number)) continue;
        const auto& t = mesh.tetrahedra[number];
        std::array<Eigen::Vector3d, 4> corners;
        for (std::size_t i = 0; i < 4; ++i) corners[i] = mesh.vertices[t[i]] - result.centre;
        moment += second_moment(corners, tetrahedron_volume(mesh, t) * density);
    }
    result.inertia = simulate::trace(moment) * Eigen::Matrix3d::Identity() - moment;
    if (!definite(result.inertia))
        throw InputError("mesh '" + mesh.name + "' has an inertia tensor without inverse: it is too flat");
    return result;
}

} // namespace tandem
