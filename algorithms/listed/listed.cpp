// SPDX-License-Identifier: MIT
#include "algorithms/traversal.h"

#include "algorithms/listed/listed_parameters.h"
#include "algorithms/listed/listed_walker.h"
#include "algorithms/pipeline.h"
#include "algorithms/tiled/tile_groups.h"
#include "algorithms/tiled/tiled_parameters.h"

namespace tandem {

namespace {

constexpr std::array<const Parameter*, 4> own{&listed_parameters::pad, &listed_parameters::list_capacity,
                                              &tiled_parameters::tile_pair_capacity,
                                              &tiled_parameters::most_seeds};

const std::vector<Preset> all_presets{
    {"resident",
     "everything resident, body pairs included, one wait per frame",
     {parameters::broad(Broad::device), parameters::builder(Builder::sah)}}};

constexpr std::array all_counters{counters::bvtt_nodes,           counters::seeds,
                                  tiled_counters::upper_tests,    tiled_counters::leaf_tile_pairs,
                                  listed_counters::certain_pairs, listed_counters::open_pairs,
                                  listed_counters::lists,         listed_counters::direct_walks};

/// Bounds of leaves: a list compares them along all directions.
constexpr auto leaf_slabs = Slabs::all;

class Listed : public Traversal {
public:
    std::string_view name() const override { return "listed"; }
    std::string_view summary() const override {
        return "tiled, with a list of its pairs that is kept over frames: a frame tests only pairs whose "
               "overlap may have changed, until a body has moved by more than a pad";
    }
    std::span<const Parameter* const> parameters() const override {
        static const auto all = pipeline_parameters(own, false);
        return all;
    }
    std::span<const Preset> presets() const override { return all_presets; }
    std::span<const Counter> counters() const override { return all_counters; }

private:
    void do_fit(Settings& settings, const DeviceInfo& info, const Scene*) const override {
        fit_tiles(settings, info);
    }

    void do_check(const Settings& settings, const DeviceInfo& info) const override {
        check_tile_memory(settings, leaf_slabs, info, "algorithm listed");
    }

    std::vector<KernelCost> do_costs(const Scene& scene, const Settings& settings) const override {
        const SceneFacts s(scene, settings);
        auto costs = tile_tree_costs(s, s.k, false);
        costs.push_back(upper_tiles_cost(s.k));
        costs.push_back({"measure_motion", [=](const FrameFacts&) { return 2 * s.bodies * s.pose_bytes; },
                         no_operations,
                         "reads poses of the frame and of the list; vertices of deformable bodies are not "
                         "counted"});
        costs.push_back({"decide_list", {}, {}, "nothing: a few words"});
        costs.push_back({"pad_bounds", [=](const FrameFacts&) { return s.bodies * s.dop(); }, no_operations,
                         "writes volumes of bodies; roots of tiles only in frames that walk"});
        costs.push_back({"list_leaf_tiles", {}, {}, "nothing: frames with a valid list have no work for it"});
        costs.push_back({"emit_list",
                         [=](const FrameFacts& f) {
                             return 8 * f.counted(listed_counters::certain_pairs.name)
                                    + 12 * f.counted(listed_counters::open_pairs.name)
                                    + s.pair_bytes * f.candidate_pairs;
                         },
                         [=](const FrameFacts& f) { return 2 * f.counted(listed_counters::open_pairs.name); },
                         "reads the list, writes candidate pairs; two operations per open pair"});
        return costs;
    }

    AlgorithmStages do_build(const BuildContext& context) const override {
        const auto shape = fitting_shape(context.settings, leaf_slabs, context.device.info(), context.shape);
        auto trees = std::make_unique<TileTrees>(
            context.bodies, leaf_slabs, shape.group_size,
            static_cast<std::uint64_t>(context.settings[tiled_parameters::most_seeds]));
        auto walker = std::make_unique<ListedWalker>(*trees, context, shape);
        return {std::move(trees), std::move(walker)};
    }
};

} // namespace

/// Lists of pairs that are kept over frames.
const Traversal& listed() {
    static const Listed instance;
    return instance;
}

} // namespace tandem
