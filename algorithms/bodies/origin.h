// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/choices.h"
#include "scenes/scene.h"

namespace tandem {

/// The origin of coordinates for sessions of the scene. Origin::automatic: the centre of the box around frame
/// 0, rounded to a multiple of a power of two that is at least the longest side of the box. It is zero for a
/// scene near the world's origin; for a distant scene, subtracting it rarely needs rounding. Zero if the
/// scene has no frame or has a coordinate that is not finite.
Eigen::Vector3d origin_of(const Scene& scene, Origin origin);

/// The frame with coordinates relative to `origin`: one subtraction in double for each vertex of deformable
/// bodies, and for the translation of other bodies.
Frame counted_from(const Eigen::Vector3d& origin, Frame frame);

} // namespace tandem
