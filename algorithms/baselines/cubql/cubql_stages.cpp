// SPDX-License-Identifier: MIT
#include "algorithms/baselines/cubql/cubql_stages.h"

#include "algorithms/baselines/cubql/build.h"
#include "algorithms/baselines/cubql/cubql_walker.h"

namespace tandem {

std::string_view cubql_absence() {
    if (*cubql_trees::query_ptx != '\0') return {};
    return "this program was built without cuBQL; clone github.com/NVIDIA/cuBQL, then configure with "
           "-DCUBQL_INCLUDE_DIR=<clone> on a machine with nvcc and build again";
}

AlgorithmStages cubql_stages(const BuildContext& context) {
    auto trees = std::make_unique<CubqlTrees>(context);
    auto walker = std::make_unique<CubqlWalker>(*trees, context);
    return {std::move(trees), std::move(walker)};
}

} // namespace tandem
