// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/describe.h"

namespace tandem::description {

/// The dynamics of a description whose meshes and bodies are read. Bodies with `elastic` become deformable in
/// `scene` and get their vertices in `start`. Throws InputError that names the place, also when fixed bodies
/// overlap.
std::shared_ptr<const Dynamics> read_dynamics(const Json& json, const JsonLocation& root, Scene& scene,
                                              Frame& start);

/// Throws InputError when a body of a description without dynamics has a material or is elastic.
void refuse_dynamics(const Json& json, const JsonLocation& root);

} // namespace tandem::description
