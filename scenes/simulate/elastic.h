// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/dynamics.h"
#include "scenes/mesh.h"

#include <span>

namespace tandem::simulate {

/// A linear tetrahedron at rest.
struct Element {
    Tetrahedron corners{};
    Eigen::Matrix3d inverse_rest = Eigen::Matrix3d::Zero(); ///< inverse matrix of edges from corner 0
    double volume = 0;                                      ///< m^3, absolute
};

/// An elastic mesh; the mesh is its rest shape.
struct ElasticMesh {
    Elastic::Law law = Elastic::Law::corotational;
    double mu = 0, lambda = 0;          ///< Pa, Lame's parameters
    double damping = 0;                 ///< kg/(s m^3)
    std::vector<Element> elements;      ///< elements of non-zero volume
    std::vector<double> masses;         ///< kg, lumped: each corner gets a quarter of the element's mass
    std::vector<double> inverse_masses; ///< 0 for pinned vertices
};

/// Throws InputError when a vertex has no mass or a pinned vertex does not exist.
ElasticMesh make_elastic_mesh(const Mesh& mesh, const Elastic& elastic, double density);

/// Energy (J) and first Piola-Kirchhoff stress (Pa) of one element with deformation gradient `f`, per rest
/// volume. Corotational: mu |F - R|^2 + lambda/2 tr(R'F - 1)^2 with R the rotation closest to F.
/// Saint-Venant- Kirchhoff: mu E:E + lambda/2 tr(E)^2 with E = (F'F - 1)/2 (Sifakis and Barbic, "FEM
/// simulation of 3D deformable solids", SIGGRAPH 2012 courses, 3.3 and 3.4).
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

/// Adds damping forces (N): the negative product of the elements' consistent matrices,
/// damping * volume / 20 (1 + delta_ij), and `velocities` (m/s).
void add_damping_forces(const ElasticMesh& mesh, std::span<const Eigen::Vector3d> velocities,
                        std::span<Eigen::Vector3d> forces);

/// Elastic energy (J) and number of inverted elements.
struct Strain {
    double energy = 0;
    std::size_t inverted = 0;
};
Strain strain(const ElasticMesh& mesh, std::span<const Eigen::Vector3d> positions);

/// Adds the consistent load of a uniform traction (N/m^2) on a triangle: traction * area / 3 at each corner.
void add_traction(const std::array<std::uint32_t, 3>& triangle, const Eigen::Vector3d& traction,
                  std::span<const Eigen::Vector3d> positions, std::span<Eigen::Vector3d> forces);

} // namespace tandem::simulate
