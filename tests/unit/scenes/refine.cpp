// SPDX-License-Identifier: MIT
#include "scenes/builtin.h"
#include "base/error.h"
#include "scenes/refine.h"
#include "tests/support/message_of.h"
#include "tests/support/test.h"

#include <bit>

namespace tandem {
namespace {

std::size_t boundary_faces(const Mesh& mesh) {
    std::size_t count = 0;
    for (const auto flags : mesh.boundary) count += static_cast<std::size_t>(std::popcount(flags));
    return count;
}

Mesh lone(const Eigen::Vector3d& tip = {0, 0, 1}) {
    Mesh mesh;
    mesh.name = "lone";
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, tip};
    mesh.tetrahedra = {{0, 1, 2, 3}};
    complete_mesh(mesh, "lone");
    return mesh;
}

/// Shape of a tetrahedron: squared lengths of its edges over the cube root of its squared volume, sorted.
std::vector<long> shape_of(const Mesh& mesh, const Tetrahedron& t) {
    std::vector<double> squares;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < i; ++j)
            squares.push_back((mesh.vertices[t[i]] - mesh.vertices[t[j]]).squaredNorm());
    std::sort(squares.begin(), squares.end());
    std::vector<long> shape;
    for (const double s : squares) shape.push_back(std::lround(1e6 * s / squares.front()));
    return shape;
}

TEST(ScenesRefine, NoLevelsChangeNothing) {
    const auto mesh = built_in_mesh("jack");
    EXPECT_EQ(refined(mesh, 0).vertices, mesh.vertices);
    EXPECT_EQ(refined(mesh, 0).tetrahedra, mesh.tetrahedra);
}

TEST(ScenesRefine, OneTetrahedronBecomesEight) {
    const auto fine = refined(lone(), 1);
    EXPECT_EQ(fine.vertices.size(), 10u);
    EXPECT_EQ(fine.tetrahedra.size(), 8u);
    EXPECT_EQ(fine.vertices[4], Eigen::Vector3d(0.5, 0, 0)) << "the middle of the first edge";
    EXPECT_EQ(fine.vertices[9], Eigen::Vector3d(0, 0.5, 0.5)) << "the middle of the last edge";
    for (const auto& t : fine.tetrahedra) {
        auto one = fine;
        one.tetrahedra = {t};
        EXPECT_EQ(volume(one), 1.0 / 48);
    }
}

TEST(ScenesRefine, MeshesStayConforming) {
    for (const auto* name : {"jack", "plate"}) {
        SCOPED_TRACE(name);
        const auto coarse = built_in_mesh(name);
        auto fine = coarse;
        for (std::uint64_t level = 1; level <= 2; ++level) {
            const auto before = boundary_faces(fine);
            const auto tetrahedra = fine.tetrahedra.size();
            fine = refined(fine, 1);
            EXPECT_EQ(fine.tetrahedra.size(), 8 * tetrahedra);
            EXPECT_EQ(boundary_faces(fine), 4 * before);
            EXPECT_EQ(fine.inverted + fine.degenerate, 0u);
            EXPECT_NEAR(volume(fine) / volume(coarse), 1, 1e-12) << "rounding of the sum";
        }
        // Refinement inherits boundary flags; recomputed flags would reveal a face without a neighbour.
        auto recomputed = fine;
        complete_mesh(recomputed, name);
        EXPECT_EQ(recomputed.boundary, fine.boundary);
        std::set<std::array<double, 3>> different;
        for (const auto& v : fine.vertices) different.insert({v.x(), v.y(), v.z()});
        EXPECT_EQ(different.size(), fine.vertices.size()) << "middles of edges are shared";
        EXPECT_EQ(refined(coarse, 2).tetrahedra, fine.tetrahedra);
    }
}

TEST(ScenesRefine, AtMostThreeShapes) {
    const auto fine = refined(lone({0.3, 0.2, 0.7}), 4);
    EXPECT_EQ(fine.tetrahedra.size(), 4096u);
    std::set<std::vector<long>> shapes;
    for (const auto& t : fine.tetrahedra) shapes.insert(shape_of(fine, t));
    EXPECT_LE(shapes.size(), 3u);
    EXPECT_GE(shapes.size(), 2u);
}

TEST(ScenesRefine, InvertedTetrahedraStayCounted) {
    auto mesh = lone({0, 0, -1});
    ASSERT_EQ(mesh.inverted, 1u);
    EXPECT_EQ(refined(mesh, 1).inverted, 8u);
    mesh = lone({0.25, 0.25, 0});
    EXPECT_EQ(refined(mesh, 1).degenerate, 8u);
}

TEST(ScenesRefine, RefusesMoreThanIndicesCanNumber) {
    auto mesh = lone();
    EXPECT_THROW(refined(mesh, 5), InputError);
    mesh.tetrahedra.resize((std::size_t{1} << 20) + 1);
    EXPECT_THAT(support::message_of([&] { refined(mesh, 4); }),
                testing::HasSubstr("mesh lone would have 4294971392 tetrahedra"));
}

} // namespace
} // namespace tandem
