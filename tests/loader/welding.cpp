// SPDX-License-Identifier: MIT
// Welding of vertices against brute force, and its time for large tolerances.
#include "base/error.h"
#include "base/random.h"
#include "scenes/mesh.h"
#include "scenes/weld.h"
#include "tests/support/test.h"

#include <ctime>

namespace tandem::loader {
namespace {

using Points = std::vector<Eigen::Vector3d>;

/// Points of a box, of a lattice, and copies of earlier ones.
Points drawn(Random& random, std::size_t count) {
    Points points;
    const auto draw = [&](double scale) { return scale * random.uniform(); };
    for (std::size_t i = 0; i < count; ++i) {
        const double kind = random.uniform();
        if (kind < 0.2 && i > 0)
            points.push_back(points[static_cast<std::size_t>(draw(static_cast<double>(i)))]);
        else if (kind < 0.6)
            points.emplace_back(std::floor(draw(4)), std::floor(draw(4)), std::floor(draw(4)));
        else
            points.emplace_back(draw(4), draw(4), draw(4));
    }
    return points;
}

/// The definition: the smallest number that a chain of near points reaches.
std::vector<std::uint32_t> by_chains(const Points& points, double tolerance) {
    std::vector<std::uint32_t> firsts(points.size());
    std::iota(firsts.begin(), firsts.end(), 0u);
    for (bool changes = true; changes;) {
        changes = false;
        for (std::size_t a = 0; a < points.size(); ++a)
            for (std::size_t b = 0; b < points.size(); ++b)
                if (firsts[b] < firsts[a] && (points[a] - points[b]).stableNorm() <= tolerance) {
                    firsts[a] = firsts[b];
                    changes = true;
                }
    }
    return firsts;
}

TEST(Welding, JoinsChainsOfNearPoints) {
    Random random(47);
    for (std::size_t draw = 0; draw < 60; ++draw) {
        const auto points = drawn(random, 1 + 3 * draw);
        for (const double tolerance :
             {0.0, 1e-320, 1e-9, 0.05, 0.25, 0.5, 1.0, std::sqrt(2.0), 2.0, 6.0, 1e308})
            ASSERT_EQ(welded_vertices(points, tolerance), by_chains(points, tolerance))
                << points.size() << " points, tolerance " << tolerance;
    }
    EXPECT_TRUE(welded_vertices({}, 1).empty());
}

/// Processor time in seconds.
double seconds(const Points& points, double tolerance) {
    const auto start = std::clock();
    welded_vertices(points, tolerance);
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

/// Two blocks of a lattice. Comparing all pairs of points takes more than 1000 times as long as welding near
/// ones.
TEST(Welding, TakesNoMorePairsForLargeTolerances) {
    Points points;
    for (int i = 0; i < 2 * 40 * 40 * 40; ++i)
        points.emplace_back(i % 40, i / 40 % 40, i / 1600 + (i < 64000 ? 0 : 60));
    const double near = seconds(points, 0.5);
    for (const double tolerance : {3.0, 20.0, 60.5, 80.0, 1000.0, 1e300})
        EXPECT_LT(seconds(points, tolerance), 40 * near + 0.5) << tolerance;
}

TEST(Welding, ImpossibleValuesAreRefused) {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.tetrahedra = {{0, 1, 2, 3}};
    for (const double tolerance : {-1.0, std::nan(""), HUGE_VAL})
        EXPECT_THROW(complete_mesh(mesh, "it", {.weld = tolerance}), InputError) << tolerance;
    EXPECT_THROW(duplicates_named("some"), InputError);
    EXPECT_EQ(duplicates_named("keep"), Duplicates::keep);
}

/// A mesh can be connected again, by another reading.
TEST(Welding, ACompletedMeshIsConnectedAnew) {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {1, 0, 0.1}};
    mesh.tetrahedra = {{0, 1, 2, 3}, {4, 3, 2, 5}, {3, 2, 1, 0}};
    complete_mesh(mesh, "it", {.weld = 0.1});
    EXPECT_EQ(mesh.boundary, (std::vector<std::uint8_t>{0b1110, 0b1110, 0}));
    EXPECT_EQ(mesh.merged, (std::vector<std::uint32_t>{2}));
    complete_mesh(mesh, "it", {.duplicates = Duplicates::keep});
    EXPECT_EQ(mesh.boundary, (std::vector<std::uint8_t>{0b1111, 0b1111, 0b1111}));
    EXPECT_TRUE(mesh.merged.empty() && mesh.welded.empty());
    EXPECT_EQ(mesh.reading, (MeshReading{.duplicates = Duplicates::keep}));
}

} // namespace
} // namespace tandem::loader
