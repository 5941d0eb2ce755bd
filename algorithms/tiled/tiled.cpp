// SPDX-License-Identifier: MIT
#include "algorithms/traversal.h"

#include "algorithms/cost.h"
#include "algorithms/pipeline.h"
#include "algorithms/tiled/tile_pairs.clh"
#include "algorithms/tiled/tiled_walker.h"
#include "backends/lanes.h"
#include "base/error.h"

#include <algorithm>

namespace tandem {

namespace {

constexpr std::array<const Parameter*, 3> own{&parameters::slabs, &tiled_parameters::tile_pair_capacity,
                                              &tiled_parameters::most_seeds};

const std::vector<Preset> all_presets{
    {"resident",
     "everything resident, body pairs included, one wait per frame",
     {parameters::broad(Broad::device), parameters::builder(Builder::sah)}}};

constexpr std::array all_counters{counters::bvtt_nodes, counters::seeds, tiled_counters::upper_tests,
                                  tiled_counters::leaf_tile_pairs};

/// Bytes of local memory of a work-group of `teams` teams of lanes, in the kernel that needs most (tiled.cl,
/// refit_tiles.cl).
std::uint64_t local_bytes(const Settings& settings, std::uint64_t teams, bool is_warp) {
    constexpr std::uint64_t lanes = TANDEM_LANES, words = 4, points = 4 * lanes * 3;
    const auto k = static_cast<std::uint64_t>(settings[parameters::k]);
    const std::uint64_t real = settings[parameters::precision] == Precision::fp64 ? 8 : 4;
    const auto leaf_words = settings[parameters::slabs] == Slabs::three ? std::min<std::uint64_t>(k, 6) : k;
    const auto rows = [&](std::uint64_t reals) {
        return lanes * ((reals + 3) / 4 * 4 * real + words) + 4 * words;
    };
    const auto rest = k > leaf_words ? lanes * ((k - leaf_words) | 1) : 0;
    const auto pairs = (2u * PAIR_CAPACITY(is_warp) + 6) * words;
    const auto leaves = rows(leaf_words) + pairs + (rest > 0 ? rest + std::max(rest, points) : 0) * real;
    const auto uppers = rows(k) + pairs;
    const auto refit = (points + (lanes + 1) * k) * real;
    return std::max(teams * std::max(leaves, uppers), teams * refit + lanes * (k | 1) * real);
}

/// Bytes of local memory of the tile kernels in groups of `group_size`. Lanes are a warp or not by compiler
/// (portable.h); if not, the group is one team.
std::uint64_t local_bytes_of_group(const Settings& settings, std::uint32_t group_size) {
    const auto one = local_bytes(settings, 1, false);
    return group_size % TANDEM_LANES == 0
               ? std::max(one, local_bytes(settings, group_size / TANDEM_LANES, true))
               : one;
}

/// Ends of slabs in the bounds of a tetrahedron.
double leaf_words_of(const Settings& settings) {
    const auto k = static_cast<double>(settings[parameters::k]);
    return settings[parameters::slabs] == Slabs::three ? std::min(k, 6.0) : k;
}

/// Groups of the tile kernels: as large as the setting and local memory allow. Doubles with many directions
/// need more than 48 KiB in groups of 128.
LaunchShape fitting_shape(const Settings& settings, const DeviceInfo& info, LaunchShape shape) {
    while (shape.group_size % 64 == 0
           && local_bytes_of_group(settings, shape.group_size) > info.local_bytes) {
        shape.group_size /= 2;
        shape.groups *= 2;
    }
    return shape;
}

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
    /// Bounds along all directions on a GPU, unless they take a quarter of its memory.
    static Slabs slabs_of_large_k(const Settings& settings, const DeviceInfo& info, const Scene& scene) {
        const double real = settings[tandem::parameters::precision] == Precision::fp64 ? 8 : 4;
        const auto bytes = static_cast<double>(count_walked(scene, walked_of(settings)))
                           * static_cast<double>(settings[tandem::parameters::k]) * real;
        const bool are_swept = settings[tandem::parameters::motion] == Motion::linear;
        return bytes > static_cast<double>(info.global_bytes) / 4 && !are_swept ? Slabs::three
                                                                                : Slabs::touched;
    }

    void do_fit(Settings& settings, const DeviceInfo& info, const Scene* scene) const override {
        if (settings[tiled_parameters::most_seeds] == 0)
            settings.set(tiled_parameters::most_seeds(info.is_gpu ? 16384 : 256));
        // In OpenCL on a processor a group works on one tile, whatever its size: 32 lanes at most have work,
        // and only a group of one work-item lets the compiler vectorise over them.
        if (settings[tandem::parameters::group_size] == 0 && !info.is_gpu)
            settings.set(tandem::parameters::group_size(1));
        if (settings[tandem::parameters::slabs] != Slabs::usual) return;
        const bool needs_scene = info.is_gpu && settings[tandem::parameters::k] > 12;
        if (needs_scene && scene == nullptr) return;
        // Slabs that the walk makes from vertices are of one frame.
        const bool stores_all = info.is_gpu || settings[tandem::parameters::motion] == Motion::linear;
        const auto chosen = needs_scene  ? slabs_of_large_k(settings, info, *scene)
                            : stores_all ? Slabs::all
                                         : Slabs::three;
        settings.set(tandem::parameters::slabs(chosen));
    }

    void do_check(const Settings& settings, const DeviceInfo& info) const override {
        if (settings[tandem::parameters::motion] == Motion::linear
            && settings[tandem::parameters::slabs] == Slabs::three)
            throw InputError("setting slabs=three makes slabs from the vertices of one frame, and "
                             "motion=linear needs those of two; choose slabs=all");
        const auto group_size = static_cast<std::uint32_t>(settings[tandem::parameters::group_size]);
        const auto smallest = fitting_shape(settings, info, {group_size, 1}).group_size;
        check_local_memory(settings, info, local_bytes_of_group(settings, smallest), "algorithm tiled",
                           "lower it");
    }

    std::vector<KernelCost> do_costs(const Scene& scene, const Settings& settings) const override {
        const SceneFacts s(scene, settings);
        const auto words = leaf_words_of(settings);
        auto costs = tile_tree_costs(s, words, settings[tandem::parameters::slabs] == Slabs::touched);
        const auto upper = [](const FrameFacts& f) { return f.counted(tiled_counters::upper_tests.name); };
        const auto pairs = [](const FrameFacts& f) {
            return 4 * TILE_PAIR_WORDS * f.counted(tiled_counters::leaf_tile_pairs.name);
        };
        costs.push_back(
            {"walk_upper_tiles", [=](const FrameFacts& f) { return 8 * f.body_pairs + pairs(f); },
             [=](const FrameFacts& f) { return s.k * upper(f); },
             "reads body pairs, writes pairs of tiles of tetrahedra; k operations per tested box"});
        costs.push_back(
            {"walk_leaf_tiles",
             [=](const FrameFacts& f) {
                 return pairs(f) + words * s.real * f.touched + s.pair_bytes * f.candidate_pairs;
             },
             [=](const FrameFacts& f) {
                 return words * (f.counted(counters::bvtt_nodes.name) - upper(f))
                        + (s.k - words) * f.candidate_pairs;
             },
             "reads pairs of tiles and bounds of tetrahedra in candidate pairs, writes candidate pairs; an "
             "operation per tested box and end of a leaf, the rest of k per candidate pair"});
        return costs;
    }

    AlgorithmStages do_build(const BuildContext& context) const override {
        const auto shape = fitting_shape(context.settings, context.device.info(), context.shape);
        auto trees = std::make_unique<TileTrees>(
            context.bodies, context.settings[tandem::parameters::slabs], shape.group_size,
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
