// SPDX-License-Identifier: MIT
#include "algorithms/listed/listed_walker.h"

#include "algorithms/listed/list_state.clh"
#include "algorithms/listed/listed_parameters.h"
#include "algorithms/parameters/table.h"
#include "algorithms/sources.h"
#include "algorithms/tiled/tile_pairs.clh"

#include <algorithm>
#include <utility>

namespace tandem {

namespace {

std::vector<Column> open_columns() { return {{"open pairs", 8}, {"directions of open pairs", 4}}; }

std::uint64_t first_pairs(const BuildContext& context, std::size_t row_bytes) {
    return first_rows(context.device, context.settings[listed_parameters::list_capacity], row_bytes,
                      1.0 / 16);
}

} // namespace

ListedWalker::ListedWalker(TileTrees& trees, const BuildContext& context, LaunchShape shape)
    : trees_(trees),
      bodies_(trees.bodies()),
      device_(context.device),
      levels_(trees, context, shape),
      motion_(trees, shape, context.settings[listed_parameters::pad]),
      search_(bodies_, motion_.volumes(), shape, context.settings[parameters::self]),
      body_pairs_(context.device, "body pairs of a list", sizeof(BodyPair),
                  std::clamp<std::uint64_t>(
                      search_.most_pairs(), 1,
                      static_cast<std::uint64_t>(context.settings[parameters::body_pair_capacity]))),
      certain_(context.device, "certain pairs", 8, first_pairs(context, 8)),
      open_(context.device, open_columns(), first_pairs(context, 12)) {}

void ListedWalker::do_compile(const WalkBuild& build) {
    is_windowed_ = build.windowed;
    auto defines = levels_.defines(build);
    auto upper_defines = defines;
    // The upper levels do not depend on leaves. The host device has them for more levels of processors with
    // the default of tiled; a compiler also compiles the leaves, which may then need too much local memory.
    if (device_.info().id == "host") define(upper_defines, parameters::slabs, Slabs::three);
    levels_.compile(upper_defines);
    motion_.compile(build.output);
    defines.erase(std::string(parameters::slabs.define)); // listed.cl has bounds along all directions
    const auto& source = kernel_source("algorithms/listed/listed.cl");
    leaf_kernel_ = device_.compile(source, "list_leaf_tiles", defines);
    answer_kernel_ = device_.compile(source, "emit_list", defines);
}

void ListedWalker::do_reset() {
    is_known_ = false;
    has_memory_ = true;
}

/// Whether the list, if any, is of other body pairs than the task. Those of the task become the list's.
bool ListedWalker::has_other_pairs(const WalkTask& task) {
    const bool same =
        task.complete == is_complete_ && (task.complete || std::ranges::equal(given_, task.on_host));
    if (same) return false;
    is_complete_ = task.complete;
    given_.clear();
    if (!task.complete) given_.assign(task.on_host.begin(), task.on_host.end());
    return true;
}

/// What the host asks of the device. A list cannot be kept when its body pairs or the tetrahedra that take
/// part have changed. Its pad bounds the motion of one frame's positions, not of two.
std::uint32_t ListedWalker::request_of(const WalkTask& task) {
    const bool is_new = refits_ != trees_.refits();
    const bool other = has_other_pairs(task) || changes_ != trees_.changes();
    refits_ = trees_.refits();
    changes_ = trees_.changes();
    const bool bounds_motion = bodies_.geometry().motion == Motion::linear;
    if (other || is_windowed_ || !has_memory_ || bounds_motion) return REQUEST_DIRECT;
    if (is_new) return is_known_ ? REQUEST_DECIDE : REQUEST_DIRECT;
    return is_known_ ? REQUEST_EMIT : REQUEST_REPEAT;
}

/// Gives the search an order of bodies, and the subdomain.
void ListedWalker::update_search() {
    if (trees_.subdomain() && subdomain_ != trees_.changes()) {
        search_.set_subdomain(*trees_.subdomain());
        subdomain_ = trees_.changes();
        is_sorted_ = true;
    }
    if (!is_sorted_) search_.sort_by_volumes();
    is_sorted_ = true;
}

void ListedWalker::do_launch(const WalkTask& task) {
    levels_.check_start_pairs(task.on_host.size());
    const auto request = request_of(task);
    const bool is_direct = request == REQUEST_DIRECT;
    is_known_ = false;
    is_launched_ = true;
    searches_ = task.complete && !is_direct && (searches_ || request == REQUEST_DECIDE);
    const StageScope scope(device_, Stage::traverse);
    motion_.decide(request, !searches_, task.status.buffer());
    motion_.pad_bounds();
    if (searches_) {
        update_search();
        search_.launch(body_pairs_.buffer(), body_pairs_.capacity(), motion_.walked());
    }
    const auto& body_pairs = searches_ ? body_pairs_.buffer() : task.body_pairs;
    const auto pair_capacity = searches_ ? body_pairs_.capacity() : task.pair_capacity;
    levels_.launch({motion_.uppers(), motion_.roots(), body_pairs, pair_capacity, motion_.walked()});
    launch_leaves(task, body_pairs, pair_capacity);
    launch_answer(task);
}

void ListedWalker::launch_leaves(const WalkTask& task, const Buffer& body_pairs,
                                 std::uint32_t pair_capacity) {
    const std::array<Argument, 23> arguments{trees_.leaves(),
                                             motion_.roots(),
                                             trees_.tile_table(),
                                             trees_.tops(),
                                             body_pairs,
                                             pair_capacity,
                                             trees_.begins(0),
                                             levels_.list(0).buffer(),
                                             levels_.capacity(0),
                                             bodies_.row_table(),
                                             bodies_.ids(),
                                             bodies_.topology(),
                                             task.answer.pairs.buffer(),
                                             task.answer.pairs.capacity(),
                                             certain_.buffer(),
                                             certain_.capacity(),
                                             open_.buffer(0),
                                             open_.buffer(1),
                                             open_.capacity(),
                                             motion_.pads(),
                                             motion_.state(),
                                             motion_.walked(),
                                             task.status.buffer()};
    device_.launch(leaf_kernel_, levels_.grid(0), arguments);
}

Grid ListedWalker::answer_grid() {
    const auto shape = levels_.shape();
    const auto teams = std::max(1u, shape.group_size / TileShapes::lanes);
    const auto most = static_cast<std::uint32_t>(std::min<std::uint64_t>(shape.groups, 0xffffffffu));
    return {groups_.groups_for((rows_ + teams - 1) / teams, most), shape.group_size};
}

void ListedWalker::launch_answer(const WalkTask& task) {
    const std::array<Argument, 21> arguments{certain_.buffer(),
                                             certain_.capacity(),
                                             open_.buffer(0),
                                             open_.buffer(1),
                                             open_.capacity(),
                                             trees_.leaves(),
                                             trees_.tile_table(),
                                             bodies_.row_table(),
                                             bodies_.ids(),
                                             task.answer.pairs.buffer(),
                                             task.answer.pairs.capacity(),
                                             bodies_.poses(),
                                             motion_.saved_poses(),
                                             motion_.pose_rows(),
                                             bodies_.vertices(),
                                             motion_.saved_vertices(),
                                             motion_.first_vertex(),
                                             motion_.vertex_rows(),
                                             motion_.state(),
                                             motion_.walked(),
                                             task.status.buffer()};
    device_.launch(answer_kernel_, answer_grid(), arguments);
}

/// Frees the memory of lists, for the answer.
void ListedWalker::drop_lists() {
    has_memory_ = false;
    certain_ = {};
    open_ = {};
    certain_ = {device_, "certain pairs", 8, 1};
    open_ = {device_, open_columns(), 1};
}

/// Grows the lists that the last run overflowed; returns whether there is one. Frames go on without a list if
/// memory does not suffice.
bool ListedWalker::grow_lists(const Status& status) {
    const auto certain = status.counter(STATUS_CERTAIN), open = status.counter(STATUS_OPEN);
    if (certain <= certain_.capacity() && open <= open_.capacity()) return false;
    try {
        if (certain > certain_.capacity()) certain_.grow(certain);
        if (open > open_.capacity()) open_.grow(open);
    } catch (const OutOfMemory&) {
        drop_lists();
    }
    return true;
}

bool ListedWalker::do_grow(const Status& status) {
    if (!std::exchange(is_launched_, false)) return false; // a frame without body pairs
    const auto run = status.words()[STATUS_RUN];
    if (run != FRAME_DIRECT) {
        constexpr std::uint64_t blocks_of_team = 8;
        rows_ = (status.counter(STATUS_CERTAIN) / 256 + status.counter(STATUS_OPEN) / TileShapes::lanes)
                / blocks_of_team;
    }
    if (run == FRAME_KEPT) {
        is_known_ = true;
        return false;
    }
    const auto body_pairs = status.counter(STATUS_LIST_BODY_PAIRS);
    levels_.expect(status, body_pairs);
    bool again = levels_.grow(status);
    if (searches_ && body_pairs > body_pairs_.capacity()) {
        body_pairs_.grow(body_pairs);
        again = true;
    }
    if (run == FRAME_LIST) again |= grow_lists(status);
    // A frame without a list repeats its walk in every run. One with a list must not take it as complete.
    is_known_ = run == FRAME_DIRECT || !again;
    return again;
}

void ListedWalker::do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const {
    const auto run = status.words()[STATUS_RUN];
    levels_.report(status, status.counter(STATUS_LIST_BODY_PAIRS), work);
    const bool has_list = run != FRAME_DIRECT;
    work[listed_counters::certain_pairs.name] += has_list ? status.counter(STATUS_CERTAIN) : 0;
    work[listed_counters::open_pairs.name] += has_list ? status.counter(STATUS_OPEN) : 0;
    work[listed_counters::lists.name] += run == FRAME_LIST ? 1 : 0;
    work[listed_counters::direct_walks.name] += run == FRAME_DIRECT ? 1 : 0;
}

} // namespace tandem
