// SPDX-License-Identifier: MIT
// The order from the surface area heuristic, and the tables that tiles derive from it.
#include "algorithms/orders/order.h"
#include "algorithms/orders/sah_order.h"
#include "scenes/scene.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using support::tetrahedra_at;

/// Sum of the areas of the boxes of all runs.
double area_of_runs(const Mesh& mesh, const std::vector<std::uint32_t>& order, std::size_t run) {
    double sum = 0;
    for (std::size_t first = 0; first < order.size(); first += run) {
        Eigen::AlignedBox3d box;
        for (auto i = first; i < std::min(first + run, order.size()); ++i)
            for (const auto vertex : mesh.tetrahedra[order[i]]) box.extend(mesh.vertices[vertex]);
        const Eigen::Vector3d side = box.sizes();
        sum += side.x() * side.y() + side.y() * side.z() + side.z() * side.x();
    }
    return sum;
}

TEST(SahOrder, IsAPermutationOfAnyMesh) {
    const auto check = [](const Mesh& mesh) {
        auto order = sah_order(mesh);
        EXPECT_EQ(order, sah_order(mesh)); // and the same order every time
        std::sort(order.begin(), order.end());
        std::vector<std::uint32_t> all(mesh.tetrahedra.size());
        std::iota(all.begin(), all.end(), 0u);
        EXPECT_EQ(order, all);
    };
    Random random(3);
    for (const std::uint32_t cells : {1u, 2u, 3u, 7u}) check(support::shaken_box(cells, random));
    check(tetrahedra_at({{0, 0, 0}}));
    check(tetrahedra_at(std::vector<Eigen::Vector3d>(100, {1, 1, 1}))); // all at one position
    check(tetrahedra_at({{0, 0, 0}, {1e-310, 0, 0}}, 1e-310));
    check(tetrahedra_at({{0, 0, 0}, {1e300, 0, 0}, {0, 1e300, 0}})); // areas overflow
    std::vector<Eigen::Vector3d> line;
    for (int i = 0; i < 2000; ++i)
        line.emplace_back(std::pow(1.4, i % 500), 0, 0); // each cut removes one run
    check(tetrahedra_at(line));
}

TEST(SahOrder, CutsAtRuns) {
    std::vector<Eigen::Vector3d> positions; // three mixed clusters of 32
    for (int i = 0; i < 96; ++i) positions.emplace_back(1000 * (i % 3), i / 3 % 8, i / 24);
    const auto order = sah_order(tetrahedra_at(positions));
    for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i] % 3, order[i / 32 * 32] % 3) << i;
    positions.resize(70); // 24, 23 and 23 remain: one of these runs of 32 must contain two clusters
    EXPECT_EQ(sah_order(tetrahedra_at(positions)).size(), 70u);
}

TEST(SahOrder, MakesSmallerRunsThanTheCurve) {
    for (const std::string name : {"pile:bodies=2,mesh=jack", "pile:bodies=2,mesh=glass", "plates"}) {
        const auto scene = make_scene(name);
        const auto& mesh = scene.meshes[0];
        for (const std::size_t run : {32u, 1024u}) {
            const auto curve = area_of_runs(mesh, morton_order(mesh), run);
            EXPECT_LT(area_of_runs(mesh, sah_order(mesh), run), 0.95 * curve) << name << " " << run;
        }
        EXPECT_LT(area_of_runs(mesh, sah_order(mesh), 32), 0.8 * area_of_runs(mesh, morton_order(mesh), 32))
            << name;
    }
}

} // namespace
} // namespace tandem
