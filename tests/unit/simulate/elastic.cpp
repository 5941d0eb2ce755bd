// SPDX-License-Identifier: MIT
#include "scenes/motion.h"
#include "base/random.h"
#include "scenes/simulate/algebra.h"
#include "scenes/simulate/elastic.h"
#include "scenes/simulate/polar.h"
#include "tests/support/test.h"
#include "tests/unit/simulate/support.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace tandem::simulate {
namespace {

using namespace unit_test;
using Law = Elastic::Law;
using Positions = std::vector<Eigen::Vector3d>;

ElasticMesh material(const Mesh& mesh, Law law) {
    Elastic elastic;
    elastic.law = law;
    elastic.young = 1000;
    elastic.poisson = 0.3;
    elastic.damping = 7;
    return make_elastic_mesh(mesh, elastic, 10);
}

Positions shaken(const Mesh& mesh, double amplitude) {
    Random random(3);
    auto positions = mesh.vertices;
    for (auto& p : positions) p += amplitude * random.uniform() * random.direction();
    return positions;
}

Positions forces_at(const ElasticMesh& mesh, const Positions& positions) {
    Positions forces(positions.size(), Eigen::Vector3d::Zero());
    add_elastic_forces(mesh, positions, forces);
    return forces;
}

class SimulateElastic : public testing::TestWithParam<Law> {};

TEST_P(SimulateElastic, ForceIsMinusTheGradientOfEnergy) {
    const auto mesh = beam({1, 1, 2}, {1, 1, 2});
    const auto elastic = material(mesh, GetParam());
    for (const double amplitude : {0.1, 0.9}) { // the second inverts elements
        auto positions = shaken(mesh, amplitude);
        EXPECT_EQ(strain(elastic, positions).inverted > 0, amplitude > 0.5);
        const auto forces = forces_at(elastic, positions);
        constexpr double h = 1e-6;
        for (std::size_t i = 0; i < positions.size(); ++i)
            for (int axis = 0; axis < 3; ++axis) {
                const double at = positions[i][axis];
                positions[i][axis] = at + h;
                const double above = strain(elastic, positions).energy;
                positions[i][axis] = at - h;
                const double below = strain(elastic, positions).energy;
                positions[i][axis] = at;
                EXPECT_NEAR(forces[i][axis], -(above - below) / (2 * h),
                            1e-4 * (1 + std::fabs(forces[i][axis])));
            }
    }
}

TEST_P(SimulateElastic, RigidMotionGivesNoForce) {
    const auto mesh = beam({1, 1, 2}, {1, 1, 2});
    const auto elastic = material(mesh, GetParam());
    Random random(9);
    for (int i = 0; i < 20; ++i) {
        const auto q = random.rotation();
        auto positions = mesh.vertices;
        for (auto& p : positions) p = rotated(q, p) + Eigen::Vector3d(3, 4, 5);
        for (const auto& force : forces_at(elastic, positions)) EXPECT_LT(force.norm(), 1e-10);
        EXPECT_LT(strain(elastic, positions).energy, 1e-20);
    }
}

TEST_P(SimulateElastic, SmallStrainObeysHooke) {
    const auto elastic = material(box({1, 1, 1}), GetParam());
    Eigen::Matrix3d small;
    small << 1, 2, -1, 2, 3, 4, -1, 4, -2;
    small *= 1e-7;
    const Eigen::Matrix3d expected =
        2 * elastic.mu * small + elastic.lambda * small.trace() * Eigen::Matrix3d::Identity();
    const auto stress = response(elastic, Eigen::Matrix3d::Identity() + small).stress;
    EXPECT_LT((stress - expected).norm(), 1e-5 * expected.norm());
}

TEST_P(SimulateElastic, ForcesSumToZero) {
    const auto mesh = beam({1, 1, 2}, {2, 2, 2});
    const auto positions = shaken(mesh, 0.5);
    const auto forces = forces_at(material(mesh, GetParam()), positions);
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), torque = force;
    for (std::size_t i = 0; i < forces.size(); ++i) {
        force += forces[i];
        torque += positions[i].cross(forces[i]);
    }
    EXPECT_LT(force.norm(), 1e-9);
    EXPECT_LT(torque.norm(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Laws, SimulateElastic,
                         testing::Values(Law::corotational, Law::saint_venant_kirchhoff));

TEST(SimulatePolar, IsTheBestOfAllRotations) {
    Random random(21);
    int inverted = 0;
    for (int i = 0; i < 2000; ++i) {
        Eigen::Matrix3d f;
        for (int entry = 0; entry < 9; ++entry) f(entry) = random.uniform(-1, 1);
        inverted += f.determinant() < 0;
        const auto r = closest_rotation(f);
        ASSERT_NEAR(r.determinant(), 1, 1e-9);
        ASSERT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-9);
        // tr(R'F) is largest when S = R'F is symmetric and tr(S) - S has no negative eigenvalue.
        const Eigen::Matrix3d s = r.transpose() * f;
        ASSERT_LT((s - s.transpose()).norm(), 1e-9);
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(s.trace() * Eigen::Matrix3d::Identity()
                                                                    - s);
        ASSERT_GT(solver.eigenvalues()(0), -1e-9);
    }
    EXPECT_GT(inverted, 500);
}

TEST(SimulatePolar, FlatAndZeroStillGiveARotation) {
    for (const Eigen::Matrix3d& f :
         {Eigen::Matrix3d(Eigen::Matrix3d::Zero()), Eigen::Matrix3d(Eigen::Vector3d(1, 1, 0).asDiagonal()),
          Eigen::Matrix3d(-Eigen::Matrix3d::Identity())}) {
        const auto r = closest_rotation(f);
        EXPECT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
        EXPECT_NEAR(r.determinant(), 1, 1e-12);
    }
}

TEST(SimulateElasticMesh, InvertedElementsAreCounted) {
    const auto mesh = box({1, 1, 1});
    const auto elastic = material(mesh, Law::corotational);
    auto positions = mesh.vertices;
    EXPECT_EQ(strain(elastic, positions).inverted, 0u);
    // the middle vertex, pushed out through one face: two elements contain that face
    positions.back().x() = 0.75;
    EXPECT_EQ(strain(elastic, positions).inverted, 2u);
    for (auto& p : positions) p.x() = -p.x();
    EXPECT_EQ(strain(elastic, positions).inverted, 10u);
}

TEST(SimulateElasticMesh, MassIsLumpedAndPinnedVerticesHaveNone) {
    Elastic pinned;
    pinned.young = 1;
    pinned.pinned = {2};
    const auto elastic = make_elastic_mesh(box({1, 2, 3}), pinned, 10);
    double sum = 0;
    for (const double mass : elastic.masses) sum += mass;
    EXPECT_NEAR(sum, 60, 1e-12);
    EXPECT_NEAR(elastic.masses.back(), 15, 1e-12); // in all elements
    EXPECT_EQ(elastic.inverse_masses[2], 0);
    EXPECT_GT(elastic.inverse_masses[3], 0);
}

TEST(SimulateElasticMesh, DampingOfAUniformVelocityIsProportionalToVolume) {
    const auto mesh = beam({1, 2, 3}, {1, 2, 1});
    const auto elastic = material(mesh, Law::corotational);
    const Positions velocities(mesh.vertices.size(), Eigen::Vector3d(1, 0, -2));
    Positions forces(velocities.size(), Eigen::Vector3d::Zero());
    add_damping_forces(elastic, velocities, forces);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& force : forces) sum += force;
    EXPECT_LT((sum + 7 * 6 * Eigen::Vector3d(1, 0, -2)).norm(), 1e-10);
}

TEST(SimulateElasticMesh, TractionIsAThirdOfTheAreaAtEachCorner) {
    const Positions positions{{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {9, 9, 9}};
    Positions forces(4, Eigen::Vector3d::Zero());
    add_traction({0, 1, 2}, {0, 5, 7}, positions, forces);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_LT((forces[i] - Eigen::Vector3d(0, 5, 7)).norm(), 1e-14);
    EXPECT_EQ(forces[3], Eigen::Vector3d::Zero());
}

} // namespace
} // namespace tandem::simulate
