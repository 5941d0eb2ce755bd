// SPDX-License-Identifier: MIT
#include "algorithms/baselines/cubql/cubql_stages.h"

#include "algorithms/baselines/cubql/cubql_walker.h"

namespace tandem {

std::string_view cubql_absence() { return {}; }

AlgorithmStages cubql_stages(const BuildContext& context) {
    auto trees = std::make_unique<CubqlTrees>(context);
    auto walker = std::make_unique<CubqlWalker>(*trees, context);
    return {std::move(trees), std::move(walker)};
}

} // namespace tandem
