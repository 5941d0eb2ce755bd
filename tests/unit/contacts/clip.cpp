// SPDX-License-Identifier: MIT
// Rule clip against the exact surface of the common part, for thin tetrahedra in any direction.
#include "tests/support/test.h"
#include "tests/unit/contacts/pairs.h"

#include "geometry/contact_truth.h"
#include "harness/verify/accuracy/answer_errors.h"
#include "tests/support/exact_surface.h"
#include "tests/support/long_form.h"
#include "tests/support/oracle_pairs.h"

namespace tandem::unit_test::contacts_clip {
namespace {

using namespace support;

/// Shapes by the axes along which they are thin.
enum class Shape { fat, plate, needle, cap, wedge, count };

/// A random tetrahedron of this shape and relative thickness.
TetraCorners shaped(Shape shape, double thickness, Random& random) {
    TetraCorners t;
    for (auto& corner : t)
        for (double& x : corner) x = random.uniform(-1, 1);
    for (unsigned k = 0; k < 3; ++k) {
        if (shape == Shape::cap) t[3][k] = (t[0][k] + t[1][k] + t[2][k]) / 3 + thickness * t[3][k];
        if (shape == Shape::wedge)
            for (unsigned i = 2; i < 4; ++i) t[i][k] = t[i - 2][k] + thickness * t[i][k];
        for (auto& corner : t)
            if ((shape == Shape::plate && k == 2) || (shape == Shape::needle && k > 0))
                corner[k] *= thickness;
    }
    return t;
}

TetraCorners turned(TetraCorners t, const Eigen::Matrix3d& turn) {
    for (auto& corner : t) {
        const Eigen::Vector3d p = turn * Eigen::Vector3d(corner[0], corner[1], corner[2]);
        corner = {p[0], p[1], p[2]};
    }
    return t;
}

/// Turns to any direction, or by right angles, which keep thin tetrahedra thin when they are rounded.
Eigen::Matrix3d random_turn(bool by_right_angles, Random& random) {
    if (!by_right_angles) return random.rotation().toRotationMatrix();
    const auto shift = static_cast<Eigen::Index>(random.next() % 3);
    Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
    for (Eigen::Index k = 0; k < 3; ++k) turn(k, (k + shift) % 3) = 1;
    return turn;
}

double norm(const std::array<double, 3>& a) { return std::hypot(a[0], a[1], a[2]); }

/// What the pairs of one family have: those that the rule should clip, and those of them that it leaves to
/// rule sat.
struct Tally {
    std::size_t pairs = 0, clipped = 0, left = 0;
    double depth = 0; ///< largest error in u L
    double angle = 0; ///< largest in degrees
};

/// Compares the contacts with what the exact surface demands. Without a direction they are those of sat, also
/// where the rounding of coordinates could make a touch of the pair, or nest one of the two.
template<class Real>
void compare(const OraclePair& pair, Tally& tally) {
    const auto truth = contact_truth(pair.a, pair.b);
    if (!truth || truth->relation != Relation::overlapping) return;
    ContactCounts counts;
    const auto contacts = reference_contacts<Real>({narrowed<Real>(pair.a)}, {narrowed<Real>(pair.b)}, counts,
                                                   {ContactRule::clip, DecisionPrecision::none});
    if (counts.degenerate != 0 || contacts.empty()) return;
    const ExactSurface surface(pair.a, pair.b);
    const double side = norm(surface.normal);
    if (!surface.is_sure || std::abs(side * 256 / surface.total - 1) < 1e-3) return;
    const double unit = std::max(longest_edge(pair.a), longest_edge(pair.b))
                        * double(std::numeric_limits<Real>::epsilon()) / 2;
    const auto& contact = contacts.front();
    const double depth = -static_cast<double>(contact.depth);
    std::array<double, 3> normal;
    std::copy_n(contact.normal.begin(), 3, normal.begin());
    ++tally.pairs;
    const bool has_side = side * 256 > surface.total;
    tally.clipped += has_side ? 1 : 0;
    const std::array<std::array<double, 3>, 1> exact{surface.normal};
    const double angle = nearest_angle(exact, normal);
    auto along = surface.normal;
    for (double& x : along) x = has_side ? x / side : 0;
    const double error = std::abs(depth - surface.extent(along)) / unit;
    const double error_of_sat = std::abs(depth - truth->depth) / unit;
    if (!has_side || (error_of_sat < 16 && (angle > 0.01 || error > 256))) {
        tally.left += has_side ? 1 : 0;
        tally.depth = std::max(tally.depth, error_of_sat);
        return;
    }
    tally.depth = std::max(tally.depth, error);
    tally.angle = std::max(tally.angle, angle);
}

template<class Real>
class ContactsClip : public testing::Test {
protected:
    static Tally tally(Shape a, Shape b, double thickness, bool by_right_angles) {
        Tally result;
        Random random(static_cast<unsigned>(a) * 8 + static_cast<unsigned>(b) + 1);
        for (int i = 0; i < (long_form() ? 1000 : 16); ++i) {
            const auto make = [&](Shape shape) {
                return turned(shaped(shape, thickness, random), random_turn(by_right_angles, random));
            };
            const OraclePair pair{make(a), make(b)};
            compare<Real>(changed(pair, as_float), result);
        }
        return result;
    }

    static double depth_of(const TetraCorners& a, const TetraCorners& b) {
        ContactCounts counts;
        const auto contacts = reference_contacts<Real>({narrowed<Real>(a)}, {narrowed<Real>(b)}, counts,
                                                       {ContactRule::clip, DecisionPrecision::fp32});
        return contacts.empty() ? 0 : -static_cast<double>(contacts.front().depth);
    }
};

using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(ContactsClip, Reals);

// The limits have room over what 350,000 random pairs need, of which a quarter overlap: in double 17,000 u L,
// which are 2e-12 L, and 4e-5 degrees. The pairs that are left are thinner than 32 u L.
TYPED_TEST(ContactsClip, FollowsTheExactSurfaceOfThinTetrahedraLong) {
    constexpr bool is_float = sizeof(TypeParam) == 4;
    Tally all;
    for (unsigned shapes = 0; shapes < 25; ++shapes)
        for (const double thickness : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7})
            for (const bool by_right_angles : {false, true}) {
                const auto a = static_cast<Shape>(shapes / 5), b = static_cast<Shape>(shapes % 5);
                const auto tally = this->tally(a, b, thickness, by_right_angles);
                EXPECT_LT(tally.depth, is_float ? 256 : 0x1p17) << shapes << " of thickness " << thickness;
                EXPECT_LT(tally.angle, is_float ? 0.01 : 1e-3) << shapes << " of thickness " << thickness;
                all.pairs += tally.pairs;
                all.clipped += tally.clipped;
                all.left += tally.left;
            }
    EXPECT_GT(all.clipped, all.pairs / 3);
    EXPECT_GT(all.pairs, 1000u);
    EXPECT_LT(all.left, is_float ? all.clipped / 20 : 1);
}

// Plates that cross, as thick as a few roundings of their coordinates. No side of the common part is larger
// than the opposite one, so that the least translation counts.
TYPED_TEST(ContactsClip, CrossingPlatesHaveTheLeastTranslation) {
    for (const double e : {1e-3, 1e-5, 1e-6, 1e-7}) {
        const auto pair = changed(OraclePair{{{{-1, -1, 0}, {1, -1, e}, {0, 1, 0}, {.1, .2, -e}}},
                                             {{{0, -.5, -1}, {e, -.6, 1}, {0, 1.5, 0}, {-e, .2, .1}}}},
                                  as_float);
        const auto truth = contact_truth(pair.a, pair.b);
        ASSERT_TRUE(truth);
        EXPECT_GT(truth->depth, 0.69);
        EXPECT_NEAR(this->depth_of(pair.a, pair.b), truth->depth, 1e-6) << e;
    }
}

/// The depth in each of the 24 directions that right angles make.
template<class Depth>
void expect_in_every_direction(const OraclePair& pair, double expected, double allowed, Depth depth) {
    const std::array<std::array<int, 3>, 6> orders{
        {{1, 2, 3}, {2, 3, 1}, {3, 1, 2}, {-2, -1, -3}, {-1, -3, -2}, {-3, -2, -1}}};
    for (const auto& order : orders)
        for (const auto& [x, y, z] : {std::array{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}) {
            const std::array signs{x, y, z};
            auto turned_pair = pair;
            for (auto* solid : {&turned_pair.a, &turned_pair.b})
                for (auto& corner : *solid) {
                    const auto given = corner;
                    for (unsigned k = 0; k < 3; ++k)
                        corner[k] = given[static_cast<unsigned>(std::abs(order[k])) - 1]
                                    * (order[k] < 0 ? -1 : 1) * signs[k];
                }
            EXPECT_NEAR(depth(turned_pair.a, turned_pair.b), expected, allowed);
            EXPECT_NEAR(depth(turned_pair.b, turned_pair.a), expected, allowed);
        }
}

// The sum is 0.0074 of the area of A's faces inside B, and most of that of B's faces inside A. It is 0.0066
// of the whole surface, above 2^-8.
TYPED_TEST(ContactsClip, DoesNotDependOnDirectionWhereTheSurfaceNearlyCancels) {
    const OraclePair pair{
        {{{-1.927, .713, .735}, {-.976, -1.728, 1.331}, {-1.11, 1.629, -.043}, {.113, .482, -.235}}},
        {{{.385, 1.286, 1.114}, {-.174, .867, .538}, {-.576, .407, -.094}, {-2.176, .073, .173}}}};
    const ExactSurface surface(pair.a, pair.b);
    const double side = norm(surface.normal);
    const double depth =
        surface.extent({surface.normal[0] / side, surface.normal[1] / side, surface.normal[2] / side});
    expect_in_every_direction(pair, depth, sizeof(TypeParam) == 4 ? 1e-4 : 1e-12,
                              [&](const auto& a, const auto& b) { return this->depth_of(a, b); });
}

// Both stand on one plane. Whether A's face there is inside B is not determined, so that the least
// translation counts.
TYPED_TEST(ContactsClip, DoesNotDependOnDirectionWithFacesInOnePlane) {
    const OraclePair pair{unit, support::moved(unit, .25, .125, 0)};
    const auto truth = contact_truth(pair.a, pair.b);
    ASSERT_TRUE(truth);
    expect_in_every_direction(pair, truth->depth, 1e-6,
                              [&](const auto& a, const auto& b) { return this->depth_of(a, b); });
}

} // namespace
} // namespace tandem::unit_test::contacts_clip
