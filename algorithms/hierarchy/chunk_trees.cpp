// SPDX-License-Identifier: MIT
#include "algorithms/hierarchy/chunk_trees.h"

#include "algorithms/orders/heap.h"
#include "algorithms/kernels/sources.h"
#include "backends/upload.h"

#include <algorithm>
#include <limits>

namespace tandem {

namespace {

constexpr std::uint32_t level_words = 4;
constexpr std::uint32_t level_bits = 5; ///< TREE_LEVEL_BITS of node.clh
constexpr std::uint32_t job_words = 8;
constexpr std::uint32_t most_top_items = 1024; ///< largest level that one work-group refits

/// Number of groups, rounded up.
std::uint64_t groups_for(std::uint64_t items, std::uint64_t per_group) {
    return (items + per_group - 1) / per_group;
}

} // namespace

ChunkTrees::ChunkTrees(const Bodies& bodies, std::uint32_t leaves, std::uint32_t group_size)
    : bodies_(bodies),
      device_(bodies.device()),
      leaves_(leaves),
      group_size_(group_size),
      shape_(refit_shape(bodies.geometry(), group_size)) {
    for (std::size_t mesh = 0; mesh < bodies.scene().meshes.size(); ++mesh) {
        const auto tetrahedra = static_cast<std::uint32_t>(bodies.ordered_mesh(mesh).ids.size());
        mesh_levels_.push_back(chunk_levels(tetrahedra, leaves));
    }
    lay_out();
    plan_strips();
    compile_kernel(device_, strips_kernel_, refit_defines());
    compile_kernel(device_, tops_kernel_, refit_defines());
    upload_static();
}

Defines ChunkTrees::defines(std::uint32_t group_size) const {
    auto defines = geometry_defines(bodies_.geometry(), group_size);
    defines["LEAF_BITS"] = std::to_string(ceil_log2(leaves_));
    return defines;
}

Defines ChunkTrees::refit_defines() const {
    auto own = defines(shape_.group_size);
    own["TILE_NODES"] = std::to_string(shape_.tile_nodes);
    return own;
}

/// Fills the rows of levels by mesh and the rows of trees by body.
void ChunkTrees::lay_out() {
    std::vector<std::uint32_t> first_level;
    for (const auto& levels : mesh_levels_) {
        first_level.push_back(static_cast<std::uint32_t>(level_rows_.size() / level_words));
        for (const auto& level : levels)
            level_rows_.insert(level_rows_.end(), {level.slot, level.items, level.chunks, 0});
    }
    for (std::uint32_t body = 0; body < bodies_.count(); ++body) {
        trees_.push_back({static_cast<std::uint32_t>(slots_), first_level[bodies_.scene().bodies[body].mesh],
                          static_cast<std::uint32_t>(levels(body).size())
                              | bodies_.first_slot(body) / Bodies::block_slots << level_bits,
                          bodies_.row(body).tetrahedron_count});
        slots_ += slot_count(levels(body));
    }
    if (slots_ > std::numeric_limits<std::uint32_t>::max())
        throw DeviceError("scene: more than 2^32 nodes; leave bodies out");
}

/// Plans each level from its deepest nodes up, in strips of at most strip_height + 1 depths. refit_tops
/// refits the small levels above.
void ChunkTrees::plan_strips() {
    const auto is_small = [&](const std::vector<Level>& levels) {
        return first_top_level_ >= levels.size() || levels[first_top_level_].items <= most_top_items;
    };
    while (!std::all_of(mesh_levels_.begin(), mesh_levels_.end(), is_small)) ++first_top_level_;
    for (std::uint32_t level = 0; level < first_top_level_; ++level) {
        std::uint32_t deepest = 0;
        for (const auto& levels : mesh_levels_)
            if (level < levels.size() && levels[level].items > 0)
                deepest = std::max(deepest, ceil_log2(std::min(levels[level].items, leaves_)));
        for (std::uint32_t bottom = deepest;;) {
            const auto top = bottom > strip_height ? bottom - strip_height : 0;
            strips_.push_back(
                {level, bottom - top, static_cast<std::uint32_t>(jobs_.size() / job_words), 0, 0});
            plan_strip(level, false, top);
            strips_.back().dynamic_jobs = strips_.back().jobs;
            plan_strip(level, true, top);
            if (top == 0) break;
            bottom = top - 1;
        }
    }
}

/// Adds a job row for each subtree whose root is at depth `top` of a chunk. `fixed` selects fixed or moving
/// bodies.
void ChunkTrees::plan_strip(std::uint32_t level, bool fixed, std::uint32_t top) {
    const auto& scene = bodies_.scene();
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body) {
        const auto& levels = this->levels(body);
        if (scene.bodies[body].fixed != fixed || level >= levels.size() || !is_active(body)) continue;
        const auto& row = bodies_.row(body);
        for (std::uint32_t chunk = 0; chunk < levels[level].chunks; ++chunk) {
            const auto first = chunk * leaves_;
            const auto items = std::min(leaves_, levels[level].items - first);
            const auto base = trees_[body].nodes + levels[level].slot + heap::heap_slots(first);
            const auto top_node = heap::first_below(heap::root_node, top);
            for (auto root = top_node; root < std::min(2 * top_node, heap::heap_slots(items)); ++root) {
                jobs_.insert(jobs_.end(),
                             {base, items, root, body, first, row.tetrahedra, row.vertices, row.flags});
                ++strips_.back().jobs;
            }
        }
    }
}

/// Uploads the tables that do not change between frames.
void ChunkTrees::upload_static() {
    tree_table_ = uploaded(device_, bytes_of(trees_), "trees");
    level_table_ = uploaded(device_, bytes_of(level_rows_), "levels");
    upload_jobs();
    const auto node =
        static_cast<std::uint64_t>(ends_of_node(bodies_.geometry())) * real_bytes(bodies_.geometry());
    nodes_ = device_.allocate(slots_ * node, "nodes");
    volumes_ = device_.allocate(bodies_.count() * node, "volumes");
}

/// Moving bodies come first, so that a refit of only these is a shorter launch.
void ChunkTrees::upload_jobs() {
    if (jobs_.empty()) jobs_.resize(job_words); // buffers cannot be empty
    job_table_ = uploaded(device_, bytes_of(jobs_), "refit jobs");
    std::vector<std::uint32_t> order;
    for (std::uint32_t body = 0; body < bodies_.count(); ++body)
        if (is_active(body)) order.push_back(body);
    const auto moving = [&](std::uint32_t body) { return !bodies_.scene().bodies[body].fixed; };
    ordered_bodies_ = static_cast<std::uint32_t>(order.size());
    moving_bodies_ =
        static_cast<std::uint32_t>(std::stable_partition(order.begin(), order.end(), moving) - order.begin());
    if (order.empty()) order.emplace_back();
    body_order_ = uploaded(device_, bytes_of(order), "bodies to refit");
}

void ChunkTrees::do_take(const Subdomain&) {
    jobs_.clear();
    strips_.clear();
    plan_strips();
    upload_jobs();
    fresh_ = true;
}

std::size_t ChunkTrees::do_bytes() const {
    std::size_t sum = 0;
    for (const auto* buffer : {&nodes_, &volumes_, &tree_table_, &level_table_, &job_table_, &body_order_})
        sum += buffer->bytes();
    return sum;
}

/// Runs bottom up: each strip reads the nodes that the previous one wrote.
void ChunkTrees::launch_strips(bool all) {
    for (const auto& s : strips_) {
        const auto per_group = strips_of_group(shape_, s.height);
        const auto jobs = all ? s.jobs : s.dynamic_jobs;
        if (jobs == 0) continue;
        const auto paired = in_pairs(bodies_.geometry()) ? 2u : 0u; // depths
        const auto first_depth = s.height > paired ? s.height - paired : 0;
        const kernels::refit::RefitStrips arguments{.nodes = nodes_,
                                                    .trees = tree_table_,
                                                    .levels = level_table_,
                                                    .poses = bodies_.poses(),
                                                    .tetrahedra = bodies_.tetrahedra(),
                                                    .vertices = bodies_.vertices(),
                                                    .next_poses = bodies_.next_poses(),
                                                    .next_vertices = bodies_.next_vertices(),
                                                    .margin = reach_of_margin(bodies_.geometry()),
                                                    .jobs = job_table_,
                                                    .first_job = s.first_job,
                                                    .job_count = jobs,
                                                    .level = s.level,
                                                    .height = s.height,
                                                    .first_depth = first_depth};
        device_.launch(strips_kernel_, {groups_for(jobs, per_group), shape_.group_size}, arguments);
    }
}

void ChunkTrees::launch_tops(bool all) {
    const kernels::refit::RefitTops arguments{.nodes = nodes_,
                                              .volumes = volumes_,
                                              .trees = tree_table_,
                                              .levels = level_table_,
                                              .chosen = body_order_,
                                              .first_level = first_top_level_};
    const auto bodies = all ? ordered_bodies_ : moving_bodies_;
    if (bodies > 0) device_.launch(tops_kernel_, {bodies, shape_.group_size}, arguments);
}

void ChunkTrees::upload_masked() {
    const auto put = [&](Buffer& buffer, const std::vector<std::uint32_t>& words, std::string_view label) {
        if (!buffer || buffer.bytes() < words.size() * 4) {
            buffer = {};
            buffer = device_.allocate(words.size() * 4, label);
        }
        device_.upload(buffer, bytes_of(words));
    };
    const StageScope scope(device_, Stage::write);
    put(masked_rows_, masked_.rows, "masked nodes");
    put(masked_starts_, masked_.starts, "rounds of masked nodes");
}

/// Replans the masked nodes when the frame skips other tetrahedra than the previous frame.
void ChunkTrees::mask_skipped(const Frame& frame) {
    if (frame.skipped == skipped_) return;
    {
        const HostWork work(device_, Stage::preprocess, "skipped tetrahedra");
        MaskedElementsPlan plan(leaves_, first_top_level_);
        for (std::size_t body = 0; body < frame.skipped.size(); ++body) {
            auto items = bodies_.positions_of(body, frame.skipped[body]);
            if (items.empty()) continue;
            plan.add(trees_[body].nodes, mesh_levels_[bodies_.scene().bodies[body].mesh], std::move(items));
        }
        masked_ = plan.take();
        skipped_ = frame.skipped;
        fresh_ = true;
    }
    if (masked_.bodies == 0) return;
    if (!masked_rows_) compile_kernel(device_, empty_kernel_, refit_defines());
    upload_masked();
}

void ChunkTrees::do_refit(const Frame& frame, bool all) {
    mask_skipped(frame);
    all |= fresh_;
    const StageScope scope(device_, Stage::refit);
    launch_strips(all);
    if (masked_.bodies > 0) {
        const kernels::refit::EmptyNodes arguments{
            .nodes = nodes_, .rows = masked_rows_, .starts = masked_starts_, .rounds = masked_.rounds};
        device_.launch(empty_kernel_, {masked_.bodies, shape_.group_size}, arguments);
    }
    launch_tops(all);
    fresh_ = false;
}

} // namespace tandem
