// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

namespace tandem {

/// Gives a completed mesh a pressure field: at each vertex `modulus` times its distance from the mesh's
/// boundary, over the largest such distance. A mesh without inner vertices has 0 everywhere. Distances are in
/// double, found with a hierarchy over the boundary's triangles. Throws InputError that begins with `option`
/// for a modulus that is not finite or not above 0.
void make_pressures(Mesh& mesh, double modulus, const std::string& option = "--pressure");

/// The largest pressure at a vertex of a boundary face; 0 for a mesh without a field.
double most_pressure_on_boundary(const Mesh& mesh);

/// Throws InputError naming `source` unless there is one pressure a vertex, or none at all, each finite, not
/// negative and at most the largest float.
void check_pressures(const Mesh& mesh, const std::string& source);

} // namespace tandem
