// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/build_context.h"
#include "algorithms/hierarchy/hierarchy.h"
#include "algorithms/pipeline/walker.h"

namespace tandem {

/// An algorithm's own stages of a frame: a hierarchy, and the walk over it.
struct AlgorithmStages {
    std::unique_ptr<Hierarchy> hierarchy;
    std::unique_ptr<Walker> walker;
};

} // namespace tandem
