// SPDX-License-Identifier: MIT
// Trees over all tetrahedra of a scene: order, ropes, bounds and owners of every node, on every device.
#include "algorithms/hierarchy/scene_tree.h"
#include "tests/support/on_device.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

#include <bit>

namespace tandem {
namespace {

using namespace support;

// Words of scene_tree.clh.
constexpr std::uint32_t leaf_flag = 0x80000000, no_node = 0xffffffff;
constexpr std::uint32_t passive_flag = 0x80000000, many_bodies = 0x7fffffff, self_flag = 0x80000000;

/// A row of the tree: left child or slot in the trees of bodies, rope, owner, other end or item.
struct Row {
    std::uint32_t first, rope, owner, last;
};

std::uint32_t cell_of(float lower, float upper, float least, float scale) {
    const float cell = (0.5F * lower + 0.5F * upper - least) * scale;
    return cell > 0 ? std::min(static_cast<std::uint32_t>(std::min(cell, 4096.0F)), 1023u) : 0;
}

/// A tree after a refit, downloaded.
class Downloaded {
public:
    Downloaded(const SceneTree& tree, const Geometry& geometry)
        : k(static_cast<std::size_t>(geometry.k)), count(tree.count()), device_(tree.bodies().device()) {
        leaves = words<Row>(tree.leaves());
        inner = words<Row>(tree.inner());
        leaf_bounds = words<float>(tree.leaf_bounds());
        inner_bounds = words<float>(tree.inner_bounds());
        body_nodes = words<float>(tree.nodes());
        volumes = words<float>(tree.volumes());
    }

    const Row& row(std::uint32_t node) const {
        return (node & leaf_flag) != 0 ? leaves[node & ~leaf_flag] : inner[node];
    }
    std::span<const float> bounds(std::uint32_t node) const {
        return std::span((node & leaf_flag) != 0 ? leaf_bounds : inner_bounds)
            .subspan((node & ~leaf_flag) * k, k);
    }
    /// The 64-bit key of a leaf: its Morton code in the region of `bodies`, then its number.
    std::uint64_t key(std::uint32_t leaf, const std::vector<std::uint32_t>& bodies) const;

    std::size_t k;
    std::uint32_t count;
    std::vector<Row> leaves, inner;
    std::vector<float> leaf_bounds, inner_bounds, body_nodes, volumes;

private:
    template<class T>
    std::vector<T> words(const Buffer& buffer) const {
        std::vector<T> values(buffer.bytes() / sizeof(T));
        const StageScope scope(device_, Stage::read);
        device_.download(buffer, std::as_writable_bytes(std::span(values)));
        return values;
    }

    Device& device_;
};

std::uint64_t Downloaded::key(std::uint32_t leaf, const std::vector<std::uint32_t>& bodies) const {
    std::array<float, 3> least, most;
    float extent = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        least[axis] = std::numeric_limits<float>::infinity();
        most[axis] = -least[axis];
        for (const auto body : bodies) {
            least[axis] = std::min(least[axis], volumes[body * k + axis]);
            most[axis] = std::max(most[axis], volumes[body * k + k / 2 + axis]);
        }
        extent = std::max(extent, most[axis] - least[axis]);
    }
    const auto slabs = bounds(leaf | leaf_flag);
    const float scale = extent > 0 ? 1024 / extent : 0;
    const auto cell = [&](std::size_t axis) {
        return cell_of(slabs[axis], slabs[k / 2 + axis], least[axis], scale);
    };
    return morton_code(cell(0), cell(1), cell(2)) << 32 | leaf;
}

class SceneTrees : public OnDevice {
protected:
    LaunchShape shape{on.info().max_group_size == 1 ? 1u : 32u, 16};
    Geometry geometry{};

    Bodies bodies_of(const Scene& scene) {
        return {on, scene, geometry, Bodies::Sharing::by_mesh, MeshOrder{Builder::sah}};
    }
    Downloaded refitted(SceneTree& tree, Bodies& bodies, const Frame& frame) {
        bodies.update(frame);
        tree.refit(frame, true);
        return {tree, geometry};
    }
};

/// Visits the nodes below a node in depth-first order, and compares each with the nodes below it. `next`: the
/// first leaf; becomes the one behind the last.
struct Walk {
    const Downloaded& tree;
    const std::vector<std::uint32_t>& bodies;
    std::uint32_t next = 0;

    void expect_right(std::uint32_t node, std::uint32_t rope) {
        const auto& row = tree.row(node);
        ASSERT_EQ(row.rope, rope) << "node " << node;
        if ((node & leaf_flag) != 0) {
            ASSERT_EQ(node & ~leaf_flag, next++);
            return;
        }
        const auto first = next;
        const auto left = row.first;
        const auto right = tree.row(left).rope;
        ASSERT_NE(right, no_node);
        expect_right(left, right);
        const auto middle = next;
        if (testing::Test::HasFatalFailure()) return;
        expect_right(right, rope);
        if (testing::Test::HasFatalFailure()) return;
        EXPECT_EQ(std::min(node, row.last), first);
        EXPECT_EQ(std::max(node, row.last), next - 1);
        expect_split(first, middle, next);
        expect_union(node, left, right);
    }

    /// The children differ in the first bit in which the keys below a node differ.
    void expect_split(std::uint32_t first, std::uint32_t middle, std::uint32_t end) const {
        const auto bit = std::bit_floor(tree.key(first, bodies) ^ tree.key(end - 1, bodies));
        EXPECT_EQ(tree.key(middle - 1, bodies) & bit, 0u);
        EXPECT_EQ(tree.key(middle, bodies) & bit, bit);
    }

    void expect_union(std::uint32_t node, std::uint32_t left, std::uint32_t right) const {
        const auto all = tree.bounds(node), a = tree.bounds(left), b = tree.bounds(right);
        for (std::size_t word = 0; word < tree.k; ++word)
            ASSERT_EQ(all[word], word < tree.k / 2 ? std::min(a[word], b[word]) : std::max(a[word], b[word]))
                << "node " << node << " word " << word;
        const auto own = tree.row(node).owner, one = tree.row(left).owner, other = tree.row(right).owner;
        EXPECT_EQ(own & passive_flag, one & other & passive_flag) << "node " << node;
        const auto body = one & many_bodies;
        EXPECT_EQ(own & many_bodies, body == (other & many_bodies) ? body : many_bodies) << "node " << node;
    }
};

/// Compares every node of the tree over `bodies`, of which those with `is_passive` are passive.
void expect_right_tree(const Downloaded& tree, const Bodies& all, const std::vector<std::uint32_t>& bodies,
                       const std::function<bool(std::uint32_t)>& is_passive, SelfPairs self) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> found;
    for (std::uint32_t leaf = 0; leaf < tree.count; ++leaf) {
        const auto& row = tree.leaves[leaf];
        const auto body = row.owner & many_bodies, item = row.last & ~self_flag;
        ASSERT_TRUE(std::ranges::find(bodies, body) != bodies.end());
        ASSERT_LT(item, all.row(body).tetrahedron_count);
        EXPECT_TRUE(found.insert({body, item}).second) << "twice: " << item << " of body " << body;
        EXPECT_TRUE(std::ranges::equal(tree.bounds(leaf | leaf_flag),
                                       std::span(tree.body_nodes).subspan(row.first * tree.k, tree.k)));
        EXPECT_EQ((row.owner & passive_flag) != 0, is_passive(body));
        EXPECT_EQ((row.last & self_flag) != 0, !is_passive(body) && meets_itself(all.scene(), body, self));
        if (leaf > 0) {
            EXPECT_LT(tree.key(leaf - 1, bodies), tree.key(leaf, bodies));
        }
    }
    std::size_t tetrahedra = 0;
    for (const auto body : bodies) tetrahedra += all.row(body).tetrahedron_count;
    EXPECT_EQ(found.size(), tetrahedra);
    if (tree.count == 0) return;
    Walk walk{tree, bodies};
    // Inner node 0 begins at the first leaf and ends at the last one.
    walk.expect_right(tree.count == 1 ? leaf_flag : 0, no_node);
    EXPECT_EQ(walk.next, tree.count);
}

std::vector<std::uint32_t> all_of(const Scene& scene) {
    std::vector<std::uint32_t> bodies;
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body) bodies.push_back(body);
    return bodies;
}

/// Sizes from two bodies to several levels of boxes; a fixed and a deformable body, both frames.
TEST_P(SceneTrees, HaveEveryTetrahedronAndRightNodes) {
    for (const std::uint32_t count : {2u, 5u, 90u}) {
        SCOPED_TRACE(count);
        const auto scene = crowd(9, count, 0.8);
        auto bodies = bodies_of(scene);
        SceneTree tree(bodies, shape, SelfPairs::deformable, 1);
        for (std::size_t i = 0; i < 2; ++i)
            expect_right_tree(
                refitted(tree, bodies, scene.frame(i)), bodies, all_of(scene),
                [&](std::uint32_t body) { return scene.bodies[body].fixed; }, SelfPairs::deformable);
    }
}

/// A scene of separate tetrahedra at these positions, of one body or each of its own.
Scene tetrahedra(const std::vector<Eigen::Vector3d>& positions, bool apart) {
    Scene scene;
    scene.name = scene.key = "tetrahedra";
    scene.meshes = {tetrahedra_at(apart ? std::vector{positions.front()} : positions)};
    scene.bodies.resize(apart ? positions.size() : 1);
    scene.frame_count = 1;
    scene.frame = [positions, apart](std::size_t) {
        Frame frame;
        frame.deformed.resize(apart ? positions.size() : 1);
        for (std::size_t i = 0; i < frame.deformed.size(); ++i)
            frame.poses.push_back({Eigen::Quaterniond::Identity(), positions[i] - positions[0]});
        return frame;
    };
    scene.digest = digest_of(scene);
    return scene;
}

/// Equal codes, one body, one tetrahedron, a line, and a far one that leaves one cell to all the others.
TEST_P(SceneTrees, OfDegenerateScenesAreRight) {
    using Positions = std::vector<Eigen::Vector3d>;
    Positions line, far(100, {0, 0, 0});
    for (int i = 0; i < 70; ++i) line.emplace_back(i, 0, 0);
    far.emplace_back(1e30, 0, 0);
    for (const auto& positions : {Positions(1, {0, 0, 0}), Positions(2, {0, 0, 0}), Positions(77, {0, 0, 0}),
                                  line, far, Positions{{0, 0, 0}, {5, 0, 0}, {5, 0, 0}}})
        for (const bool apart : {false, true}) {
            SCOPED_TRACE(fmt::format("{} tetrahedra, apart: {}", positions.size(), apart));
            const auto scene = tetrahedra(positions, apart);
            auto bodies = bodies_of(scene);
            SceneTree tree(bodies, shape, SelfPairs::on, 1);
            const auto built = refitted(tree, bodies, scene.frame(0));
            EXPECT_EQ(built.count, positions.size());
            expect_right_tree(
                built, bodies, all_of(scene), [](std::uint32_t) { return false; }, SelfPairs::on);
        }
}

/// Skipped tetrahedra, here all of a body, have empty bounds and widen no node.
TEST_P(SceneTrees, WithSkippedTetrahedraAreRight) {
    const auto scene = crowd(4, 6, 0.8);
    auto frame = scene.frame(0);
    frame.skipped.resize(6);
    for (std::uint32_t i = 0; i < 48; ++i) frame.skipped[4].push_back(i);
    frame.skipped[3] = {0, 7, 9};
    auto bodies = bodies_of(scene);
    SceneTree tree(bodies, shape, SelfPairs::off, 1);
    const auto built = refitted(tree, bodies, frame);
    std::size_t empty = 0;
    for (std::uint32_t leaf = 0; leaf < built.count; ++leaf)
        empty += built.bounds(leaf | leaf_flag)[0] > built.bounds(leaf | leaf_flag)[built.k / 2] ? 1 : 0;
    EXPECT_EQ(empty, 51u);
    expect_right_tree(
        built, bodies, all_of(scene), [](std::uint32_t body) { return body == 0; }, SelfPairs::off);
}

/// Ghosts are passive, bodies without a role have no leaves, and a later subdomain may have more or none.
TEST_P(SceneTrees, OfASubdomainHaveItsBodies) {
    const auto scene = crowd(6, 9, 0.8);
    auto bodies = bodies_of(scene);
    SceneTree tree(bodies, shape, SelfPairs::on, 1);
    for (const auto& part :
         {Subdomain{{5, 3}, {0, 7}}, Subdomain{{1, 2, 3, 4, 5, 6, 7, 8}, {0}}, Subdomain{}}) {
        tree.take(part, bodies.count());
        auto members = part.own;
        members.insert(members.end(), part.ghosts.begin(), part.ghosts.end());
        SCOPED_TRACE(members.size());
        expect_right_tree(
            refitted(tree, bodies, scene.frame(1)), bodies, members,
            [&](std::uint32_t body) { return std::ranges::find(part.ghosts, body) != part.ghosts.end(); },
            SelfPairs::on);
    }
}

/// A kept tree has the order of the frame that built it, and bounds of the current one.
TEST_P(SceneTrees, AreBuiltInEveryPeriod) {
    const auto scene = procession(5, 8, 0.9);
    auto bodies = bodies_of(scene);
    SceneTree tree(bodies, shape, SelfPairs::off, 3);
    std::vector<Row> order;
    std::vector<bool> built;
    for (std::size_t i = 0; i < 8; ++i) {
        bodies.update(scene.frame(i));
        if (i == 7) tree.build_next();
        tree.refit(scene.frame(i));
        const Downloaded now(tree, geometry);
        built.push_back(order.empty()
                        || !std::ranges::equal(order, now.leaves, {}, &Row::first, &Row::first));
        order = now.leaves;
        Walk walk{now, all_of(scene)};
        for (std::uint32_t node = 0; node + 1 < now.count; ++node)
            walk.expect_union(node, now.inner[node].first, now.row(now.inner[node].first).rope);
    }
    EXPECT_EQ(built, (std::vector{true, false, false, true, false, false, true, true}));
}

TANDEM_ON_DEVICES(SceneTrees);

} // namespace
} // namespace tandem
