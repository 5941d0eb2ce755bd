// SPDX-License-Identifier: MIT
#include "algorithms/baselines/cubql/cubql_trees.h"

#include "algorithms/baselines/cubql/build.h"
#include "backends/upload.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <stdexcept>

namespace tandem {

namespace {

/// Maximum number of tetrahedra of a leaf, all of which a query tests.
constexpr int leaf_size = 4;
constexpr std::uint32_t no_node = ~0u;

/// A mesh's tree, and the first of its rows in the table of orders.
struct MeshTree {
    cubql_trees::Tree tree;
    std::vector<std::uint32_t> parents; ///< by node; no_node for the root and nodes that are not used
    std::uint32_t first_of_order = 0;
};

/// Boxes of a mesh's tetrahedra at its vertices in the scene, in the order of the device.
std::vector<cubql_trees::Box> boxes_of(const Mesh& mesh, const OrderedMesh& ordered) {
    std::vector<cubql_trees::Box> boxes;
    for (const auto id : ordered.ids) {
        cubql_trees::Box box;
        box.lower.fill(std::numeric_limits<float>::max());
        box.upper.fill(std::numeric_limits<float>::lowest());
        for (const auto vertex : mesh.tetrahedra[id])
            for (int axis = 0; axis < 3; ++axis) {
                const auto at = static_cast<float>(mesh.vertices[vertex][axis]);
                const auto i = static_cast<std::size_t>(axis);
                box.lower[i] = std::min(box.lower[i], at);
                box.upper[i] = std::max(box.upper[i], at);
            }
        boxes.push_back(box);
    }
    return boxes;
}

std::vector<std::uint32_t> parents_of(const cubql_trees::Tree& tree) {
    std::vector<std::uint32_t> parents(tree.nodes.size(), no_node);
    std::vector<std::uint32_t> open{0};
    while (!open.empty()) {
        const auto node = open.back();
        open.pop_back();
        if (cubql_trees::tetrahedra_of(tree.nodes[node]) != 0) continue;
        const auto child = cubql_trees::first_child(tree.nodes[node]);
        parents[child] = parents[child + 1] = node;
        open.push_back(child);
        open.push_back(child + 1);
    }
    return parents;
}

MeshTree mesh_tree(const DeviceInfo& info, const std::vector<cubql_trees::Box>& boxes) {
    MeshTree made;
    if (boxes.empty()) return made;
    try {
        made.tree = cubql_trees::build(std::stoi(info.id.substr(info.id.find(':') + 1)), boxes, leaf_size);
    } catch (const std::runtime_error& error) {
        throw DeviceError(fmt::format("{} ({}): {}", info.id, info.name, error.what()));
    }
    made.tree.nodes.resize(std::max<std::size_t>(made.tree.nodes.size(), 2)); // node 1 is never used
    made.parents = parents_of(made.tree);
    return made;
}

} // namespace

const KernelSource& cubql_kernels() {
    static const KernelSource source{"algorithms/baselines/cubql/query.ptx", cubql_trees::query_ptx};
    return source;
}

CubqlTrees::CubqlTrees(const BuildContext& context)
    : device_(context.device),
      tiles_(context.bodies, Slabs::all, SelfPairs::off, context.shape.group_size, 1),
      groups_(32 * device_.info().compute_units),
      slot_count_(tiles_.first_upper() * TileShapes::lanes) {
    if (bodies().pair_layout() != PairLayout::slots)
        throw DeviceError(
            fmt::format("{}: algorithm cubql numbers the scene's tetrahedra in 32 bits", device_.info().id));
    upload_trees(context);
    boxes_ = device_.allocate(slot_count_ * sizeof(cubql_trees::Box), "cuBQL's boxes");
    ready_ = device_.allocate(std::max(1u, node_count_) * sizeof(std::uint32_t), "cuBQL's ready nodes");
    const StageScope scope(device_, Stage::write);
    device_.clear(ready_, ready_.bytes());
    const Defines defines{{"GROUP_SIZE", std::to_string(group_size)}};
    copy_ = device_.compile(cubql_kernels(), "copy_boxes_cubql", defines);
    refit_ = device_.compile(cubql_kernels(), "refit_cubql", defines);
}

void CubqlTrees::upload_trees(const BuildContext& context) {
    std::map<std::size_t, MeshTree> by_mesh;
    std::vector<std::uint32_t> order, parents, node_bodies;
    std::vector<cubql_trees::Node> nodes;
    std::vector<cubql_trees::TreeRow> table;
    for (std::uint32_t body = 0; body < bodies().count(); ++body) {
        const auto number = context.scene.bodies[body].mesh;
        auto found = by_mesh.find(number);
        if (found == by_mesh.end()) {
            auto made = mesh_tree(device_.info(),
                                  boxes_of(context.scene.meshes[number], bodies().ordered_mesh(number)));
            made.first_of_order = static_cast<std::uint32_t>(order.size());
            order.insert(order.end(), made.tree.order.begin(), made.tree.order.end());
            found = by_mesh.emplace(number, std::move(made)).first;
        }
        const auto& mesh = found->second;
        const auto count = bodies().row(body).tetrahedron_count;
        table.push_back({static_cast<std::uint32_t>(nodes.size()), mesh.first_of_order,
                         bodies().first_slot(body), count});
        nodes.insert(nodes.end(), mesh.tree.nodes.begin(), mesh.tree.nodes.end());
        parents.insert(parents.end(), mesh.parents.begin(), mesh.parents.end());
        node_bodies.resize(nodes.size(), body);
    }
    node_count_ = static_cast<std::uint32_t>(nodes.size());
    nodes_ = uploaded(device_, bytes_of(nodes), "cuBQL's nodes");
    parents_ = uploaded(device_, bytes_of(parents), "cuBQL's parents");
    node_bodies_ = uploaded(device_, bytes_of(node_bodies), "bodies of cuBQL's nodes");
    table_ = uploaded(device_, bytes_of(table), "cuBQL's trees");
    order_ = uploaded(device_, bytes_of(order), "cuBQL's leaves");
}

Grid CubqlTrees::grid(std::uint32_t items) const {
    return {std::min(groups_, (items + group_size - 1) / group_size), group_size};
}

std::size_t CubqlTrees::do_bytes() const {
    auto bytes = tiles_.bytes();
    for (const auto* buffer : {&nodes_, &parents_, &node_bodies_, &table_, &order_, &boxes_, &ready_})
        bytes += buffer->bytes();
    return bytes;
}

void CubqlTrees::do_refit(const Frame& frame, bool all) {
    tiles_.refit(frame, all);
    const StageScope scope(device_, Stage::refit);
    device_.launch(copy_, grid(slot_count_), std::array<Argument, 3>{tiles_.leaves(), boxes_, slot_count_});
    device_.launch(
        refit_, grid(node_count_),
        std::array<Argument, 8>{nodes_, parents_, node_bodies_, table_, order_, boxes_, ready_, node_count_});
}

} // namespace tandem
