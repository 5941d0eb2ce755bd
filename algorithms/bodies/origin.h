// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/choices.h"
#include "scenes/scene.h"

namespace tandem {

/// The point that a session of the scene counts coordinates from. Of Origin::automatic the middle of the box
/// around frame 0, rounded to a power of two no less than the box is long: zero for a scene about the
/// world's origin, and a difference that seldom needs rounding for one far from it. Zero where the scene has
/// no frame or a coordinate of it is not finite.
Eigen::Vector3d origin_of(const Scene& scene, Origin origin);

/// The frame with coordinates that count from `origin`; a difference in double each. Deformable bodies only
/// have vertices of their own to move, rigid ones poses.
Frame counted_from(const Eigen::Vector3d& origin, Frame frame);

} // namespace tandem
