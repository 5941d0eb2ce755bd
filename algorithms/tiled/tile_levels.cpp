// SPDX-License-Identifier: MIT
#include "algorithms/tiled/tile_levels.h"

#include "algorithms/kernels/sources.h"
#include "algorithms/tiled/tile_pairs.clh"
#include "algorithms/tiled/tiled_parameters.h"
#include "base/error.h"

#include <fmt/format.h>

namespace tandem {

namespace {

constexpr std::size_t row_bytes = 4 * TILE_PAIR_WORDS;

/// Body pairs of `begins` times `begins` pairs of tiles each: turns.clh counts them in a word.
std::uint32_t most_start_pairs(std::uint64_t begins) {
    return static_cast<std::uint32_t>(0xffffffffu / (begins * begins));
}

} // namespace

TileLevels::TileLevels(TileTrees& trees, const BuildContext& context, LaunchShape shape)
    : trees_(trees), shape_(shape) {
    const auto rows =
        // The level above finds the pairs of a list, so the highest level has none.
        first_rows(context.device, context.settings[tiled_parameters::tile_pair_capacity], row_bytes,
                   1.0 / 16);
    const auto lists = std::max<std::size_t>(1, trees.walked_levels() - 1);
    for (std::size_t level = 0; level < lists; ++level)
        lists_.emplace_back(context.device, "pairs of tiles", row_bytes,
                            trees.walked_levels() > 1 ? rows : 1);
    expected_.resize(trees.walked_levels());
}

Defines TileLevels::defines(const WalkBuild& build) const {
    auto defines = trees_.defines(shape_.group_size);
    build.add_to(defines);
    defines["SEVERAL_TOPS"] = trees_.begins(trees_.walked_levels() - 1) > 1 ? "1" : "0";
    return defines;
}

void TileLevels::compile(const Defines& defines) {
    compile_kernel(trees_.bodies().device(), kernel_, defines);
}

Grid TileLevels::grid(std::uint32_t level) {
    auto& [pairs, groups] = expected_[level];
    const auto teams = std::max(1u, shape_.group_size / TileShapes::lanes);
    if (!pairs) return {shape_.groups, shape_.group_size};
    const auto wanted = (*pairs + teams - 1) / teams;
    // Groups that only test roots finish early, because most roots are apart.
    std::uint64_t most =
        trees_.begins(level) > 1 ? std::max<std::uint64_t>(shape_.groups, wanted) : shape_.groups;
    // With many pairs a team, more groups than run at once: pairs take unlike times, and a group that ends
    // makes room for another.
    const std::uint64_t many = 8;
    if (trees_.bodies().device().info().is_gpu && wanted >= many * most) most *= 2;
    return {groups.groups_for(wanted, static_cast<std::uint32_t>(most)), shape_.group_size};
}

void TileLevels::expect(const Status& status) {
    const auto body_pairs = status.counter(STATUS_BODY_PAIRS);
    check_start_pairs(body_pairs); // those that the device has found
    for (std::uint32_t level = 0; level < trees_.walked_levels(); ++level) {
        const bool is_found = level + 1 < trees_.walked_levels();
        const std::uint64_t begins = trees_.begins(level);
        expected_[level].pairs =
            begins * begins * body_pairs + (is_found ? status.counter(STATUS_TILE_PAIRS + 2 * level) : 0);
    }
}

bool TileLevels::grow(const Status& status) {
    bool again = false;
    for (std::uint32_t level = 0; level + 1 < trees_.walked_levels(); ++level) {
        const auto found = status.counter(STATUS_TILE_PAIRS + 2 * level);
        if (found <= lists_[level].capacity()) continue;
        lists_[level].grow(found);
        again = true;
    }
    return again;
}

std::vector<Limit> TileLevels::limits() const {
    const std::uint64_t begins = trees_.begins(trees_.walked_levels() - 1);
    std::vector<Limit> limits;
    if (begins > 1) limits.push_back({STATUS_BODY_PAIRS, most_start_pairs(begins)});
    for (std::uint32_t level = 0; level + 1 < trees_.walked_levels(); ++level)
        limits.push_back({STATUS_TILE_PAIRS + 2 * level, lists_[level].capacity()});
    return limits;
}

void TileLevels::report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const {
    work[counters::bvtt_nodes.name] += status.counter(STATUS_BVTT_NODES);
    work[counters::seeds.name] += status.counter(STATUS_SEEDS);
    work[tiled_counters::upper_tests.name] += status.counter(STATUS_UPPER_TESTS);
    const std::uint64_t begins = trees_.begins(0);
    work[tiled_counters::leaf_tile_pairs.name] +=
        begins * begins * status.counter(STATUS_BODY_PAIRS)
        + (trees_.walked_levels() > 1 ? status.counter(STATUS_TILE_PAIRS) : 0);
}

void TileLevels::launch_level(const WalkTask& task, std::uint32_t level) {
    const kernels::tiled::WalkUpperTiles arguments{
        .uppers = trees_.uppers(),
        .first_upper = trees_.first_upper(),
        .roots = trees_.roots(),
        .tiles = trees_.tile_table(),
        .tops = trees_.tops(),
        .pairs = task.body_pairs,
        .pair_capacity = task.pair_capacity,
        .begins = trees_.begins(level),
        .level = level,
        .list = list(level).buffer(),
        .capacity = capacity(level),
        .below = list(level - 1).buffer(),
        .below_capacity = list(level - 1).capacity(),
        .marks = trees_.marks(),
        .marked = std::uint32_t{level == 1 && trees_.has_touched() ? 1u : 0u},
        .status = task.status.buffer()};
    trees_.bodies().device().launch(kernel_, grid(level), arguments);
}

void TileLevels::check_start_pairs(std::uint64_t body_pairs) const {
    const std::uint64_t begins = trees_.begins(trees_.walked_levels() - 1);
    if (begins > 1 && body_pairs > most_start_pairs(begins))
        throw InputError(fmt::format(
            "{} body pairs start with {} pairs of tiles each, and a frame numbers fewer than 2^32; "
            "lower most_seeds, or give each body pair once",
            body_pairs, begins * begins));
}

void TileLevels::launch(const WalkTask& task) {
    check_start_pairs(task.on_host.size());
    for (auto level = trees_.walked_levels(); --level > 0;) launch_level(task, level);
}

} // namespace tandem
