// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/description/describe.h"

namespace tandem::description {

/// Reads the dynamics of a description after its meshes and bodies. Bodies with `elastic` become deformable
/// in `scene`; their vertices are written to `start`. Throws InputError with the location, also when fixed
/// bodies overlap.
std::shared_ptr<const Dynamics> read_dynamics(const Json& json, const JsonLocation& root, Scene& scene,
                                              Frame& start);

/// Checks a description without dynamics: throws InputError when a body has a material or is elastic.
void refuse_dynamics(const Json& json, const JsonLocation& root);

} // namespace tandem::description
