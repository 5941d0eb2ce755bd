// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/hierarchy/hierarchy.h"
#include "algorithms/walker.h"

namespace tandem {

/// Input from which an algorithm builds its stages. All references outlive the stages.
struct BuildContext {
    Device& device;
    const Scene& scene;
    const Settings& settings; ///< Traversal::fitted
    const Bodies& bodies;     ///< whose tetrahedra are to be walked: those of the scene, or fewer (walked_of)
    LaunchShape shape;
};

/// An algorithm's own stages of a frame: a hierarchy, and the walk over it.
struct AlgorithmStages {
    std::unique_ptr<Hierarchy> hierarchy;
    std::unique_ptr<Walker> walker;
};

} // namespace tandem
