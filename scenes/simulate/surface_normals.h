// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/contact.h"
#include "scenes/simulate/model.h"

#include <span>

namespace tandem::simulate {

/// Contacts are made of two tetrahedra, which have faces inside of their bodies and edges that overlap by
/// rounding alone: the way of the least translation may be one that no surface there has, as sideways on a
/// level ground. A normal must be a sum, with weights of at least 0, of normals of boundary faces of body a
/// near the contact, and backwards one of body b: of a face itself, of what lies between an edge's two faces,
/// of what a corner's faces span. Normals that are not are turned into the nearest such, and the depth
/// becomes that of the two surfaces along it through the contact's point. Where bodies in each other, tilted
/// or curved, have no direction in common there, a normal stays unless it is far from both, or a little off
/// the single face that one of them has there. Contacts of deformable bodies, and of tetrahedra that touch no
/// boundary on either side, stay as they are.
void set_surface_normals(const Model& model, const Frame& frame, std::span<ContactPoint> contacts);

} // namespace tandem::simulate
