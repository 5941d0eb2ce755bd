// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"

namespace tandem {

/// Gives a completed mesh a pressure field: at each vertex `modulus` times its distance from the mesh's
/// boundary, over the largest such distance. A mesh without inner vertices has 0 everywhere. Distances are in
/// double, found with a hierarchy over the boundary's triangles. Throws InputError as checked_pressure().
void make_pressures(Mesh& mesh, double modulus);

/// The largest pressure at a vertex of a boundary face; 0 for a mesh without a field.
double most_pressure_on_boundary(const Mesh& mesh);

/// Throws InputError naming `source` unless there is one pressure a vertex, or none at all, each finite, not
/// negative and at most most_pressure.
void check_pressures(const Mesh& mesh, const std::string& source);

/// The number of bodies whose mesh has no field.
std::size_t bodies_without_field(const Scene& scene);

} // namespace tandem
