// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"
#include "algorithms/kernels/launch_shape.h"
#include "algorithms/parameters/parameter.h"

namespace tandem {

/// Input from which an algorithm builds its stages. All references outlive the stages.
struct BuildContext {
    Device& device;
    const Scene& scene;
    const Settings& settings; ///< Traversal::fitted
    const Bodies& bodies;     ///< whose tetrahedra are to be walked: those of the scene, or fewer (walked_of)
    LaunchShape shape;
};

} // namespace tandem
