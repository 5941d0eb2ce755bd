// SPDX-License-Identifier: MIT
// The order that the surface area heuristic gives, and the tables that tiles have of it.
#include "algorithms/hierarchy/order.h"
#include "algorithms/hierarchy/sah_order.h"
#include "scenes/scene.h"
#include "tests/support/scenes.h"

#include <gtest/gtest.h>
#include <numeric>

namespace tandem {
namespace {

using testing_support::tetrahedra_at;

/// Areas of the boxes of all runs, as they stand.
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
        EXPECT_EQ(order, sah_order(mesh)); // and of one mesh one
        std::sort(order.begin(), order.end());
        std::vector<std::uint32_t> all(mesh.tetrahedra.size());
        std::iota(all.begin(), all.end(), 0u);
        EXPECT_EQ(order, all);
    };
    Random random(3);
    for (const std::uint32_t cells : {1u, 2u, 3u, 7u}) check(testing_support::shaken_box(cells, random));
    check(tetrahedra_at({{0, 0, 0}}));
    check(tetrahedra_at(std::vector<Eigen::Vector3d>(100, {1, 1, 1}))); // all in one place
    check(tetrahedra_at({{0, 0, 0}, {1e-310, 0, 0}}, 1e-310));
    check(tetrahedra_at({{0, 0, 0}, {1e300, 0, 0}, {0, 1e300, 0}})); // areas overflow
    std::vector<Eigen::Vector3d> line;
    for (int i = 0; i < 2000; ++i)
        line.emplace_back(std::pow(1.4, i % 500), 0, 0); // cuts off one run each time
    check(tetrahedra_at(line));
}

TEST(SahOrder, CutsAtRuns) {
    std::vector<Eigen::Vector3d> places; // three heaps of 32, mixed
    for (int i = 0; i < 96; ++i) places.emplace_back(1000 * (i % 3), i / 3 % 8, i / 24);
    const auto order = sah_order(tetrahedra_at(places));
    for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i] % 3, order[i / 32 * 32] % 3) << i;
    places.resize(70); // 24, 23 and 23: of these runs of 32 one has to have two
    EXPECT_EQ(sah_order(tetrahedra_at(places)).size(), 70u);
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
