// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/contact.h"
#include "scenes/dynamics.h"

#include <span>

namespace tandem {

/// Selects contacts for the solver. `contacts` are in ascending order of (pair, feature); the result is in
/// ascending order of (body_a, body_b, tet_a, tet_b, feature). sizes[i] is the reference length (m) of
/// distances at body i. The result does not depend on units or threads.
///
/// First, contacts of the same bodies are merged when their normals are within one degree and their distance
/// is below distance * the smaller size. The first one is kept, with the greater penetration. Second, a body
/// pair with more than `per_pair` contacts keeps the deepest, then repeatedly the farthest from those kept
/// (Gonzalez, "Clustering to minimize the maximum intercluster distance", Theor. Comput. Sci. 38, 1985). The
/// metric combines position, over the diagonal of the pair's contacts, and normal. Ties go to the first.
std::vector<ContactPoint> reduce_contacts(std::span<const ContactPoint> contacts,
                                          std::span<const double> sizes, const ReductionSettings& settings);

} // namespace tandem
