// SPDX-License-Identifier: MIT
#include "algorithms/tiled/tiled_walker.h"

#include "algorithms/sources.h"
#include "algorithms/tiled/tile_pairs.clh"
#include "base/error.h"

namespace tandem {

namespace {

constexpr std::size_t row_bytes = 4 * TILE_PAIR_WORDS;

} // namespace

TiledWalker::TiledWalker(TileTrees& trees, const BuildContext& context, LaunchShape shape)
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

void TiledWalker::do_compile(const WalkBuild& build) {
    auto defines = trees_.defines(shape_.group_size);
    build.add_to(defines);
    defines["SEVERAL_TOPS"] = trees_.begins(trees_.walked_levels() - 1) > 1 ? "1" : "0";
    auto& device = trees_.bodies().device();
    const auto& source = kernel_source("algorithms/tiled/tiled.cl");
    upper_kernel_ = device.compile(source, "walk_upper_tiles", defines);
    leaf_kernel_ = device.compile(source, "walk_leaf_tiles", defines);
}

Grid TiledWalker::grid(std::uint32_t level) {
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

bool TiledWalker::do_grow(const Status& status) {
    bool again = false;
    for (std::uint32_t level = 0; level < trees_.walked_levels(); ++level) {
        const bool is_found = level + 1 < trees_.walked_levels();
        const std::uint64_t begins = trees_.begins(level);
        expected_[level].pairs = begins * begins * status.counter(STATUS_BODY_PAIRS)
                                 + (is_found ? status.counter(STATUS_TILE_PAIRS + 2 * level) : 0);
    }
    trees_.expect_tile_pairs(*expected_[0].pairs);
    for (std::uint32_t level = 0; level + 1 < trees_.walked_levels(); ++level) {
        const auto found = status.counter(STATUS_TILE_PAIRS + 2 * level);
        if (found <= lists_[level].capacity()) continue;
        lists_[level].grow(found);
        again = true;
    }
    return again;
}

void TiledWalker::do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const {
    work[counters::bvtt_nodes.name] += status.counter(STATUS_BVTT_NODES);
    work[counters::seeds.name] += status.counter(STATUS_SEEDS);
    work[tiled_counters::upper_tests.name] += status.counter(STATUS_UPPER_TESTS);
    const std::uint64_t begins = trees_.begins(0);
    work[tiled_counters::leaf_tile_pairs.name] +=
        begins * begins * status.counter(STATUS_BODY_PAIRS)
        + (trees_.walked_levels() > 1 ? status.counter(STATUS_TILE_PAIRS) : 0);
}

void TiledWalker::launch_upper(const WalkTask& task, std::uint32_t level) {
    const std::array<Argument, 16> arguments{trees_.uppers(),
                                             trees_.first_upper(),
                                             trees_.roots(),
                                             trees_.tile_table(),
                                             trees_.tops(),
                                             task.body_pairs,
                                             task.pair_capacity,
                                             trees_.begins(level),
                                             level,
                                             list(level).buffer(),
                                             level + 1 < trees_.walked_levels() ? list(level).capacity() : 0,
                                             list(level - 1).buffer(),
                                             list(level - 1).capacity(),
                                             trees_.marks(),
                                             std::uint32_t{level == 1 && trees_.has_touched() ? 1u : 0u},
                                             task.status.buffer()};
    trees_.bodies().device().launch(upper_kernel_, grid(level), arguments);
}

void TiledWalker::launch_leaves(const WalkTask& task) {
    const auto& bodies = trees_.bodies();
    const auto& shapes = trees_.shapes();
    const std::array<Argument, 20> arguments{trees_.leaves(),
                                             trees_.roots(),
                                             trees_.tile_table(),
                                             trees_.tops(),
                                             task.body_pairs,
                                             task.pair_capacity,
                                             trees_.begins(0),
                                             list(0).buffer(),
                                             trees_.walked_levels() > 1 ? list(0).capacity() : 0,
                                             shapes.starts(),
                                             shapes.vertex_numbers(),
                                             shapes.corners(),
                                             bodies.row_table(),
                                             bodies.poses(),
                                             bodies.vertices(),
                                             bodies.ids(),
                                             bodies.tetrahedra(),
                                             task.answer.pairs.buffer(),
                                             task.answer.pairs.capacity(),
                                             task.status.buffer()};
    bodies.device().launch(leaf_kernel_, grid(0), arguments);
}

void TiledWalker::do_launch(const WalkTask& task) {
    const std::uint64_t begins = trees_.begins(trees_.walked_levels() - 1);
    if (begins > 1 && begins * begins * task.on_host.size() > 0xffffffffu) // turns.clh counts them in a word
        throw InputError(
            "body pairs given more than once make more than 2^32 initial pairs of tiles; lower most_seeds");
    const StageScope scope(trees_.bodies().device(), Stage::traverse);
    for (auto level = trees_.walked_levels(); --level > 0;) launch_upper(task, level);
    if (trees_.has_touched()) trees_.bound_touched();
    launch_leaves(task);
}

} // namespace tandem
