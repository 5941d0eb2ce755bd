// SPDX-License-Identifier: MIT
#include "algorithms/leaf_query/scene_queries.h"

#include "algorithms/broad_phase/filters.h"
#include "algorithms/sources.h"

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
    kernel_ = tree_.bodies().device().compile(kernel_source("algorithms/leaf_query/scene_query.cl"),
                                              "query_scene", defines);
}

void SceneQueries::do_launch(const WalkTask& task) {
    const auto& bodies = tree_.bodies();
    const auto count = tree_.count();
    if (!task.complete) partners_.upload(task.on_host, bodies.count());
    const StageScope scope(bodies.device(), Stage::traverse);
    const auto groups = (std::uint64_t{count} + shape_.group_size - 1) / shape_.group_size;
    const std::array<Argument, 16> arguments{tree_.leaf_bounds(),
                                             tree_.leaves(),
                                             tree_.inner(),
                                             tree_.inner_bounds(),
                                             count,
                                             filters_,
                                             partners_.table(),
                                             std::uint32_t{task.complete ? 0u : 1u},
                                             tree_.state(),
                                             tree_.tree_table(),
                                             bodies.row_table(),
                                             bodies.ids(),
                                             bodies.topology(),
                                             task.answer.pairs.buffer(),
                                             task.answer.pairs.capacity(),
                                             task.status.buffer()};
    bodies.device().launch(kernel_, {std::min<std::uint64_t>(shape_.groups, groups), shape_.group_size},
                           arguments);
}

void SceneQueries::do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const {
    work[counters::bvtt_nodes.name] += status.counter(STATUS_BVTT_NODES);
    work[counters::seeds.name] += status.counter(STATUS_SEEDS);
}

} // namespace tandem
