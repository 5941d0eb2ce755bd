// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/contact.h"
#include "scenes/simulate/model.h"

#include <span>

namespace tandem::simulate {

/// Replaces contact normals that no nearby surface has, such as sideways on level ground. They occur because
/// a contact of two tetrahedra also depends on inner faces and on edges that overlap by rounding. A valid
/// normal is a sum, with weights >= 0, of normals of boundary faces of body a near the contact; its opposite
/// is such a sum of body b. These sums form a cone: the normal of a face, between those of an edge's faces,
/// or between those of a corner's faces. An invalid normal is replaced by the nearest valid one. The new
/// depth is that of the two surfaces along it through the contact's point. Tilted or curved bodies that
/// penetrate can have disjoint cones. Then a normal is kept unless it is far from both cones, or slightly off
/// the only nearby face of one body. Contacts of deformable bodies, and of tetrahedra off the boundary, are
/// unchanged.
void set_surface_normals(const Model& model, const Frame& frame, std::span<ContactPoint> contacts);

} // namespace tandem::simulate
