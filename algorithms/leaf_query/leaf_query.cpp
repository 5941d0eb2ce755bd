// SPDX-License-Identifier: MIT
#include "algorithms/traversal.h"

#include "algorithms/cost.h"
#include "algorithms/hierarchy/chunk_trees.h"
#include "algorithms/hierarchy/queries.h"
#include "algorithms/pipeline.h"
#include "algorithms/sources.h"

#include <algorithm>

namespace tandem {

namespace {

const std::vector<Preset> all_presets{
    {"resident",
     "everything resident, body pairs included, one wait per frame",
     {parameters::broad(Broad::device), parameters::builder(Builder::sah)}}};

constexpr std::array all_counters{counters::bvtt_nodes, counters::seeds};

/// Tetrahedra of a chunk: more than a body can have, so that each body is one tree.
constexpr std::uint32_t leaves = std::uint32_t{1} << 30;

/// Every tetrahedron of the smaller body of a body pair queries the other body's tree.
class LeafQueries final : public Walker {
public:
    /// `trees` must outlive this object; each body is one chunk.
    LeafQueries(const ChunkTrees& trees, LaunchShape shape, bool has_self);

private:
    void do_compile(const WalkBuild& build) override;
    void do_launch(const WalkTask& task) override;
    bool do_grow(const Status&) override { return false; }
    void do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const override;

    const ChunkTrees& trees_;
    LaunchShape shape_;
    std::uint32_t blocks_; ///< turns of a work-group for the body pair with the most queries
    Kernel kernel_;
};

LeafQueries::LeafQueries(const ChunkTrees& trees, LaunchShape shape, bool has_self)
    : trees_(trees), shape_(shape) {
    const auto queries = most_queries(trees.bodies(), has_self);
    blocks_ = std::max(1u, (queries + shape.group_size - 1) / shape.group_size);
}

void LeafQueries::do_compile(const WalkBuild& build) {
    auto defines = trees_.defines(shape_.group_size);
    build.add_to(defines);
    kernel_ = trees_.bodies().device().compile(kernel_source("algorithms/leaf_query/leaf_query.cl"),
                                               "query_leaves", defines);
}

void LeafQueries::do_launch(const WalkTask& task) {
    const auto& bodies = trees_.bodies();
    const StageScope scope(bodies.device(), Stage::traverse);
    const auto turns = std::uint64_t{task.most_pairs()} * blocks_;
    const Grid grid{std::min<std::uint64_t>(shape_.groups, turns), shape_.group_size};
    const std::array<Argument, 11> arguments{trees_.nodes(),
                                             trees_.tree_table(),
                                             bodies.row_table(),
                                             bodies.ids(),
                                             bodies.tetrahedra(),
                                             task.body_pairs,
                                             task.pair_capacity,
                                             blocks_,
                                             task.answer.pairs.buffer(),
                                             task.answer.pairs.capacity(),
                                             task.status.buffer()};
    bodies.device().launch(kernel_, grid, arguments);
}

void LeafQueries::do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const {
    work[counters::bvtt_nodes.name] += status.counter(STATUS_BVTT_NODES);
    work[counters::seeds.name] += status.counter(STATUS_SEEDS);
}

class LeafQuery : public Traversal {
public:
    std::string_view name() const override { return "leaf_query"; }
    std::string_view summary() const override {
        return "the field's standard method: a binary tree per body, which each tetrahedron of the other "
               "body "
               "queries, without a stack";
    }
    std::span<const Parameter* const> parameters() const override {
        static const auto all = pipeline_parameters({}, false);
        return all;
    }
    std::span<const Preset> presets() const override { return all_presets; }
    std::span<const Counter> counters() const override { return all_counters; }

private:
    void do_check(const Settings&, const DeviceInfo&) const override {}

    std::vector<KernelCost> do_costs(const Scene& scene, const Settings& settings) const override {
        const SceneFacts s(scene, settings);
        auto costs = chunk_tree_costs(s, leaves);
        costs.push_back(walk_cost(s, "query_leaves"));
        return costs;
    }

    AlgorithmStages do_build(const BuildContext& context) const override {
        auto trees = std::make_unique<ChunkTrees>(context.bodies, leaves, context.shape.group_size);
        auto queries = std::make_unique<LeafQueries>(*trees, context.shape,
                                                     context.settings[parameters::self] != SelfPairs::off);
        return {std::move(trees), std::move(queries)};
    }
};

} // namespace

/// Leaf queries, the method of most libraries: the common baseline.
const Traversal& leaf_query() {
    static const LeafQuery instance;
    return instance;
}

} // namespace tandem
