// SPDX-License-Identifier: MIT
#include "algorithms/baselines/embree/embree_steps.h"

#include "algorithms/baselines/embree/embree_walker.h"

namespace tandem {

std::string_view embree_absence() { return {}; }

Steps embree_steps(const Ground& ground) {
    auto trees = std::make_unique<EmbreeTrees>(ground);
    auto walker = std::make_unique<EmbreeWalker>(*trees, ground);
    return {std::move(trees), std::move(walker)};
}

} // namespace tandem
