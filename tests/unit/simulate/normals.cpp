// SPDX-License-Identifier: MIT
#include "scenes/motion.h"
#include "base/random.h"
#include "scenes/simulate/algebra.h"
#include "scenes/simulate/boundary.h"
#include "scenes/simulate/cone.h"
#include "scenes/simulate/surface_normals.h"
#include "tests/support/test.h"
#include "tests/unit/simulate/support.h"

#include <numbers>

namespace tandem::simulate {
namespace {

using namespace unit_test;

Eigen::Vector3d any_direction(Random& random) { return random.direction(); }

TEST(SimulateCone, NoCombinationOfRaysIsNearerThanTheNearest) {
    Random random(5);
    int inside = 0, outside_of = 0;
    for (int trial = 0; trial < 400; ++trial) {
        std::vector<Eigen::Vector3d> rays(1 + static_cast<std::size_t>(trial) % 7);
        for (auto& ray : rays) ray = any_direction(random);
        const auto x = any_direction(random);
        const auto nearest = nearest_in_cone(rays, x);
        const Eigen::Vector3d rest = x - nearest;
        (length(rest) < 1e-7 ? inside : outside_of) += 1;
        // The nearest point of a convex cone is characterised by two conditions: the rest is perpendicular to
        // it, and no ray points along the rest.
        EXPECT_NEAR(dot(rest, nearest), 0, 1e-7);
        for (const auto& ray : rays) EXPECT_LT(dot(ray, rest), 1e-7);
    }
    EXPECT_GT(inside, 30);
    EXPECT_GT(outside_of, 100);
}

/// 1 minus the square of a value far below rounding is 1, so the distance cannot decide which point is
/// nearer; the points can.
TEST(SimulateCone, NearlyPerpendicularDirectionsAreOutside) {
    const std::vector<Eigen::Vector3d> up{Eigen::Vector3d::UnitY()};
    for (const double tilt : {0.0, 3e-9, -3e-9, 1e-7})
        EXPECT_NEAR(outside(up, {}, Eigen::Vector3d(1, tilt, 0).normalized()), 1, 1e-6) << tilt;
    EXPECT_EQ(outside({}, {}, Eigen::Vector3d::UnitX()), 0); // a cone without rays contains everything
}

TEST(SimulateCone, CrossingEdgesHaveOneCommonDirection) {
    const double r = std::sqrt(0.5);
    const std::vector<Eigen::Vector3d> one{{r, r, 0}, {-r, r, 0}}, other{{0, r, r}, {0, r, -r}};
    Random random(2);
    for (int i = 0; i < 50; ++i) {
        const auto x = moved_into_cones(one, other, any_direction(random));
        EXPECT_LT(length(x - Eigen::Vector3d::UnitY()), 1e-6);
    }
    EXPECT_LT(outside(one, other, Eigen::Vector3d::UnitY()), 1e-15);
    EXPECT_GT(outside(one, other, Eigen::Vector3d(r, r, 0)), 0.5);
}

TEST(SimulateBoundary, FacesNearAPointAreTheEquallyNearOnes) {
    const auto mesh = box({1, 1, 1});
    const Boundary boundary(mesh);
    std::vector<NearFace> faces;
    const auto count = [&](const Eigen::Vector3d& point, double slack) {
        std::size_t most = 0;
        for (std::uint32_t t = 0; t < mesh.tetrahedra.size(); ++t) {
            boundary.near(mesh, t, point, slack, faces);
            most = std::max(most, faces.size());
            for (const auto& face : faces) {
                EXPECT_NEAR(face.normal.norm(), 1, 1e-15);
                EXPECT_NEAR(face.height, 0.5 - face.normal.dot(point), 1e-15);
            }
        }
        return most;
    };
    EXPECT_EQ(count({0.1, 0.49, 0.2}, 1e-3), 1u);
    EXPECT_EQ(count({0.1, 0.5, 0.5}, 1e-3), 2u);
    EXPECT_EQ(count({0.5, 0.5, 0.4995}, 1e-3), 3u);
    EXPECT_EQ(count({0.5, 0.49, 0.2}, 1e-3), 1u);
    EXPECT_EQ(count({0.5, 0.49, 0.2}, 0.02), 2u);
}

TEST(SimulateBoundary, DistanceFromATriangleIsThatOfItsNearestPoint) {
    Random random(4);
    for (int trial = 0; trial < 100; ++trial) {
        std::array<Eigen::Vector3d, 4> p;
        for (auto& q : p) q = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
        const double found = std::sqrt(squared_distance(p[3], p[0], p[1], p[2]));
        double sampled = 10;
        constexpr int steps = 60;
        for (int i = 0; i <= steps; ++i)
            for (int j = 0; j <= steps - i; ++j)
                sampled = std::min(
                    sampled, (p[0] + (p[1] - p[0]) * i / steps + (p[2] - p[0]) * j / steps - p[3]).norm());
        EXPECT_LE(found, sampled + 1e-12);
        EXPECT_GT(found, sampled - 0.06);
    }
}

struct SurfaceContacts {
    std::vector<ContactPoint> given, set;
};

/// Contacts at a world's start by the least-translation rule, before and after set_surface_normals().
SurfaceContacts surface_contacts(World& world) {
    const auto& scene = world.finish();
    SurfaceContacts result;
    detector(scene, least_translation)(world.start, result.given);
    result.set = result.given;
    set_surface_normals(make_model(scene), world.start, result.set);
    return result;
}

bool equal(const ContactPoint& a, const ContactPoint& b) {
    return a.pair == b.pair && a.feature == b.feature && a.point == b.point && a.normal == b.normal
           && a.depth == b.depth;
}

/// Number of contacts whose normals deviate by more than `angle` (radians) from vertical.
std::size_t slanted(std::span<const ContactPoint> contacts, double angle = 1e-6) {
    return static_cast<std::size_t>(std::count_if(contacts.begin(), contacts.end(), [&](const auto& c) {
        return std::hypot(c.normal[0], c.normal[2]) > std::sin(angle);
    }));
}

/// Two cubes on edges, the upper one crossing the lower one: their normal is that of no face.
TEST(SimulateNormals, CrossingEdgesKeepTheirCommonNormal) {
    World world;
    const double quarter = std::numbers::pi / 4, sunk = 0.01;
    world.add(box({1, 1, 1}), {turn({0, 0, 1}, quarter), {0, 0, 0}});
    world.add(box({1, 1, 1}), {turn({1, 0, 0}, quarter), {0.1, std::sqrt(2.0) - sunk, 0.2}});
    const auto result = surface_contacts(world);
    ASSERT_GT(result.given.size(), 0u);
    EXPECT_EQ(slanted(result.set), 0u);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < result.set.size(); ++i) {
        EXPECT_GT(result.set[i].normal[1], 0);
        if (slanted(std::span(&result.given[i], 1), 1e-9) > 0) continue;
        ++kept;
        EXPECT_TRUE(equal(result.given[i], result.set[i])) << i;
    }
    EXPECT_GT(kept, 0u);
}

TEST(SimulateNormals, CubeOnItsEdgeOrCornerIsPushedUp) {
    const double quarter = std::numbers::pi / 4;
    const auto on_corner = product(turn({1, 0, 0}, std::atan(std::sqrt(0.5))), turn({0, 0, 1}, quarter));
    for (const bool ground_first : {true, false})
        for (const auto& [rotation, height] :
             {std::pair(turn({0, 0, 1}, quarter), std::sqrt(0.5)), {on_corner, std::sqrt(0.75)}}) {
            World world;
            if (ground_first) world.add(box({20, 1, 20}), at(0, -0.5, 0), true);
            world.add(box({1, 1, 1}), {rotation, {0.3, height - 1e-4, 0.2}});
            if (!ground_first) world.add(box({20, 1, 20}), at(0, -0.5, 0), true);
            const auto result = surface_contacts(world);
            ASSERT_GT(result.set.size(), 0u);
            EXPECT_EQ(slanted(result.set), 0u);
            for (const auto& contact : result.set) EXPECT_EQ(contact.normal[1] > 0, ground_first);
        }
}

/// Flush sides exert nothing: stacked cubes push only up and down, however deep.
TEST(SimulateNormals, CubesOnEachOtherPushUpAndDown) {
    std::size_t given = 0;
    for (const double sunk : {0.0, 1e-9, 1e-4, 0.004})
        for (const double shift : {0.0, 1e-10, 0.1}) {
            World world;
            for (int i = 0; i < 3; ++i) world.add(box({0.3, 0.3, 0.3}), at(shift * i, (0.3 - sunk) * i, 0));
            const auto result = surface_contacts(world);
            given += slanted(result.given);
            EXPECT_EQ(slanted(result.set), 0u) << sunk << " " << shift;
        }
    EXPECT_GT(given, 0u);
}

/// A corner of a cube 1e-4 below a ground, with the normal of edges that overlap by rounding only.
World corner_in_ground() {
    World world;
    world.add(box({20, 1, 20}), at(0, -0.5, 0), true);
    world.add(box({1, 1, 1}), at(0, 0.5 - 1e-4, 0));
    return world;
}

ContactPoint sideways(const Scene& scene) {
    const auto& mesh = scene.meshes[1];
    // The first tetrahedron at the corner.
    std::uint32_t at_corner = 0;
    while (std::none_of(mesh.tetrahedra[at_corner].begin(), mesh.tetrahedra[at_corner].end(),
                        [&](auto v) { return mesh.vertices[v] == Eigen::Vector3d(0.5, -0.5, 0.5); }))
        ++at_corner;
    return {.pair = {0, 6, 1, at_corner},
            .feature = 4,
            .point = {0.5, -1e-4, 0.5},
            .normal = {1, 0, 0},
            .depth = -1e-9};
}

TEST(SimulateNormals, SidewaysNormalsBecomeVerticalWithTheDepthOfThePoint) {
    auto world = corner_in_ground();
    const auto& scene = world.finish();
    std::vector<ContactPoint> contacts{sideways(scene)};
    set_surface_normals(make_model(scene), world.start, contacts);
    EXPECT_NEAR(contacts[0].normal[1], 1, 1e-12);
    EXPECT_NEAR(contacts[0].depth, -1e-4, 1e-12);
    EXPECT_EQ(contacts[0].point, sideways(scene).point);
}

TEST(SimulateNormals, ContactsOfDeformableBodiesAreUnchanged) {
    auto world = corner_in_ground();
    Elastic elastic;
    elastic.young = 1e5;
    auto mesh = box({1, 1, 1});
    for (auto& v : mesh.vertices) v += Eigen::Vector3d(0, 0.5 - 1e-4, 0);
    world.add_soft(std::move(mesh), elastic);
    const auto& scene = world.finish();
    std::vector<ContactPoint> contacts{sideways(scene)};
    contacts[0].pair.body_b = 2;
    const auto before = contacts;
    set_surface_normals(make_model(scene), world.start, contacts);
    EXPECT_TRUE(equal(contacts[0], before[0]));
}

} // namespace
} // namespace tandem::simulate
