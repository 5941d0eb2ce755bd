// SPDX-License-Identifier: MIT
#include "algorithms/tiled/tile_groups.h"

#include "algorithms/pipeline/pipeline.h"
#include "algorithms/tiled/tile_pairs.clh"
#include "algorithms/tiled/tiled_parameters.h"
#include "backends/lanes.h"

#include <algorithm>

namespace tandem {

namespace {

/// Bytes of local memory of a work-group of `teams` teams of lanes, in the kernel that needs most (tiled.cl,
/// refit_tiles.cl).
std::uint64_t local_bytes(const Settings& settings, Slabs slabs, std::uint64_t teams, bool is_warp) {
    constexpr std::uint64_t lanes = TANDEM_LANES, words = 4, points = 4 * lanes * 3;
    const auto k = static_cast<std::uint64_t>(settings[parameters::k]);
    const std::uint64_t real = settings[parameters::precision] == Precision::fp64 ? 8 : 4;
    const auto leaf_words = static_cast<std::uint64_t>(leaf_words_of(settings, slabs));
    const auto rows = [&](std::uint64_t reals) {
        return lanes * ((reals + 3) / 4 * 4 * real + words) + 4 * words;
    };
    const auto rest = k > leaf_words ? lanes * ((k - leaf_words) | 1) : 0;
    const auto pairs = (2u * PAIR_CAPACITY(is_warp) + TEAM_WORDS) * words;
    const auto leaves = rows(leaf_words) + pairs + (rest > 0 ? rest + std::max(rest, points) : 0) * real;
    const auto uppers = rows(k) + pairs;
    const auto refit = (points + (lanes + 1) * k) * real;
    return std::max(teams * std::max(leaves, uppers), teams * refit + lanes * (k | 1) * real);
}

/// Bytes of local memory of the tile kernels in groups of `group_size`. Lanes are a warp or not by compiler
/// (portable.h); if not, the group is one team.
std::uint64_t local_bytes_of_group(const Settings& settings, Slabs slabs, std::uint32_t group_size) {
    const auto one = local_bytes(settings, slabs, 1, false);
    return group_size % TANDEM_LANES == 0
               ? std::max(one, local_bytes(settings, slabs, group_size / TANDEM_LANES, true))
               : one;
}

} // namespace

double leaf_words_of(const Settings& settings, Slabs slabs) {
    const auto k = static_cast<double>(settings[parameters::k]);
    return slabs == Slabs::three ? std::min(k, 6.0) : k;
}

LaunchShape fitting_shape(const Settings& settings, Slabs slabs, const DeviceInfo& info, LaunchShape shape) {
    while (shape.group_size % 64 == 0
           && local_bytes_of_group(settings, slabs, shape.group_size) > info.local_bytes) {
        shape.group_size /= 2;
        shape.groups *= 2;
    }
    return shape;
}

void fit_tiles(Settings& settings, const DeviceInfo& info) {
    if (settings[tiled_parameters::most_seeds] == 0)
        settings.set(tiled_parameters::most_seeds(info.is_gpu ? 16384 : 256));
    // In OpenCL on a processor a group works on one tile, whatever its size: 32 lanes at most have work, and
    // only a group of one work-item lets the compiler vectorise over them.
    if (settings[parameters::group_size] == 0 && !info.is_gpu) settings.set(parameters::group_size(1));
}

void check_tile_memory(const Settings& settings, Slabs slabs, const DeviceInfo& info) {
    const auto group_size = static_cast<std::uint32_t>(settings[parameters::group_size]);
    const auto smallest = fitting_shape(settings, slabs, info, {group_size, 1}).group_size;
    check_local_memory(settings, info, local_bytes_of_group(settings, slabs, smallest), "algorithm tiled",
                       "lower it");
}

double leaf_tile_pair_bytes(const FrameFacts& facts) {
    return 4 * TILE_PAIR_WORDS * facts.counted(tiled_counters::leaf_tile_pairs.name);
}

KernelCost upper_tiles_cost(double k) {
    return {"walk_upper_tiles",
            [](const FrameFacts& f) { return 8 * f.body_pairs + leaf_tile_pair_bytes(f); },
            [k](const FrameFacts& f) { return k * f.counted(tiled_counters::upper_tests.name); },
            "reads body pairs, writes pairs of tiles of tetrahedra; k operations per tested box"};
}

} // namespace tandem
