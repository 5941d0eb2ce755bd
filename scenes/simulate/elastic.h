// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/dynamics.h"
#include "scenes/mesh.h"

#include <span>

namespace tandem::simulate {

/// A linear tetrahedron at rest.
struct Element {
    Tetrahedron corners{};
    Eigen::Matrix3d inverse_rest = Eigen::Matrix3d::Zero(); ///< of the matrix of edges from corner 0
    double volume = 0;                                      ///< m^3, absolute
};

/// A mesh as elastic material; its rest shape is the mesh.
struct ElasticMesh {
    Elastic::Law law = Elastic::Law::corotational;
    double mu = 0, lambda = 0;          ///< Pa, Lame's
    double damping = 0;                 ///< kg/(s m^3)
    std::vector<Element> elements;      ///< those of non-zero volume
    std::vector<double> masses;         ///< kg, lumped: a quarter of each element's to each corner
    std::vector<double> inverse_masses; ///< 0 for pinned vertices
};

/// Throws InputError when a vertex gets no mass or a pinned one does not exist.
ElasticMesh make_elastic_mesh(const Mesh& mesh, const Elastic& elastic, double density);

/// Energy (J) and first Piola-Kirchhoff stress (Pa) of one element with deformation gradient `f`, per rest
/// volume. Corotational: mu |F - R|^2 + lambda/2 tr(R'F - 1)^2, R the rotation closest to F; Saint-Venant-
/// Kirchhoff: mu E:E + lambda/2 tr(E)^2, E = (F'F - 1)/2 (Sifakis and Barbic, "FEM simulation of 3D
/// deformable solids", SIGGRAPH 2012 courses, 3.3 and 3.4).
struct Response {
    double energy = 0;
    Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();
};
Response response(const ElasticMesh& mesh, const Eigen::Matrix3d& f);

/// Deformation gradient of an element at `positions`.
Eigen::Matrix3d gradient(const Element& element, std::span<const Eigen::Vector3d> positions);

/// Adds elastic forces (N) at `positions` to `forces`, one a vertex.
void add_elastic_forces(const ElasticMesh& mesh, std::span<const Eigen::Vector3d> positions,
                        std::span<Eigen::Vector3d> forces);

/// Adds damping forces (N): minus the elements' consistent matrices, damping * volume / 20 (1 + delta_ij),
/// times `velocities` (m/s).
void add_damping_forces(const ElasticMesh& mesh, std::span<const Eigen::Vector3d> velocities,
                        std::span<Eigen::Vector3d> forces);

/// Elastic energy (J) and number of elements turned inside out against their rest shape.
struct Strain {
    double energy = 0;
    std::size_t inverted = 0;
};
Strain strain(const ElasticMesh& mesh, std::span<const Eigen::Vector3d> positions);

/// Adds the consistent load of a uniform traction (N/m^2) on a triangle: area / 3 of it to each corner.
void add_traction(const std::array<std::uint32_t, 3>& triangle, const Eigen::Vector3d& traction,
                  std::span<const Eigen::Vector3d> positions, std::span<Eigen::Vector3d> forces);

} // namespace tandem::simulate
