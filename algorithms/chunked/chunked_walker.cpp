// SPDX-License-Identifier: MIT
#include "algorithms/chunked/chunked_walker.h"

#include "algorithms/bodies/self_pairs.h"
#include "algorithms/chunked/levels.clh"
#include "algorithms/kernels/sources.h"

#include <algorithm>
#include <map>

namespace tandem {

namespace {

constexpr std::size_t seed_bytes = 12; ///< SEED_WORDS words

} // namespace

ChunkedWalker::ChunkedWalker(const ChunkTrees& trees, const BuildContext& context)
    : trees_(trees),
      shape_(context.shape),
      threshold_(context.settings[chunked_parameters::seed_threshold]),
      target_(context.settings[chunked_parameters::seed_target]),
      schedule_(context.settings[chunked_parameters::schedule]),
      descent_(context.settings[chunked_parameters::descent]),
      // Body pairs found on the device have passed the same test.
      root_test_(context.settings[chunked_parameters::root_test]
                 && context.settings[parameters::broad] != Broad::device) {
    find_top_level(context.settings[parameters::self]);
    const bool hands_down = top_level_ > 0 || context.settings[parameters::residency] == Residency::published;
    const auto seeds =
        first_rows(context.device, context.settings[chunked_parameters::seed_capacity], seed_bytes, 1.0 / 16);
    const Column column{"seeds", seed_bytes};
    handed_ = GrowableBuffer(context.device, {column, column}, hands_down ? seeds : 1);
    starts_ = GrowableBuffer(context.device, "seed starts", 8, top_level_ + 1);
}

void ChunkedWalker::do_compile(const WalkBuild& build) {
    auto defines = trees_.defines(shape_.group_size);
    define(defines, chunked_parameters::seed_threshold, threshold_);
    define(defines, chunked_parameters::seed_target, target_);
    auto of_seeds = defines;
    define(of_seeds, chunked_parameters::root_test, root_test_);
    compile_kernel(device(), count_kernel_, of_seeds);
    compile_kernel(device(), scan_kernel_, of_seeds);
    build.add_to(defines);
    define(defines, chunked_parameters::descent, descent_);
    if (is_in_groups())
        compile_kernel(device(), groups_kernel_, defines);
    else
        compile_kernel(device(), traverse_kernel_, defines);
}

std::uint32_t ChunkedWalker::wanted_level(std::uint32_t a, std::uint32_t b, std::uint64_t pair_count) const {
    const auto threshold = static_cast<std::uint64_t>(threshold_ != 0 ? threshold_ : target_)
                           / (threshold_ != 0 ? 1 : std::max<std::uint64_t>(pair_count, 1));
    const auto& levels_a = trees_.levels(a);
    const auto& levels_b = trees_.levels(b);
    const auto top = static_cast<std::uint32_t>(std::min(levels_a.size(), levels_b.size()) - 1);
    std::uint32_t level = 0;
    while (level < top && std::uint64_t{levels_a[level].chunks} * levels_b[level].chunks > threshold) ++level;
    return level;
}

std::uint32_t ChunkedWalker::seed_level(std::uint32_t a, std::uint32_t b, std::uint64_t pair_count) const {
    return std::min(wanted_level(a, b, pair_count), top_level_);
}

/// The levels that may have seeds depend only on the meshes and the number of bodies. The sequence of
/// launches is therefore fixed in advance. If a frame is given more body pairs than its bodies can form,
/// which repeat some, seeding stops at the top level all the same: no level above it is launched.
void ChunkedWalker::find_top_level(SelfPairs self) {
    const auto bodies = trees_.bodies().count();
    const auto most_pairs = most_body_pairs(trees_.bodies().scene(), self);
    std::map<const std::vector<Level>*, std::uint32_t> first_with; // one body per mesh
    for (std::uint32_t body = 0; body < bodies; ++body) first_with.emplace(&trees_.levels(body), body);
    for (const auto& [levels_a, a] : first_with)
        for (const auto& [levels_b, b] : first_with)
            top_level_ = std::max(top_level_, wanted_level(a, b, most_pairs));
}

void ChunkedWalker::reserve_starts(std::uint64_t pairs) {
    const auto rows = (pairs + 1) * (top_level_ + 1);
    if (rows > starts_.capacity()) starts_.grow(rows);
}

bool ChunkedWalker::do_grow(const Status& status) {
    std::uint64_t most = 0;
    for (std::uint32_t level = 0; level < top_level_; ++level)
        most = std::max(most, status.counter(STATUS_LEVELS + 2 * level));
    if (most <= handed_.capacity()) return false;
    handed_.grow(most);
    return true;
}

std::optional<std::vector<Limit>> ChunkedWalker::do_limits() const {
    std::vector<Limit> limits;
    for (std::uint32_t level = 0; level < top_level_; ++level)
        limits.push_back({STATUS_LEVELS + 2 * level, handed_.capacity()});
    return limits;
}

void ChunkedWalker::do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const {
    work[counters::bvtt_nodes.name] += status.counter(STATUS_BVTT_NODES);
    work[counters::seeds.name] += status.counter(STATUS_SEEDS);
}

void ChunkedWalker::make_seeds(const WalkTask& task) {
    const StageScope scope(device(), Stage::seed);
    reserve_starts(task.most_pairs());
    const auto group = shape_.group_size;
    const kernels::seeds::CountSeeds count{.volumes = trees_.volumes(),
                                           .trees = trees_.tree_table(),
                                           .levels = trees_.level_table(),
                                           .pairs = task.body_pairs,
                                           .pair_capacity = task.pair_capacity,
                                           .level_count = top_level_ + 1,
                                           .seeds = starts_.buffer(),
                                           .status = task.status.buffer()};
    const auto needed = (std::uint64_t{task.most_pairs()} + group - 1) / group;
    device().launch(count_kernel_, {std::clamp<std::uint64_t>(needed, 1, shape_.groups), group}, count);
    const kernels::seeds::ScanSeeds scan{
        .seeds = starts_.buffer(), .pair_capacity = task.pair_capacity, .status = task.status.buffer()};
    device().launch(scan_kernel_, {top_level_ + 1, group}, scan);
}

void ChunkedWalker::traverse(const WalkTask& task, std::uint32_t level, std::uint32_t pair_capacity) {
    const StageScope scope(device(), Stage::traverse);
    const auto& bodies = trees_.bodies();
    const auto launch = [&]<class Arguments>(const KernelOf<Arguments>& kernel) {
        device().launch(kernel, {shape_.groups, shape_.group_size},
                        Arguments{.nodes = trees_.nodes(),
                                  .trees = trees_.tree_table(),
                                  .levels = trees_.level_table(),
                                  .bodies = bodies.row_table(),
                                  .ids = bodies.ids(),
                                  .tetrahedra = bodies.topology(),
                                  .pairs = task.body_pairs,
                                  .pair_capacity = pair_capacity,
                                  .level = level,
                                  .seeds = starts_.buffer(),
                                  .handed = handed(level),
                                  .handed_capacity = handed_.capacity(),
                                  .below = handed(level + 1),
                                  .below_capacity = handed_.capacity(),
                                  .found = task.answer.pairs.buffer(),
                                  .capacity = task.answer.pairs.capacity(),
                                  .status = task.status.buffer()});
    };
    if (is_in_groups())
        launch(groups_kernel_);
    else
        launch(traverse_kernel_);
}

void ChunkedWalker::do_launch(const WalkTask& task) {
    make_seeds(task);
    for (std::uint32_t level = top_level_ + 1; level-- > 0;) traverse(task, level, task.pair_capacity);
}

} // namespace tandem
