// SPDX-License-Identifier: MIT
#include "algorithms/traversal.h"

#include "algorithms/bodies/cost.h"
#include "algorithms/leaf_query/body_queries.h"
#include "algorithms/leaf_query/leaf_query_parameters.h"
#include "algorithms/leaf_query/scene_queries.h"
#include "algorithms/pipeline/pipeline.h"

namespace tandem {

namespace {

const std::vector<Preset> all_presets{
    {"resident",
     "everything resident, body pairs included, one wait per frame",
     // More groups than run at once: queries take unlike times, and a group that ends makes room for another.
     {parameters::broad(Broad::device), parameters::builder(Builder::sah), parameters::work_items(8192)},
     "leaf queries"}};

constexpr std::array<const Parameter*, 2> own{&leaf_query_parameters::tree, &leaf_query_parameters::rebuild};

constexpr std::array all_counters{counters::bvtt_nodes, counters::seeds};

constexpr auto leaves = ChunkTrees::one_chunk_a_body;

class LeafQuery : public Traversal {
public:
    std::string_view name() const override { return "leaf_query"; }
    std::string_view summary() const override {
        return "the field's standard method: a binary tree per body or per scene, which each tetrahedron "
               "queries, without a stack";
    }
    std::span<const Parameter* const> parameters() const override {
        static const auto all = pipeline_parameters(own, false);
        return all;
    }
    std::span<const Preset> presets() const override { return all_presets; }
    std::span<const Counter> counters() const override { return all_counters; }

private:
    void do_check(const Settings&, const DeviceInfo&) const override {}

    std::vector<KernelCost> do_costs(const Scene& scene, const Settings& settings) const override {
        const SceneFacts s(scene, settings);
        const bool has_scene_tree = settings[leaf_query_parameters::tree] == QueriedTree::scene;
        auto costs = has_scene_tree ? scene_tree_costs(s) : chunk_tree_costs(s, leaves);
        costs.push_back(walk_cost(s, has_scene_tree ? "query_scene" : "query_leaves"));
        return costs;
    }

    AlgorithmStages do_build(const BuildContext& context) const override {
        const auto self = context.settings[parameters::self];
        if (context.settings[leaf_query_parameters::tree] == QueriedTree::scene) {
            const auto period = static_cast<std::uint32_t>(context.settings[leaf_query_parameters::rebuild]);
            auto tree = std::make_unique<SceneTree>(context.bodies, context.shape, self, period);
            auto queries = std::make_unique<SceneQueries>(*tree, context.shape);
            return {std::move(tree), std::move(queries)};
        }
        auto trees = std::make_unique<ChunkTrees>(context.bodies, leaves, context.shape.group_size);
        auto queries = std::make_unique<BodyQueries>(*trees, context.shape, self != SelfPairs::off);
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
