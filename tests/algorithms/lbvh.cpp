// SPDX-License-Identifier: MIT
// An algorithm of the tests with its own hierarchy and traversal: this file, lbvh.cl, and the line at the end
// that registers it.
#include "algorithms/bodies/cost.h"
#include "algorithms/hierarchy/chunk_trees.h"
#include "algorithms/parameters/table.h"
#include "algorithms/pipeline/pipeline.h"
#include "algorithms/kernels/sources.h"
#include "backends/upload.h"
#include "tests/algorithms/lbvh.cl.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace tandem {
namespace {

constexpr std::size_t status_leaf_hits = STATUS_OWN; ///< STATUS_LEAF_HITS of lbvh.cl

constexpr Counter leaf_hits{"leaf_hits", "candidate pairs", "leaves that queries reached"};
constexpr std::array all_counters{counters::bvtt_nodes, counters::seeds, leaf_hits};

const std::vector<Preset> all_presets{
    {"resident", "everything resident, body pairs included", {parameters::broad(Broad::device)}}};

/// Nodes of a mesh's trees, as lbvh.cl numbers them.
struct Topology {
    std::vector<std::uint32_t> children; ///< two per inner node
    std::vector<std::uint32_t> depths;   ///< first inner node of each depth, then the number of inner nodes
};

/// Halves the Morton order down to single items: no path is longer than ceil(log2 items).
Topology halved(std::uint32_t items) {
    struct ValueRange {
        std::uint32_t first, end;
    };
    Topology tree;
    const auto inner = items - 1;
    std::uint32_t numbered = 1;
    std::vector<ValueRange> row; // inner nodes of one depth
    if (items > 1) row.push_back({0, items});
    while (!row.empty()) {
        tree.depths.push_back(static_cast<std::uint32_t>(tree.children.size() / 2));
        std::vector<ValueRange> below;
        for (const auto& [first, end] : row) {
            const auto middle = first + (end - first) / 2;
            for (const auto& half : {ValueRange{first, middle}, ValueRange{middle, end}}) {
                const bool is_leaf = half.end - half.first == 1;
                tree.children.push_back(is_leaf ? inner + half.first : numbered++);
                if (!is_leaf) below.push_back(half);
            }
        }
        row = std::move(below);
    }
    tree.depths.push_back(inner);
    return tree;
}

/// One tree per body; bodies with the same mesh share its rows of children.
class StoredTrees final : public Hierarchy {
public:
    StoredTrees(const Bodies& bodies, std::uint32_t group_size);

    const Bodies& bodies() const { return bodies_; }
    const Buffer& tree_table() const { return tree_table_; } ///< TREE_WORDS words per body
    const Buffer& children() const { return children_; }
    std::uint32_t most_items() const { return most_items_; } ///< maximum over bodies

private:
    /// A row of the tree table in lbvh.cl.
    struct Tree {
        std::uint32_t nodes = 0, children = 0, depths = 0, depth_count = 0;
    };

    void do_refit(const Frame& frame, bool all) override;
    const Buffer& do_volumes() const override { return volumes_; }
    const Buffer& do_nodes() const override { return nodes_; }
    std::size_t do_bytes() const override;

    std::vector<Tree> lay_out_meshes();
    void lay_out_bodies(const std::vector<Tree>& mesh_trees);
    void upload_order();
    void flag_skipped(const Frame& frame);

    const Bodies& bodies_;
    Device& device_;
    std::uint32_t group_size_;
    std::uint32_t most_items_ = 1;
    std::uint32_t moving_bodies_ = 0; ///< number of bodies in body_order_ that are not fixed; they come first
    std::uint64_t slots_ = 0;
    /// fixed bodies need a refit: first frame, or the set of skipped tetrahedra has changed
    bool needs_full_refit_ = true;
    std::vector<Tree> trees_;
    std::vector<std::vector<std::uint32_t>> skipped_; ///< skipped tetrahedra of the last frame
    Buffer nodes_, volumes_, tree_table_, children_, depths_, skipped_flags_, body_order_;
    KernelOf<kernels::lbvh::RefitTrees> kernel_;
};

StoredTrees::StoredTrees(const Bodies& bodies, std::uint32_t group_size)
    : bodies_(bodies), device_(bodies.device()), group_size_(group_size) {
    lay_out_bodies(lay_out_meshes());
    upload_order();
    const auto node =
        static_cast<std::uint64_t>(ends_of_node(bodies.geometry())) * real_bytes(bodies.geometry());
    nodes_ = device_.allocate(slots_ * node, "nodes");
    volumes_ = device_.allocate(bodies.count() * node, "volumes");
    skipped_flags_ = device_.allocate(slots_ * 4, "skipped tetrahedra");
    const StageScope scope(device_, Stage::write);
    device_.clear(skipped_flags_, slots_ * 4);
    compile_kernel(device_, kernel_, geometry_defines(bodies.geometry(), group_size));
}

/// Uploads the rows of children and depths of all meshes. Returns where the rows of each mesh start.
std::vector<StoredTrees::Tree> StoredTrees::lay_out_meshes() {
    std::vector<Tree> mesh_trees;
    std::vector<std::uint32_t> children, depths;
    for (std::size_t mesh = 0; mesh < bodies_.scene().meshes.size(); ++mesh) {
        const auto tree = halved(static_cast<std::uint32_t>(bodies_.ordered_mesh(mesh).ids.size()));
        mesh_trees.push_back({0, static_cast<std::uint32_t>(children.size() / 2),
                              static_cast<std::uint32_t>(depths.size()),
                              static_cast<std::uint32_t>(tree.depths.size() - 1)});
        children.insert(children.end(), tree.children.begin(), tree.children.end());
        depths.insert(depths.end(), tree.depths.begin(), tree.depths.end());
    }
    children_ = uploaded(device_, bytes_of(children), "children");
    depths_ = uploaded(device_, bytes_of(depths), "depths");
    return mesh_trees;
}

void StoredTrees::lay_out_bodies(const std::vector<Tree>& mesh_trees) {
    for (std::uint32_t body = 0; body < bodies_.count(); ++body) {
        const auto items = bodies_.row(body).tetrahedron_count;
        trees_.push_back(mesh_trees[bodies_.scene().bodies[body].mesh]);
        trees_.back().nodes = static_cast<std::uint32_t>(slots_);
        slots_ += 2 * std::uint64_t{items} - 1;
        most_items_ = std::max(most_items_, items);
    }
    if (slots_ > std::numeric_limits<std::uint32_t>::max())
        throw DeviceError("scene: more than 2^32 nodes; leave bodies out");
    tree_table_ = uploaded(device_, bytes_of(trees_), "trees");
}

void StoredTrees::upload_order() {
    std::vector<std::uint32_t> order(bodies_.count());
    std::iota(order.begin(), order.end(), 0u);
    const auto moving = [&](std::uint32_t body) { return !bodies_.scene().bodies[body].fixed; };
    moving_bodies_ =
        static_cast<std::uint32_t>(std::stable_partition(order.begin(), order.end(), moving) - order.begin());
    body_order_ = uploaded(device_, bytes_of(order), "bodies to refit");
}

std::size_t StoredTrees::do_bytes() const {
    std::size_t sum = 0;
    for (const auto* buffer :
         {&nodes_, &volumes_, &tree_table_, &children_, &depths_, &skipped_flags_, &body_order_})
        sum += buffer->bytes();
    return sum;
}

/// Flags the leaves that the frame skips, if they differ from those of the previous frame.
void StoredTrees::flag_skipped(const Frame& frame) {
    if (frame.skipped == skipped_) return;
    std::vector<std::uint32_t> flags(slots_);
    {
        const HostWork work(device_, Stage::preprocess, "skipped tetrahedra");
        for (std::size_t body = 0; body < frame.skipped.size(); ++body) {
            const auto positions = bodies_.positions_of(body, frame.skipped[body]);
            const auto first_leaf = trees_[body].nodes + bodies_.row(body).tetrahedron_count - 1;
            for (const auto position : positions) flags[first_leaf + position] = 1;
        }
    }
    needs_full_refit_ = true;
    const StageScope scope(device_, Stage::write);
    device_.upload(skipped_flags_, bytes_of(flags));
    skipped_ = frame.skipped;
}

void StoredTrees::do_refit(const Frame& frame, bool all) {
    flag_skipped(frame);
    const auto bodies = all || needs_full_refit_ ? bodies_.count() : moving_bodies_;
    if (bodies == 0) return;
    const StageScope scope(device_, Stage::refit);
    const kernels::lbvh::RefitTrees arguments{.nodes = nodes_,
                                              .volumes = volumes_,
                                              .trees = tree_table_,
                                              .children = children_,
                                              .depths = depths_,
                                              .skipped = skipped_flags_,
                                              .chosen = body_order_,
                                              .bodies = bodies_.row_table(),
                                              .poses = bodies_.poses(),
                                              .tetrahedra = bodies_.tetrahedra(),
                                              .vertices = bodies_.vertices(),
                                              .next_poses = bodies_.next_poses(),
                                              .next_vertices = bodies_.next_vertices(),
                                              .margin = reach_of_margin(bodies_.geometry())};
    device_.launch(kernel_, {bodies, group_size_}, arguments);
    needs_full_refit_ = false;
}

/// Every tetrahedron of body a queries body b's tree.
class LeafQueries final : public Walker {
public:
    LeafQueries(const StoredTrees& trees, LaunchShape shape) : trees_(trees), shape_(shape) {}

private:
    void do_compile(const WalkBuild& build) override;
    void do_launch(const WalkTask& task) override;
    bool do_grow(const Status&) override { return false; }
    void do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const override;

    const StoredTrees& trees_;
    LaunchShape shape_;
    KernelOf<kernels::lbvh::QueryLeaves> kernel_;
};

void LeafQueries::do_compile(const WalkBuild& build) {
    auto defines = geometry_defines(trees_.bodies().geometry(), shape_.group_size);
    build.add_to(defines);
    compile_kernel(trees_.bodies().device(), kernel_, defines);
}

void LeafQueries::do_launch(const WalkTask& task) {
    const auto& bodies = trees_.bodies();
    const StageScope scope(bodies.device(), Stage::traverse);
    const auto blocks = (trees_.most_items() + shape_.group_size - 1) / shape_.group_size;
    const kernels::lbvh::QueryLeaves arguments{.nodes = trees_.nodes(),
                                               .trees = trees_.tree_table(),
                                               .children = trees_.children(),
                                               .bodies = bodies.row_table(),
                                               .ids = bodies.ids(),
                                               .tetrahedra = bodies.tetrahedra(),
                                               .pairs = task.body_pairs,
                                               .pair_capacity = task.pair_capacity,
                                               .blocks = blocks,
                                               .found = task.answer.pairs.buffer(),
                                               .capacity = task.answer.pairs.capacity(),
                                               .status = task.status.buffer()};
    bodies.device().launch(kernel_, {shape_.groups, shape_.group_size}, arguments);
}

void LeafQueries::do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const {
    work[counters::bvtt_nodes.name] += status.counter(STATUS_BVTT_NODES);
    work[counters::seeds.name] += status.counter(STATUS_SEEDS);
    work[leaf_hits.name] += status.counter(status_leaf_hits);
}

class Lbvh : public Traversal {
public:
    std::string_view name() const override { return "lbvh"; }
    std::string_view summary() const override {
        return "a binary tree per body over the Morton order, halved, with stored children; each tetrahedron "
               "of one body queries the other's tree";
    }
    std::span<const Parameter* const> parameters() const override {
        static const auto all = pipeline_parameters({}, false);
        return all;
    }
    std::span<const Preset> presets() const override { return all_presets; }
    std::span<const Counter> counters() const override { return all_counters; }

private:
    void do_check(const Settings&, const DeviceInfo&) const override {}

    /// A tree over a body has as many nodes as a single chunk.
    std::vector<KernelCost> do_costs(const Scene& scene, const Settings& settings) const override {
        const SceneFacts s(scene, settings);
        auto refit = chunk_tree_costs(s, ChunkTrees::one_chunk_a_body).front();
        refit.entry = "refit_trees";
        return {refit, walk_cost(s, "query_leaves")};
    }

    AlgorithmStages do_build(const BuildContext& ground) const override {
        auto trees = std::make_unique<StoredTrees>(ground.bodies, ground.shape.group_size);
        auto queries = std::make_unique<LeafQueries>(*trees, ground.shape);
        return {std::move(trees), std::move(queries)};
    }
};

const Lbvh lbvh;

} // namespace

[[maybe_unused]] static const bool listed = (add_algorithm(lbvh), true);

} // namespace tandem
