// SPDX-License-Identifier: MIT
#include "algorithms/baselines/embree/embree_stages.h"

#include "algorithms/baselines/embree/embree_walker.h"

namespace tandem {

std::string_view embree_absence() { return {}; }

AlgorithmStages embree_stages(const BuildContext& context) {
    auto trees = std::make_unique<EmbreeTrees>(context);
    auto walker = std::make_unique<EmbreeWalker>(*trees, context);
    return {std::move(trees), std::move(walker)};
}

} // namespace tandem
