// SPDX-License-Identifier: MIT
#include "algorithms/traversal.h"

#include "algorithms/chunked/chunked_walker.h"
#include "algorithms/chunked/levels.clh"
#include "algorithms/chunked/published_seeds.h"
#include "algorithms/bodies/cost.h"
#include "algorithms/pipeline/pipeline.h"
#include "base/error.h"

#include <bit>
#include <fmt/format.h>

namespace tandem {

namespace {

using namespace chunked_parameters;

constexpr std::array<const Parameter*, 8> own{&chunk_bytes, &leaves,  &seed_threshold, &seed_target,
                                              &schedule,    &descent, &root_test,      &seed_capacity};

const std::vector<Preset> all_presets{
    {"grouped",
     "work-groups share the walks of their seeds; everything resident, one wait per frame",
     {parameters::broad(Broad::device), parameters::builder(Builder::sah)},
     "grouped schedule",
     "resident"},
    {"paper",
     "each work-item walks seeds of its own, both children, threshold 10^7; everything resident",
     {parameters::broad(Broad::device), schedule(Schedule::item), descent(Descent::both),
      seed_threshold(10000000)},
     "paper's schedule",
     {},
     true},
    {"published",
     "the paper: k = 8, 8000-byte chunks, everything converted and transferred in every frame",
     {parameters::k(8), parameters::origin(Origin::world), parameters::residency(Residency::published),
      parameters::copies(TreeCopies::pair), parameters::broad(Broad::sphere_boxes), schedule(Schedule::item),
      descent(Descent::both), seed_threshold(10000000), parameters::group_size(64), root_test(false)},
     {},
     {},
     true}};

constexpr std::array all_counters{counters::bvtt_nodes, counters::seeds};

/// Tetrahedra per chunk: the setting, or as many as fit in chunk_bytes (paper, section 3.1).
std::uint32_t leaves_of(const Settings& settings) {
    const auto given = static_cast<std::uint32_t>(settings[leaves]);
    if (given == 0)
        return leaves_of_chunk_bytes(static_cast<std::uint64_t>(settings[chunk_bytes]),
                                     settings[parameters::k]);
    if (given < 2 || !std::has_single_bit(given))
        throw InputError(
            fmt::format("setting leaves={} is impossible; give a power of two from 2 to 16384, or 0", given));
    return given;
}

/// Bytes of local memory of a work-group's walk.
std::uint64_t local_bytes(Schedule kind, std::uint64_t group_size, std::uint64_t leaf_bits) {
    return kind == Schedule::group ? SHARED_ROW_COUNT(group_size, leaf_bits) * SHARED_ROW_WORDS * 4 + 12
                                   : MOST_WAITING(leaf_bits) * group_size * 4;
}

class Chunked : public Traversal {
public:
    std::string_view name() const override { return "chunked"; }
    std::string_view summary() const override {
        return "chunked static scheduler (Schmidtke and Erleben): all chunk pairs are seeds; walks are "
               "assigned to work-groups, or to work-items as in the paper, before the first one starts";
    }
    std::span<const Parameter* const> parameters() const override {
        static const auto all = pipeline_parameters(own, true);
        return all;
    }
    std::span<const Preset> presets() const override { return all_presets; }
    std::span<const Counter> counters() const override { return all_counters; }

private:
    void do_check(const Settings& settings, const DeviceInfo& info) const override {
        const auto group_size = static_cast<std::uint64_t>(settings[tandem::parameters::group_size]);
        check_local_memory(settings, info,
                           local_bytes(settings[schedule], group_size, ceil_log2(leaves_of(settings))),
                           fmt::format("schedule={}", settings.text(schedule.name)), "lower it, or leaves");
    }

    std::vector<KernelCost> do_costs(const Scene& scene, const Settings& settings) const override {
        const SceneFacts s(scene, settings);
        auto costs = chunk_tree_costs(s, leaves_of(settings));
        const auto rows = [](const FrameFacts& f) { return 16 * f.body_pairs; };
        costs.push_back(
            {"count_seeds", rows, no_operations, "reads body pairs, writes a number of seeds for each"});
        costs.push_back({"scan_seeds", rows, no_operations,
                         "reads a number for each body pair, writes a start for each"});
        for (const auto* entry : {"traverse", "traverse_in_groups"}) costs.push_back(walk_cost(s, entry));
        return costs;
    }

    AlgorithmStages do_build(const BuildContext& context) const override {
        auto trees = std::make_unique<ChunkTrees>(context.bodies, leaves_of(context.settings),
                                                  context.shape.group_size);
        std::unique_ptr<Walker> walker;
        if (context.settings[tandem::parameters::residency] == Residency::published)
            walker = std::make_unique<PublishedChunkedWalker>(*trees, context);
        else
            walker = std::make_unique<ChunkedWalker>(*trees, context);
        return {std::move(trees), std::move(walker)};
    }
};

} // namespace

/// The chunked static scheduler of the paper.
const Traversal& chunked() {
    static const Chunked instance;
    return instance;
}

} // namespace tandem
