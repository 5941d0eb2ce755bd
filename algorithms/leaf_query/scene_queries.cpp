// SPDX-License-Identifier: MIT
#include "algorithms/leaf_query/scene_queries.h"

#include "algorithms/broad_phase/filters.h"
#include "algorithms/kernels/sources.h"

#include <algorithm>

namespace tandem {

SceneQueries::SceneQueries(SceneTree& tree, LaunchShape shape)
    : tree_(tree),
      shape_(shape),
      filters_(uploaded_filters(tree.bodies().device(), tree.bodies().scene())),
      partners_(tree.bodies().device()) {}

void SceneQueries::do_compile(const WalkBuild& build) {
    auto defines = tree_.defines(shape_.group_size);
    build.add_to(defines);
    if (has_filters(tree_.bodies().scene())) defines["FILTERED"] = "1";
    compile_kernel(tree_.bodies().device(), kernel_, defines);
}

void SceneQueries::do_launch(const WalkTask& task) {
    const auto& bodies = tree_.bodies();
    const auto count = tree_.count();
    if (!task.complete) partners_.upload(task.on_host, bodies.count());
    const StageScope scope(bodies.device(), Stage::traverse);
    const auto groups = (std::uint64_t{count} + shape_.group_size - 1) / shape_.group_size;
    const kernels::scene_query::QueryScene arguments{.leaf_bounds = tree_.leaf_bounds(),
                                                     .leaves = tree_.leaves(),
                                                     .inner = tree_.inner(),
                                                     .inner_bounds = tree_.inner_bounds(),
                                                     .count = count,
                                                     .filters = filters_,
                                                     .partners = partners_.table(),
                                                     .has_lists = std::uint32_t{task.complete ? 0u : 1u},
                                                     .state = tree_.state(),
                                                     .trees = tree_.tree_table(),
                                                     .bodies = bodies.row_table(),
                                                     .ids = bodies.ids(),
                                                     .tetrahedra = bodies.topology(),
                                                     .found = task.answer.pairs.buffer(),
                                                     .capacity = task.answer.pairs.capacity(),
                                                     .status = task.status.buffer()};
    bodies.device().launch(kernel_, {std::min<std::uint64_t>(shape_.groups, groups), shape_.group_size},
                           arguments);
}

void SceneQueries::do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const {
    work[counters::bvtt_nodes.name] += status.counter(STATUS_BVTT_NODES);
    work[counters::seeds.name] += status.counter(STATUS_SEEDS);
}

} // namespace tandem
