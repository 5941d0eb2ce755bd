// SPDX-License-Identifier: MIT
#include "scenes/simulate/elastic.h"

#include "base/error.h"
#include "scenes/simulate/algebra.h"
#include "scenes/simulate/polar.h"

#include <fmt/format.h>

namespace tandem::simulate {

namespace {

/// Matrix whose columns are the edges from corner 0: Dm at rest and Ds deformed in Sifakis and Barbic, with
/// F = Ds Dm^-1.
Eigen::Matrix3d edges(const Tetrahedron& t, std::span<const Eigen::Vector3d> positions) {
    Eigen::Matrix3d result;
    for (int i = 0; i < 3; ++i)
        result.col(i) = positions[t[static_cast<std::size_t>(i) + 1]] - positions[t[0]];
    return result;
}

/// P = 2 mu (F - R) + lambda tr(R'F - 1) R, where tr(R'F) - 3 = tr(S - 1) is the stretch without the
/// rotation.
Response corotational(const ElasticMesh& mesh, const Eigen::Matrix3d& f) {
    const Eigen::Matrix3d r = closest_rotation(f);
    const double stretch = trace(multiply(r.transpose(), f)) - 3;
    return {mesh.mu * squared_norm(f - r) + mesh.lambda / 2 * stretch * stretch,
            2 * mesh.mu * (f - r) + mesh.lambda * stretch * r};
}

/// P = F (2 mu E + lambda tr(E) 1) with Green's strain E, which is invariant under rotations.
Response saint_venant_kirchhoff(const ElasticMesh& mesh, const Eigen::Matrix3d& f) {
    const Eigen::Matrix3d green = 0.5 * (multiply(f.transpose(), f) - Eigen::Matrix3d::Identity());
    const double volumetric = trace(green);
    const Eigen::Matrix3d second =
        2 * mesh.mu * green + mesh.lambda * volumetric * Eigen::Matrix3d::Identity();
    return {mesh.mu * squared_norm(green) + mesh.lambda / 2 * volumetric * volumetric, multiply(f, second)};
}

void add_masses(ElasticMesh& result, double density) {
    for (const auto& element : result.elements)
        for (const auto corner : element.corners) result.masses[corner] += density * element.volume / 4;
}

/// Sets inverse masses and pins vertices. Throws InputError for a vertex without mass, which has no inverse.
void pin(ElasticMesh& result, const Mesh& mesh, const Elastic& elastic) {
    for (std::size_t i = 0; i < result.masses.size(); ++i) {
        if (!(result.masses[i] > 0))
            throw InputError(fmt::format("mesh '{}': vertex {} has no mass, so forces cannot move it: "
                                         "remove it or give its tetrahedra volume",
                                         mesh.name, i));
        result.inverse_masses.push_back(1 / result.masses[i]);
    }
    for (const auto vertex : elastic.pinned) {
        if (vertex >= result.masses.size())
            throw InputError(fmt::format("mesh '{}': pinned vertex {} does not exist, there are {}",
                                         mesh.name, vertex, result.masses.size()));
        result.inverse_masses[vertex] = 0;
    }
}

} // namespace

ElasticMesh make_elastic_mesh(const Mesh& mesh, const Elastic& elastic, double density) {
    ElasticMesh result;
    result.law = elastic.law;
    result.mu = elastic.young / (2 * (1 + elastic.poisson));
    result.lambda = elastic.young * elastic.poisson / ((1 + elastic.poisson) * (1 - 2 * elastic.poisson));
    result.damping = elastic.damping;
    for (std::uint32_t number = 0; number < mesh.tetrahedra.size(); ++number) {
        if (is_merged(mesh, number)) continue;
        const auto& t = mesh.tetrahedra[number];
        const Eigen::Matrix3d rest = edges(t, mesh.vertices);
        const double det = determinant(rest);
        // A flat element has no deformation gradient and no volume, hence no energy.
        if (det != 0) result.elements.push_back({t, adjugate(rest) / det, std::fabs(det) / 6});
    }
    result.masses.resize(mesh.vertices.size());
    add_masses(result, density);
    pin(result, mesh, elastic);
    return result;
}

Response response(const ElasticMesh& mesh, const Eigen::Matrix3d& f) {
    return mesh.law == Elastic::Law::corotational ? corotational(mesh, f) : saint_venant_kirchhoff(mesh, f);
}

Eigen::Matrix3d gradient(const Element& element, std::span<const Eigen::Vector3d> positions) {
    return multiply(edges(element.corners, positions), element.inverse_rest);
}

void add_elastic_forces(const ElasticMesh& mesh, std::span<const Eigen::Vector3d> positions,
                        std::span<Eigen::Vector3d> forces) {
    for (const auto& element : mesh.elements) {
        const auto stress = response(mesh, gradient(element, positions)).stress;
        // The force at corner i + 1 is minus column i of V P Dm^-T; the force at corner 0 makes the sum zero
        // (Sifakis and Barbic, 4.2).
        const Eigen::Matrix3d pulls = multiply(stress, element.inverse_rest.transpose()) * element.volume;
        const auto& corners = element.corners;
        for (int i = 0; i < 3; ++i) {
            forces[corners[static_cast<std::size_t>(i) + 1]] -= pulls.col(i);
            forces[corners[0]] += pulls.col(i);
        }
    }
}

void add_damping_forces(const ElasticMesh& mesh, std::span<const Eigen::Vector3d> velocities,
                        std::span<Eigen::Vector3d> forces) {
    if (mesh.damping == 0) return;
    for (const auto& element : mesh.elements) {
        // (1 + delta_ij) times the velocities is the sum over all corners plus the corner's own velocity.
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const auto corner : element.corners) sum += velocities[corner];
        const double factor = mesh.damping * element.volume / 20;
        for (const auto corner : element.corners) forces[corner] -= factor * (sum + velocities[corner]);
    }
}

Strain strain(const ElasticMesh& mesh, std::span<const Eigen::Vector3d> positions) {
    Strain result;
    for (const auto& element : mesh.elements) {
        const Eigen::Matrix3d f = gradient(element, positions);
        result.energy += response(mesh, f).energy * element.volume;
        if (!(determinant(f) > 0)) ++result.inverted;
    }
    return result;
}

void add_traction(const std::array<std::uint32_t, 3>& triangle, const Eigen::Vector3d& traction,
                  std::span<const Eigen::Vector3d> positions, std::span<Eigen::Vector3d> forces) {
    const Eigen::Vector3d normal = cross(positions[triangle[1]] - positions[triangle[0]],
                                         positions[triangle[2]] - positions[triangle[0]]);
    for (const auto corner : triangle) forces[corner] += traction * (length(normal) / 6);
}

} // namespace tandem::simulate
