// SPDX-License-Identifier: MIT
#include "algorithms/chunked/chunked.h"

#include "algorithms/chunked/chunked_walker.h"
#include "algorithms/chunked/levels.clh"
#include "algorithms/published/chunked_seeds.h"
#include "algorithms/cost.h"
#include "algorithms/pipeline.h"
#include "base/error.h"

#include <bit>
#include <fmt/format.h>

namespace tandem {

namespace {

using namespace chunked_parameters;

constexpr std::array<const Parameter*, 8> own{&chunk_bytes, &leaves,  &seed_threshold, &seed_target,
                                              &schedule,    &descent, &root_test,      &seed_capacity};

const std::vector<Preset> all_presets{
    {"resident",
     "everything resident, body pairs included, one wait per frame",
     {parameters::broad(Broad::device)}},
    {"published",
     "the paper: k = 8, 8000-byte chunks, everything converted and transferred in every frame",
     {parameters::k(8), parameters::residency(Residency::published), schedule(Schedule::item),
      descent(Descent::both), seed_threshold(10000000), parameters::group_size(64), root_test(false)}}};

constexpr std::array all_counters{counters::bvtt_nodes, counters::seeds};

/// Tetrahedra of a chunk: given, or as many as its bytes hold (paper, section 3.1).
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

/// Bytes of local memory that a work-group's walk takes.
std::uint64_t local_bytes(Schedule who, std::uint64_t group_size, std::uint64_t leaf_bits) {
    return who == Schedule::group ? SHARED_ROW_COUNT(group_size, leaf_bits) * SHARED_ROW_WORDS * 4 + 12
                                  : MOST_WAITING(leaf_bits) * group_size * 4;
}

class Chunked : public Traversal {
public:
    std::string_view name() const override { return "chunked"; }
    std::string_view summary() const override {
        return "chunked static scheduler (Schmidtke and Erleben): all chunk pairs seeded, walks dealt to "
               "work-groups, or one to each work-item as in the paper, before any begins";
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
            {"count_seeds", rows, no_operations, "body pairs in, a number of seeds for each out"});
        costs.push_back(
            {"scan_seeds", rows, no_operations, "a number for each body pair in, a start for each out"});
        for (const auto* entry : {"traverse", "traverse_in_groups"}) costs.push_back(walk_cost(s, entry));
        return costs;
    }

    AlgorithmStages do_build(const BuildContext& ground) const override {
        auto trees =
            std::make_unique<ChunkTrees>(ground.bodies, leaves_of(ground.settings), ground.shape.group_size);
        std::unique_ptr<Walker> walker;
        if (ground.settings[tandem::parameters::residency] == Residency::published)
            walker = std::make_unique<PublishedChunkedWalker>(*trees, ground);
        else
            walker = std::make_unique<ChunkedWalker>(*trees, ground);
        return {std::move(trees), std::move(walker)};
    }
};

} // namespace

const Traversal& chunked() {
    static const Chunked instance;
    return instance;
}

} // namespace tandem
