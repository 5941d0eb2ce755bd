// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/hierarchy/hierarchy.h"
#include "algorithms/walker.h"

namespace tandem {

/// What an algorithm makes its steps from. Everything in it outlives them.
struct BuildContext {
    Device& device;
    const Scene& scene;
    const Settings& settings; ///< as the device takes them
    const Bodies& bodies;
    LaunchShape shape;
};

/// An algorithm's own steps of a frame: a hierarchy, and the walk over it.
struct AlgorithmStages {
    std::unique_ptr<Hierarchy> hierarchy;
    std::unique_ptr<Walker> walker;
};

} // namespace tandem
