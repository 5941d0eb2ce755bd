// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/choices.h"
#include "scenes/scene.h"

namespace tandem {

/// The centre of the box around a frame of the scene, rounded to a multiple of a power of two that is at
/// least the longest side of the box. It is zero for a frame near the world's origin; in a distant frame,
/// subtracting it rarely needs rounding. Zero if a coordinate is not finite.
Eigen::Vector3d middle_of(const Scene& scene, const Frame& frame);

/// The origin of coordinates for sessions of the scene. Origin::automatic: the middle of frame 0. Zero
/// without Scene::frame, where the first frame of each session decides.
Eigen::Vector3d origin_of(const Scene& scene, Origin origin);

/// The frame with coordinates relative to `origin`: one subtraction in double for each vertex of deformable
/// bodies, and for the translation of other bodies.
Frame counted_from(const Eigen::Vector3d& origin, Frame frame);

} // namespace tandem
