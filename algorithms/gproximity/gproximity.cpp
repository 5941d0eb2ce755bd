// SPDX-License-Identifier: MIT
#include "algorithms/traversal.h"

#include "algorithms/gproximity/queue_walker.h"
#include "algorithms/bodies/cost.h"
#include "algorithms/pipeline/pipeline.h"
#include "algorithms/gproximity/published_queues.h"
#include "base/error.h"

#include <algorithm>
#include <bit>

namespace tandem {

namespace {

/// Leaves of one chunk over all walked tetrahedra of the largest mesh, so that each body has a plain
/// hierarchy.
std::uint32_t whole_mesh(const Scene& scene, const Settings& settings) {
    std::size_t most = 2;
    for (const auto& mesh : scene.meshes) most = std::max(most, count_walked(mesh, walked_of(settings)));
    return std::bit_ceil(static_cast<std::uint32_t>(most));
}

class Gproximity : public Traversal {
public:
    std::string_view name() const override { return "gproximity"; }
    std::string_view summary() const override {
        return "gProximity (Lauterbach, Mo and Manocha): one hierarchy per body, work queues balanced "
               "between launches";
    }
    std::span<const Parameter* const> parameters() const override {
        static const auto all = pipeline_parameters(gproximity_parameters(), true);
        return all;
    }
    std::span<const Preset> presets() const override { return gproximity_presets(); }
    std::span<const Counter> counters() const override { return queue_counters(); }

private:
    void do_fit(Settings& settings, const DeviceInfo& info, const Scene*) const override {
        fit_group_size(settings, info);
    }

    void do_check(const Settings& settings, const DeviceInfo& info) const override {
        const auto sizes = queue_sizes(settings, info);
        if (settings[tandem::parameters::broad] == Broad::device
            && (sizes.batch != 0 || sizes.upload == QueueUpload::queues))
            throw InputError(
                "setting broad=device goes with sizes=own, batch=0 and upload=seeds only: the host "
                "makes "
                "batches and queues, and needs the body pairs for them; choose broad=sphere");
    }

    std::vector<KernelCost> do_costs(const Scene& scene, const Settings& settings) const override {
        const SceneFacts s(scene, settings);
        auto costs = chunk_tree_costs(s, whole_mesh(scene, settings));
        costs.push_back({"scatter_roots", [](const FrameFacts& f) { return 12 * f.body_pairs; },
                         no_operations, "writes an item for each body pair"});
        costs.push_back(walk_cost(s, "traverse_queues"));
        costs.push_back({"plan_balance", {}, {}, "nothing: one sum over queues per launch"});
        for (const auto* entry : {"move_balance", "move_balance_serially"})
            costs.push_back({entry, {}, {}, "nothing: the number of items that move is not counted"});
        return costs;
    }

    AlgorithmStages do_build(const BuildContext& context) const override {
        auto trees = std::make_unique<ChunkTrees>(context.bodies, whole_mesh(context.scene, context.settings),
                                                  context.shape.group_size);
        std::unique_ptr<Walker> walker;
        if (context.settings[tandem::parameters::residency] == Residency::published)
            walker = std::make_unique<PublishedQueueWalker>(*trees, context);
        else
            walker = std::make_unique<QueueWalker>(*trees, context);
        return {std::move(trees), std::move(walker)};
    }
};

} // namespace

/// gProximity's dynamic load balancing, implemented from scratch, with its published numbers as presets.
const Traversal& gproximity() {
    static const Gproximity instance;
    return instance;
}

} // namespace tandem
