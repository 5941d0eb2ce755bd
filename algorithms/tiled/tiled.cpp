// SPDX-License-Identifier: MIT
#include "algorithms/traversal.h"

#include "algorithms/bodies/cost.h"
#include "algorithms/pipeline/pipeline.h"
#include "algorithms/tiled/tile_groups.h"
#include "algorithms/tiled/tiled_parameters.h"
#include "algorithms/tiled/tiled_walker.h"
#include "base/error.h"

#include <algorithm>

namespace tandem {

namespace {

constexpr std::array<const Parameter*, 3> own{&parameters::slabs, &tiled_parameters::tile_pair_capacity,
                                              &tiled_parameters::most_seeds};

const std::vector<Preset> all_presets{{"resident",
                                       "everything resident, body pairs included, one wait per frame",
                                       {parameters::broad(Broad::device), parameters::builder(Builder::sah)},
                                       "tiled"}};

constexpr std::array all_counters{counters::bvtt_nodes, counters::seeds, tiled_counters::upper_tests,
                                  tiled_counters::leaf_tile_pairs};

class Tiled : public Traversal {
public:
    std::string_view name() const override { return "tiled"; }
    std::string_view summary() const override {
        return "tiles of 32 boxes tested against 32 at once, from the top of each body's tree to its "
               "tetrahedra, without a stack";
    }
    std::span<const Parameter* const> parameters() const override {
        static const auto all = pipeline_parameters(own, false);
        return all;
    }
    std::span<const Preset> presets() const override { return all_presets; }
    std::span<const Counter> counters() const override { return all_counters; }

private:
    /// Bounds along all directions, of the tiles that the walk touches; three where all would take a quarter
    /// of the device's memory.
    static Slabs slabs_of_large_k(const Settings& settings, const DeviceInfo& info, const Scene& scene) {
        const double real = settings[tandem::parameters::precision] == Precision::fp64 ? 8 : 4;
        const auto bytes = static_cast<double>(count_walked(scene, walked_of(settings)))
                           * static_cast<double>(settings[tandem::parameters::k]) * real;
        // Slabs that the walk makes from vertices are of one frame.
        const bool are_swept = settings[tandem::parameters::motion] == Motion::linear;
        return bytes > static_cast<double>(info.global_bytes) / 4 && !are_swept ? Slabs::three
                                                                                : Slabs::touched;
    }

    void do_fit(Settings& settings, const DeviceInfo& info, const Scene* scene) const override {
        fit_tiles(settings, info);
        if (settings[tandem::parameters::slabs] != Slabs::usual) return;
        const bool is_large = settings[tandem::parameters::k] > 12;
        if (is_large && scene == nullptr) return;
        const auto chosen = is_large ? slabs_of_large_k(settings, info, *scene) : Slabs::all;
        settings.set(tandem::parameters::slabs(chosen));
    }

    void do_check(const Settings& settings, const DeviceInfo& info) const override {
        if (settings[tandem::parameters::motion] == Motion::linear
            && settings[tandem::parameters::slabs] == Slabs::three)
            throw InputError("setting slabs=three makes slabs from the vertices of one frame, and "
                             "motion=linear needs those of two; choose slabs=all");
        check_tile_memory(settings, settings[tandem::parameters::slabs], info);
    }

    std::vector<KernelCost> do_costs(const Scene& scene, const Settings& settings) const override {
        const SceneFacts s(scene, settings);
        const auto slabs = settings[tandem::parameters::slabs];
        const auto words = leaf_words_of(settings, slabs);
        const bool is_self = settings[tandem::parameters::self] != SelfPairs::off;
        const auto tested = is_self ? std::min(words, 6.0) : words; // TESTED_DIRECTIONS of tiled.cl
        auto costs = tile_tree_costs(s, words, slabs == Slabs::touched);
        const auto upper = [](const FrameFacts& f) { return f.counted(tiled_counters::upper_tests.name); };
        costs.push_back(upper_tiles_cost(s.k));
        costs.push_back(
            {"walk_leaf_tiles",
             [=](const FrameFacts& f) {
                 return leaf_tile_pair_bytes(f) + words * s.real * f.touched
                        + s.pair_bytes * f.candidate_pairs;
             },
             [=](const FrameFacts& f) {
                 return tested * (f.counted(counters::bvtt_nodes.name) - upper(f))
                        + (s.k - tested) * f.candidate_pairs;
             },
             "reads pairs of tiles and bounds of tetrahedra in candidate pairs, writes candidate pairs; an "
             "operation per tested box and end of a leaf, the rest of k per candidate pair"});
        return costs;
    }

    AlgorithmStages do_build(const BuildContext& context) const override {
        const auto slabs = context.settings[tandem::parameters::slabs];
        const auto shape = fitting_shape(context.settings, slabs, context.device.info(), context.shape);
        auto trees = std::make_unique<TileTrees>(
            context.bodies, slabs, context.settings[tandem::parameters::self], shape.group_size,
            static_cast<std::uint64_t>(context.settings[tiled_parameters::most_seeds]));
        auto walker = std::make_unique<TiledWalker>(*trees, context, shape);
        return {std::move(trees), std::move(walker)};
    }
};

} // namespace

/// Tiles of boxes against tiles: the paper's chunks without inner trees.
const Traversal& tiled() {
    static const Tiled instance;
    return instance;
}

} // namespace tandem
