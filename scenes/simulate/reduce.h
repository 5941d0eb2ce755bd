// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/contact.h"
#include "scenes/dynamics.h"

#include <span>

namespace tandem {

/// The contacts that reach the solver, from `contacts` in ascending order of (pair, feature); those of two
/// bodies come together, in ascending order of (body_a, body_b, tet_a, tet_b, feature). sizes[i] is the
/// length (m) that distances at body i are measured by. Depends on the contacts alone and not on units.
///
/// First, a contact closer than distance * the smaller of two sizes to one kept before it, of the same bodies
/// and with a normal within one degree, is left out; the kept one takes the greater penetration of the two.
/// Then, of a body pair with more than `per_pair`, the deepest contact is kept and, until there are enough,
/// the one farthest from those kept (Gonzalez, "Clustering to minimize the maximum intercluster distance",
/// Theor. Comput. Sci. 38, 1985), by position over the diagonal of the pair's contacts and by normal
/// together. Ties go to the first.
std::vector<ContactPoint> reduce_contacts(std::span<const ContactPoint> contacts,
                                          std::span<const double> sizes, const ReductionSettings& settings);

} // namespace tandem
