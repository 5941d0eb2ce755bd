// SPDX-License-Identifier: MIT
#include "algorithms/baselines/cubql/cubql_walker.h"

#include "algorithms/baselines/cubql/cubql_stages.h"
#include "algorithms/hierarchy/queries.h"

#include <algorithm>

namespace tandem {

CubqlWalker::CubqlWalker(CubqlTrees& trees, const BuildContext& context)
    : trees_(trees),
      parts_(
          std::max(1u, (most_queries(trees.bodies()) + CubqlTrees::group_size - 1) / CubqlTrees::group_size)),
      kernel_(context.device.compile(cubql_kernels(), "collide_cubql",
                                     {{"GROUP_SIZE", std::to_string(CubqlTrees::group_size)}})) {}

void CubqlWalker::do_launch(const WalkTask& task) {
    auto& device = trees_.bodies().device();
    const StageScope scope(device, Stage::traverse);
    const auto turns = std::uint64_t{task.most_pairs()} * parts_;
    const Grid grid{std::min<std::uint64_t>(turns, 64 * std::uint64_t{device.info().compute_units}),
                    CubqlTrees::group_size};
    device.launch(kernel_, grid,
                  std::array<Argument, 12>{
                      trees_.tree_nodes(), trees_.tree_table(), trees_.order(), trees_.boxes(),
                      task.body_pairs, task.pair_capacity, parts_, std::uint32_t{build_.windowed ? 1u : 0u},
                      std::uint32_t{build_.counting ? 1u : 0u}, task.answer.pairs.buffer(),
                      task.answer.pairs.capacity(), task.status.buffer()});
}

void CubqlWalker::do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const {
    work[cubql_counters::leaf_tests.name] += status.counter(STATUS_OWN);
}

} // namespace tandem
