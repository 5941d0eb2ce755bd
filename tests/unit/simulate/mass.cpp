// SPDX-License-Identifier: MIT
#include "base/error.h"
#include "scenes/simulate/mass.h"
#include "tests/support/test.h"
#include "tests/unit/simulate/support.h"

namespace tandem {
namespace {

using namespace unit_test;

constexpr double pi = 3.14159265358979323846;

TEST(SimulateMass, BoxAwayFromItsOrigin) {
    const auto m = mass_properties(box({1, 2, 3}, {10, 20, 30}), 2);
    EXPECT_NEAR(m.mass, 12, 1e-12);
    EXPECT_LT((m.centre - Eigen::Vector3d(10, 20, 30)).norm(), 1e-12);
    const Eigen::Matrix3d expected = Eigen::Vector3d(4 + 9, 1 + 9, 1 + 4).asDiagonal();
    EXPECT_LT((m.inertia - expected).norm(), 1e-10); // m (b^2 + c^2) / 12
}

TEST(SimulateMass, OneTetrahedronByHand) {
    // The corner of the unit cube: the integrals of x^2 and x y over it are 1/60 and 1/120.
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.tetrahedra = {{0, 1, 2, 3}};
    const auto m = mass_properties(mesh, 6);
    EXPECT_DOUBLE_EQ(m.mass, 1);
    EXPECT_LT((m.centre - Eigen::Vector3d::Constant(0.25)).norm(), 1e-15);
    EXPECT_NEAR(m.inertia(0, 0), 2 * (6.0 / 60 - 1.0 / 16), 1e-15);
    EXPECT_NEAR(m.inertia(0, 1), -(6.0 / 120 - 1.0 / 16), 1e-15);
}

TEST(SimulateMass, BallApproachesTheSphere) {
    const auto m = mass_properties(ball(0.5, 4), 3);
    const double mass = 3 * 4.0 / 3 * pi / 8;
    EXPECT_NEAR(m.mass, mass, 0.005 * mass);
    EXPECT_NEAR(m.inertia(0, 0), 0.4 * mass / 4, 0.01 * mass / 10);
    EXPECT_NEAR(m.inertia(0, 1), 0, 1e-6);
}

TEST(SimulateMass, InvertedTetrahedraCount) {
    auto mesh = box({1, 1, 1});
    const auto expected = mass_properties(mesh, 1);
    for (std::size_t i = 0; i < mesh.tetrahedra.size(); i += 2)
        std::swap(mesh.tetrahedra[i][0], mesh.tetrahedra[i][1]);
    const auto m = mass_properties(mesh, 1);
    EXPECT_NEAR(m.mass, expected.mass, 1e-14);
    EXPECT_LT((m.inertia - expected.inertia).norm(), 1e-14);
}

TEST(SimulateMass, ZeroVolumeIsRefused) {
    Mesh flat;
    flat.name = "flat";
    flat.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    flat.tetrahedra = {{0, 1, 2, 3}};
    EXPECT_THROW(mass_properties(flat, 1), InputError);
    EXPECT_THROW(mass_properties(box({1, 1, 1}), 0), InputError);
    EXPECT_THROW(mass_properties(box({1, 1, 1}), -1), InputError);
}

} // namespace
} // namespace tandem
