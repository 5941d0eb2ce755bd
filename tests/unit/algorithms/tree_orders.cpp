// SPDX-License-Identifier: MIT
// Orders of a mesh's tetrahedra by builders other than sah.
#include "algorithms/orders/axis_orders.h"
#include "algorithms/orders/breadth_order.h"
#include "algorithms/orders/heap.h"
#include "algorithms/orders/median_order.h"
#include "algorithms/orders/order.h"
#include "algorithms/orders/sah_order.h"
#include "scenes/scene.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using support::shaken_box;
using support::tetrahedra_at;

using Order = std::vector<std::uint32_t>;
using Positions = std::vector<Eigen::Vector3d>;

constexpr Builder builders[] = {Builder::morton,  Builder::sah,    Builder::breadth,
                                Builder::hilbert, Builder::median, Builder::balanced};

Order counted(std::size_t count) {
    Order all(count);
    std::iota(all.begin(), all.end(), 0u);
    return all;
}

/// The cells of a cube, x fastest.
Positions grid(int side) {
    Positions positions;
    for (int i = 0; i < side * side * side; ++i)
        positions.emplace_back(10.0 * (i % side), 10.0 * (i / side % side), 10.0 * (i / side / side));
    return positions;
}

/// The same tetrahedra in random order, as a mesh generator may number them.
Mesh shuffled(Mesh mesh, std::uint64_t seed) {
    Random random(seed);
    for (auto i = mesh.tetrahedra.size(); i > 1; --i)
        std::swap(mesh.tetrahedra[i - 1],
                  mesh.tetrahedra[std::min(
                      static_cast<std::size_t>(random.uniform() * static_cast<double>(i)), i - 1)]);
    complete_mesh(mesh, "shuffled");
    return mesh;
}

/// Several meshes as one, without common vertices.
Mesh together(const std::vector<Mesh>& parts) {
    Mesh mesh;
    for (const auto& part : parts) {
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
        for (auto t : part.tetrahedra) {
            for (auto& vertex : t) vertex += first;
            mesh.tetrahedra.push_back(t);
        }
    }
    complete_mesh(mesh, "together");
    return mesh;
}

std::vector<Mesh> hard_meshes() {
    Random random(3);
    Mesh fan; // one face shared by all
    fan.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    for (std::uint32_t i = 0; i < 500; ++i) {
        fan.vertices.emplace_back(0, 0, 1.0 + i % 7);
        fan.tetrahedra.push_back({0, 1, 2, 3 + i});
    }
    complete_mesh(fan, "fan");
    Mesh point; // one shared vertex
    point.vertices = {{0, 0, 0}};
    point.tetrahedra.assign(40, {0, 0, 0, 0});
    complete_mesh(point, "point");
    return {shaken_box(1, random),
            shuffled(shaken_box(7, random), 5),
            together({shaken_box(2, random), shaken_box(3, random), tetrahedra_at({{0, 0, 0}, {9, 9, 9}})}),
            fan,
            point,
            tetrahedra_at({{0, 0, 0}}),
            tetrahedra_at(Positions(100, {1, 1, 1})), // all at one position
            tetrahedra_at({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, 0),
            tetrahedra_at({{0, 0, 0}, {1e-310, 0, 0}}, 1e-310),
            tetrahedra_at({{0, 0, 0}, {1e300, 0, 0}, {0, -1e300, 0}})};
}

/// Centroids overflow, and some are not numbers: infinity minus infinity.
Mesh beyond_all_numbers() {
    Mesh mesh;
    for (std::uint32_t i = 0; i < 80; ++i) {
        const double far = i % 3 == 0 ? 1.7e308 : i % 3 == 1 ? -1.7e308 : 1;
        const double other = i % 3 == 2 ? 1 : i % 2 == 0 ? far : -far;
        mesh.vertices.insert(mesh.vertices.end(),
                             {{far, 0, i * 1.0}, {far, 1, 0}, {other, 0, 1}, {other, other, 0}});
        mesh.tetrahedra.push_back({4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3});
    }
    complete_mesh(mesh, "beyond");
    return mesh;
}

/// Duplicates are in no tree.
TEST(TreeOrders, ArePermutationsOfAnyMesh) {
    auto meshes = hard_meshes();
    meshes.push_back(beyond_all_numbers());
    EXPECT_TRUE(std::ranges::any_of(centroids(meshes.back()), [](const auto& c) { return c.hasNaN(); }));
    for (const auto builder : builders)
        for (const auto& mesh : meshes) {
            auto order = ordered(mesh, {builder}).ids;
            EXPECT_EQ(order, ordered(mesh, {builder}).ids); // and the same order every time
            std::ranges::sort(order);
            auto expected = counted(mesh.tetrahedra.size());
            std::erase_if(expected, [&](auto id) { return std::ranges::binary_search(mesh.merged, id); });
            EXPECT_EQ(order, expected) << static_cast<int>(builder) << mesh.name;
        }
}

/// Hulls of a mesh: interior tetrahedra are in no order, and vertices that only they use have no number.
TEST(TreeOrders, ContainWalkedTetrahedraOnly) {
    Random random(4);
    const auto mesh = shuffled(shaken_box(5, random), 6);
    const auto walked = walked_tetrahedra(mesh, Walked::boundary);
    EXPECT_EQ(count_walked(mesh, Walked::boundary), walked.size());
    EXPECT_LT(walked.size(), mesh.tetrahedra.size());
    for (const auto id : walked) EXPECT_NE(mesh.boundary[id], 0);
    EXPECT_EQ(std::ranges::count(mesh.boundary, 0) + walked.size(), mesh.tetrahedra.size());
    for (const auto builder : builders) {
        auto part = ordered(mesh, {builder, Walked::boundary});
        EXPECT_LT(part.vertices.size(), mesh.vertices.size());
        EXPECT_EQ(part.numbers.size(), mesh.vertices.size());
        for (std::size_t i = 0; i < part.ids.size(); ++i)
            for (std::size_t corner = 0; corner < 4; ++corner)
                EXPECT_EQ(part.vertices[part.tetrahedra[4 * i + corner]],
                          mesh.tetrahedra[part.ids[i]][corner]);
        std::ranges::sort(part.ids);
        EXPECT_EQ(part.ids, walked);
    }
}

TEST(TreeOrders, DifferFromEachOther) {
    Random random(4);
    const auto mesh = shuffled(shaken_box(5, random), 6);
    std::set<Order> different;
    for (const auto builder : builders) different.insert(ordered(mesh, {builder}).ids);
    EXPECT_EQ(different.size(), std::size(builders));
}

TEST(TreeOrders, TiesKeepInputOrder) {
    const auto mesh = tetrahedra_at(Positions(3000, {5, 5, 5}));
    for (const auto builder : builders)
        EXPECT_EQ(ordered(mesh, {builder}).ids, counted(3000)) << static_cast<int>(builder);
}

TEST(TreeOrders, IncludeTetrahedraThatAreNotNumbers) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(morton_order(Positions{{5, 0, 0}, {none, 0, 0}, {0, 0, 0}}), (Order{1, 2, 0}));
    const AxisOrders axes({{none, 1, 0}, {1, none, 0}, {-1, 2, 0}}); // the origin replaces it
    EXPECT_EQ(axes.along(0), (Order{2, 0, 1}));
    EXPECT_EQ(axes.along(1), (Order{1, 0, 2}));
    EXPECT_EQ(axes.along(2), (Order{0, 1, 2}));
}

TEST(Hilbert, StepsFromFaceToFace) {
    for (const int side : {2, 4, 8}) {
        const auto mesh = shuffled(tetrahedra_at(grid(side)), 7);
        const auto positions = centroids(mesh);
        const auto order = hilbert_order(mesh);
        for (std::size_t i = 1; i < order.size(); ++i)
            EXPECT_EQ((positions[order[i]] - positions[order[i - 1]]).norm(), 10) << side << " " << i;
        // The curve enters every octant once, so each octant is one contiguous run.
        for (std::size_t i = 0; i < order.size(); ++i) {
            const Eigen::Vector3d offset = positions[order[i]] - positions[order[i / 8 * 8]];
            EXPECT_LE(offset.cwiseAbs().maxCoeff(), 10) << side << " " << i;
        }
    }
}

TEST(Hilbert, IsOneCurveOfAllCells) {
    const auto most = (1u << 21) - 1;
    EXPECT_EQ(hilbert_code(0, 0, 0), 0u);
    EXPECT_EQ(hilbert_code(most, 0, 0), (std::uint64_t{1} << 63) - 1); // the end is next to the start
    std::vector<Eigen::Vector3i> cells(4096);
    for (int i = 0; i < 4096; ++i) {
        const Eigen::Vector3i cell(i % 16, i / 16 % 16, i / 256);
        const auto code =
            hilbert_code(static_cast<std::uint32_t>(cell.x()), static_cast<std::uint32_t>(cell.y()),
                         static_cast<std::uint32_t>(cell.z()));
        ASSERT_LT(code, 4096u);
        cells[code] = cell;
    }
    for (std::size_t i = 1; i < cells.size(); ++i)
        ASSERT_EQ((cells[i] - cells[i - 1]).cwiseAbs().sum(), 1) << i; // therefore no cell is visited twice
}

/// Distance of each tetrahedron from `start` in faces, by comparing all with all.
std::vector<int> distances(const Mesh& mesh, std::uint32_t start) {
    const auto touch = [&](std::uint32_t a, std::uint32_t b) {
        return std::ranges::count_if(mesh.tetrahedra[a],
                                     [&](auto v) {
                                         return std::ranges::find(mesh.tetrahedra[b], v)
                                                != mesh.tetrahedra[b].end();
                                     })
               == 3;
    };
    std::vector<int> far(mesh.tetrahedra.size(), -1);
    far[start] = 0;
    for (int layer = 0, more = 1; more != 0; ++layer) {
        more = 0;
        for (std::uint32_t a = 0; a < far.size(); ++a)
            for (std::uint32_t b = 0; far[a] == layer && b < far.size(); ++b)
                if (far[b] < 0 && touch(a, b)) {
                    far[b] = layer + 1;
                    more = 1;
                }
    }
    return far;
}

TEST(Breadth, IsInOrderOfDistance) {
    Random random(8);
    const auto mesh = shuffled(shaken_box(4, random), 9);
    const auto order = breadth_order(mesh);
    EXPECT_EQ(order[0], morton_order(mesh)[0]);
    const auto far = distances(mesh, order[0]);
    for (std::size_t i = 1; i < order.size(); ++i) EXPECT_LE(far[order[i - 1]], far[order[i]]) << i;
    EXPECT_GT(far[order.back()], 8);
}

TEST(Breadth, NeighboursFollowByNumber) {
    // The first has neighbours across all faces; the order of its corners would reverse their order.
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1},   {9, 9, 9},
                     {9, 9, 1}, {9, 1, 9}, {1, 9, 9}, {12, 12, 12}};
    mesh.tetrahedra = {{1, 2, 7, 8}, {0, 1, 2, 7}, {0, 1, 3, 6}, {0, 1, 2, 3}, {0, 2, 3, 5}, {1, 2, 3, 4}};
    complete_mesh(mesh, "star");
    EXPECT_EQ(breadth_order(mesh), (Order{3, 1, 2, 4, 5, 0}));
}

TEST(Breadth, ComponentsFollowOneAnother) {
    Random random(10);
    auto far = shaken_box(2, random);
    for (auto& v : far.vertices) v += Eigen::Vector3d(50, 0, 0);
    const auto near = shaken_box(2, random);
    const auto mesh = shuffled(together({far, near}), 11);
    const auto order = breadth_order(mesh);
    ASSERT_EQ(order.size(), 96u);
    const auto positions = centroids(mesh);
    for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(positions[order[i]].x() > 25, i >= 48) << i;
    // Without common faces every tetrahedron is a component, and the order is that of the curve.
    const auto apart = shuffled(tetrahedra_at(grid(3)), 12);
    EXPECT_EQ(breadth_order(apart), morton_order(apart));
}

/// The halves of every node of a complete binary tree lie on two sides of a plane.
TEST(Balanced, CutsWhereACompleteTreeCuts) {
    Random random(14);
    for (const std::uint32_t count : {2u, 3u, 5u, 6u, 7u, 12u, 33u, 100u, 1000u, 2325u}) {
        Positions positions;
        for (std::uint32_t i = 0; i < count; ++i)
            positions.emplace_back(random.uniform() * 100, random.uniform() * 100, random.uniform() * 100);
        const auto mesh = tetrahedra_at(positions);
        const auto at = centroids(mesh);
        const auto order = balanced_order(mesh);
        const auto is_apart = [&](std::uint32_t node, int axis) {
            double left = -1e9, right = 1e9;
            const auto child = heap::first_child(node);
            for (auto i = heap::first_item_below(child, count); i <= heap::last_item_below(child, count); ++i)
                left = std::max(left, at[order[i]][axis]);
            for (auto i = heap::first_item_below(child + 1, count);
                 i <= heap::last_item_below(child + 1, count); ++i)
                right = std::min(right, at[order[i]][axis]);
            return left <= right;
        };
        for (auto node = heap::root_node; !heap::is_leaf(node, count); ++node)
            EXPECT_TRUE(is_apart(node, 0) || is_apart(node, 1) || is_apart(node, 2)) << count << " " << node;
    }
}

TEST(Median, HalvesAlongTheLongestAxis) {
    Positions positions; // 64 along y, twice as close along x
    for (int i = 0; i < 64; ++i) positions.emplace_back(10.0 * (i % 4), 20.0 * (i / 4), 0);
    const auto mesh = shuffled(tetrahedra_at(positions), 13);
    const auto at = centroids(mesh);
    const auto order = median_order(mesh);
    const auto separates = [&](std::size_t first, std::size_t middle, std::size_t end, int axis) {
        double left = -1e9, right = 1e9;
        for (auto i = first; i < middle; ++i) left = std::max(left, at[order[i]][axis]);
        for (auto i = middle; i < end; ++i) right = std::min(right, at[order[i]][axis]);
        return left < right;
    };
    // 4 x 16 cells of 10 x 20: along y down to 4 x 2, then along x (30 against 20).
    for (const std::size_t run : {32u, 16u, 8u, 4u})
        for (std::size_t first = 0; first < 64; first += 2 * run)
            EXPECT_TRUE(separates(first, first + run, first + 2 * run, run == 4 ? 0 : 1))
                << run << " " << first;
}

TEST(Median, KeepsRunsWhole) {
    const auto axis_of = [](std::size_t count) {
        Positions positions;
        for (std::size_t i = 0; i < count; ++i) positions.emplace_back(2.0 * static_cast<double>(i), 0, 0);
        return tetrahedra_at(positions);
    };
    for (const std::size_t count : {2u, 3u, 31u, 32u, 33u, 96u, 1000u, 1025u, 40000u}) {
        // any cut of a line keeps the order of the line
        EXPECT_EQ(median_order(axis_of(count)), counted(count)) << count;
    }
    // Three mixed rows of 32: no cut splits a row. A cut at 48 would, and the next one would cut across two
    // of them.
    Positions rows;
    for (int i = 0; i < 96; ++i) rows.emplace_back(i % 3 == 0 ? 0 : 1500 + 100 * (i % 3), 50 * (i / 3), 0);
    const auto order = median_order(tetrahedra_at(rows));
    for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i] % 3, i / 32) << i;
}

TEST(Median, CutsAtMultiplesOfRuns) {
    EXPECT_EQ(run_of(2), 1u);
    EXPECT_EQ(run_of(20), 16u);
    EXPECT_EQ(run_of(32), 16u);
    EXPECT_EQ(run_of(33), 32u);
    EXPECT_EQ(run_of(1024), 32u);
    EXPECT_EQ(run_of(1025), 1024u);
    EXPECT_EQ(run_of(32769), 32768u);
    // Two clusters, the left with 40 of 100: the cut nearest to the middle is at 64 and includes 24 of the
    // right.
    Positions clusters;
    for (int i = 0; i < 100; ++i) clusters.emplace_back(i < 40 ? 0 : 1000, i % 10, i / 10);
    const auto order = median_order(tetrahedra_at(clusters));
    EXPECT_TRUE(std::all_of(order.begin(), order.begin() + 32, [](auto t) { return t < 40; }));
    EXPECT_EQ(std::count_if(order.begin(), order.begin() + 64, [](auto t) { return t < 40; }), 40);
}

} // namespace
} // namespace tandem
