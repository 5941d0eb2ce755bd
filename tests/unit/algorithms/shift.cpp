// SPDX-License-Identifier: MIT
// Shifts of meshes far from their own origin: where they are 0, that subtracting them is exact, and poses.
#include "algorithms/bodies/shift.h"
#include "harness/verify/world_vertices.h"
#include "scenes/digest.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

#include <gmpxx.h>

namespace tandem {
namespace {

using namespace support;
using Vector = Eigen::Vector3d;

/// A tetrahedron in the box from `low` to `low + size`, with a corner on each side.
Mesh box_at(const Vector& low, const Vector& size) {
    Mesh mesh;
    for (const auto& at : {Vector(0, 0, 0), Vector(1, 0.5, 0), Vector(0, 1, 0.5), Vector(0.5, 0, 1)})
        mesh.vertices.push_back(low + at.cwiseProduct(size));
    mesh.tetrahedra = {{0, 1, 2, 3}};
    complete_mesh(mesh, "box");
    return mesh;
}

TEST(Shift, IsZeroWithinEightExtents) {
    EXPECT_EQ(shift_of(box_at({-1, -2, 3}, {2, 4, 8})), Vector::Zero());
    EXPECT_EQ(shift_of(box_at({7.5, 7.5, -8.5}, {1, 1, 1})), Vector::Zero()) << "the middle is 8 away";
    EXPECT_EQ(shift_of(box_at({7.75, 7.75, -8.75}, {1, 1, 1})), Vector(8.25, 8.25, -8.25));
}

TEST(Shift, IsThatOfEachAxis) {
    EXPECT_EQ(shift_of(box_at({100, 100, 100}, {100, 10, 1})), Vector(0, 105, 100.5));
    EXPECT_EQ(shift_of(box_at({1, 0, 2}, {0, 0, 1})), Vector(1, 0, 0)) << "flat along x and y";
}

TEST(Shift, IgnoresVerticesWithoutATetrahedron) {
    auto mesh = box_at({1e6, 0, 0}, {1, 1, 1});
    mesh.vertices.emplace_back(0, 0, 0);
    EXPECT_EQ(shift_of(mesh), Vector(1e6 + 0.5, 0, 0));
}

/// Sterbenz's lemma, for boxes at every ratio of distance and extent from 8 on and at every scale.
TEST(Shift, IsSubtractedWithoutRounding) {
    Random random(3);
    std::uint64_t shifted = 0;
    for (int i = 0; i < 20000; ++i) {
        const double size = std::exp2(random.uniform(-300, 300)), ratio = std::exp2(random.uniform(2, 60));
        Vector low;
        for (auto& x : low) x = size * ratio * (random.next() % 2 == 0 ? 1 : -1) * random.uniform(0.5, 1);
        const auto mesh = box_at(low, size * Vector(random.uniform(), random.uniform(), random.uniform()));
        const auto shift = shift_of(mesh);
        EXPECT_EQ((std::array<double, 3>{shift.x(), shift.y(), shift.z()}),
                  centre_of(mesh, Origin::automatic))
            << "by independent code";
        for (const auto& v : mesh.vertices)
            for (int axis = 0; axis < 3; ++axis) {
                shifted += shift[axis] != 0 ? 1 : 0;
                const double difference = v[axis] - shift[axis];
                ASSERT_EQ(mpq_class(v[axis]) - mpq_class(shift[axis]), mpq_class(difference));
            }
    }
    EXPECT_GT(shifted, 100000u);
}

TEST(Shift, CentresAScene) {
    const auto near = crowd(4, 9, 1);
    EXPECT_EQ(centred(near, Origin::automatic), nullptr);
    const auto scene = with_distant_meshes(near, {1e6, 0, 40});
    EXPECT_EQ(centred(scene, Origin::world), nullptr);
    const auto digest = digest_of(scene);
    const auto moved = centred(scene, Origin::automatic);
    ASSERT_NE(moved, nullptr);
    EXPECT_EQ(digest_of(scene), digest) << "the scene itself is not changed";
    ASSERT_EQ(moved->shifts.size(), 3u);
    EXPECT_EQ(moved->shifts[1], Vector::Zero());
    for (const std::size_t mesh : {0u, 2u}) {
        EXPECT_NE(moved->shifts[mesh], Vector::Zero());
        for (std::size_t v = 0; v < scene.meshes[mesh].vertices.size(); ++v)
            EXPECT_EQ(moved->meshes[mesh].vertices[v] + moved->shifts[mesh], scene.meshes[mesh].vertices[v]);
    }
    const auto expected = near.frame(1), frame = moved->frame(1);
    for (std::size_t body = 0; body < frame.poses.size(); ++body) {
        const auto& at = frame.poses[body];
        EXPECT_EQ(at.rotation.coeffs(), scene.frame(1).poses[body].rotation.coeffs());
        if (scene.bodies[body].deformable || scene.bodies[body].mesh == 1)
            EXPECT_EQ(at.translation, scene.frame(1).poses[body].translation);
        else // the middle of the mesh has moved by its own position near the origin
            EXPECT_LT((at.translation - expected.poses[body].translation).norm(), 1.5);
    }
}

/// R c + t, where the rotation of 120 degrees about (1, 1, 1) is exact.
TEST(Shift, IsAddedToPoses) {
    const Pose pose{Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5), {1, 2, 3}};
    EXPECT_EQ(shifted(pose, {10, 20, 40}).translation, Vector(41, 12, 23));
    EXPECT_EQ(shifted(pose, {10, 20, 40}).rotation.coeffs(), pose.rotation.coeffs());
    EXPECT_EQ(shifted(pose, {0, 0, 0}).translation, pose.translation);
}

} // namespace
} // namespace tandem
