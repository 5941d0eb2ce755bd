// SPDX-License-Identifier: MIT
// Rules restricted, vertex, consistent and growth on pairs whose answers are known by hand and differ between
// the rules.
#include "tests/support/test.h"
#include "tests/unit/contacts/pairs.h"

namespace tandem::unit_test {
namespace {

template<class Real>
class ContactsBoundary : public testing::Test {
protected:
    using Vector = std::array<Real, 3>;

    /// Its face 3 lies in z = 0, normal up; below its face 2, y + z = -4.
    const Corners<Real> block{{{-4, -4, 0}, {4, -4, 0}, {0, 4, 0}, {0, 0, -4}}};
    /// Corner 0 is 1/2 below the block's top; the other three are above it.
    const Corners<Real> cone{{{0, 0, Real(-0.5)}, {-1, -1, 2}, {1, -1, 2}, {0, 1, 2}}};
    /// Like `cone` in corner 0, but first in canonical order.
    const Corners<Real> leaning{{{0, 0, Real(-0.5)}, {-9, -1, 2}, {1, -1, 2}, {0, 1, 2}}};
    /// Corner 0 is 1/4 below the block's top; the other three are outside through its face 2.
    const Corners<Real> spike{{{0, -2, Real(-0.25)},
                               {Real(-0.25), -6, Real(-0.25)},
                               {Real(0.25), -6, Real(-0.25)},
                               {0, -6, Real(-0.5)}}};
    const Vector up{0, 0, 1}, down{0, 0, -1};
    static constexpr unsigned all = 15, top = 8, sides = 7;

    std::vector<Contact<Real>> contacts(ContactRule rule, const Corners<Real>& a, const Corners<Real>& b,
                                        unsigned boundary_a = all, unsigned boundary_b = all) {
        return reference_contacts<Real>({a, boundary_a}, {b, boundary_b}, counts,
                                        {rule, DecisionPrecision::fp32});
    }

    /// Expects contacts with exactly these features, all with one normal and depth.
    static void expect_all(const std::vector<Contact<Real>>& found, const std::vector<unsigned>& features,
                           const Vector& normal, Real depth) {
        std::vector<unsigned> given;
        for (const auto& contact : found) {
            given.push_back(contact.feature);
            for (unsigned i = 0; i < 3; ++i) EXPECT_NEAR(contact.normal[i], normal[i], tolerance);
            EXPECT_NEAR(contact.depth, depth, tolerance);
        }
        EXPECT_EQ(given, features);
    }

    static inline const Real tolerance = 16 * std::numeric_limits<Real>::epsilon();
    ContactCounts counts;
};

using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(ContactsBoundary, Reals);

TYPED_TEST(ContactsBoundary, AShallowCornerInALargeFaceIsOneVertex) {
    const auto half = TypeParam(-0.5);
    for (const auto& other : {this->cone, this->leaning}) {
        const auto found = this->contacts(ContactRule::vertex, this->block, other);
        this->expect_all(found, {4}, this->up, half);
        EXPECT_EQ(found.at(0).point, other[0]);
        this->expect_all(this->contacts(ContactRule::vertex, other, this->block), {0}, this->down, half);
    }
    EXPECT_EQ(this->counts, ContactCounts{});
}

TYPED_TEST(ContactsBoundary, ConsistentHasAContactForEveryEdgeThatLeaves) {
    const auto half = TypeParam(-0.5);
    for (const auto& other : {this->cone, this->leaning}) {
        const auto found = this->contacts(ContactRule::consistent, this->block, other);
        this->expect_all(found, {32 + 3, 32 + 7, 32 + 11}, this->up, half);
        for (const auto& contact : found) EXPECT_EQ(contact.point, other[0]);
        this->expect_all(this->contacts(ContactRule::consistent, other, this->block), {8 + 3, 8 + 7, 8 + 11},
                         this->down, half);
    }
}

TYPED_TEST(ContactsBoundary, VertexUsesTheNearestFaceAndConsistentTheFaceOfTheEdges) {
    const TypeParam root = std::sqrt(TypeParam(0.5));
    this->expect_all(this->contacts(ContactRule::vertex, this->block, this->spike), {4}, this->up,
                     TypeParam(-0.25));
    this->expect_all(this->contacts(ContactRule::consistent, this->block, this->spike),
                     {32 + 2, 32 + 6, 32 + 10}, {0, -root, -root}, TypeParam(-1.75) * root);
}

TYPED_TEST(ContactsBoundary, InnerFacesGiveCornersNoNormal) {
    using enum ContactRule;
    // Two of the faces below the cone's corner are equally near; the one with the greater x is first in
    // order.
    const TypeParam root = 1 / std::sqrt(TypeParam(6));
    this->expect_all(this->contacts(vertex, this->block, this->cone, this->sides), {4},
                     {2 * root, root, -root}, TypeParam(-3.5) * root);
    EXPECT_TRUE(this->contacts(consistent, this->block, this->cone, this->sides).empty());
    EXPECT_TRUE(this->contacts(consistent, this->block, this->spike, this->top).empty());
    for (const auto rule : {vertex, consistent}) {
        EXPECT_TRUE(this->contacts(rule, this->block, this->cone, 0).empty());
        EXPECT_FALSE(this->contacts(rule, this->block, this->cone, this->top, 0).empty());
    }
    EXPECT_EQ(this->counts, ContactCounts{});
}

TYPED_TEST(ContactsBoundary, ACornerWhoseEdgesStayInsideHasAVertexContactOnly) {
    const auto quarter = [](TypeParam x) { return x / 4; };
    const auto inside = moved<TypeParam>(changed(this->cone, quarter), {0, 0, -1});
    EXPECT_TRUE(this->contacts(ContactRule::consistent, this->block, inside).empty());
    EXPECT_EQ(this->contacts(ContactRule::vertex, this->block, inside).size(), 4u);
    EXPECT_FALSE(this->contacts(ContactRule::sat, this->block, inside).empty());
}

TYPED_TEST(ContactsBoundary, ACornerThatTouchesHasNoDepth) {
    const auto touching = moved<TypeParam>(this->cone, {0, 0, TypeParam(0.5)});
    this->expect_all(this->contacts(ContactRule::vertex, this->block, touching), {4}, this->up, 0);
    this->expect_all(this->contacts(ContactRule::consistent, this->block, touching), {35, 39, 43}, this->up,
                     0);
    this->expect_all(this->contacts(ContactRule::growth, this->block, touching), {4}, this->up, 0);
}

TYPED_TEST(ContactsBoundary, RestrictedIgnoresInnerFacesThatSatUses) {
    // Outside through the block's face 2 except for a corner; 3/4 below its top.
    const TypeParam low = TypeParam(-0.5);
    const Corners<TypeParam> b{
        {{0, -3, low}, {TypeParam(0.25), -4, low}, {TypeParam(-0.25), -4, low}, {0, -4, TypeParam(-0.75)}}};
    const auto sat = this->contacts(ContactRule::sat, this->block, b, this->top, 0);
    ASSERT_FALSE(sat.empty());
    EXPECT_GT(sat[0].depth, TypeParam(-0.36));
    EXPECT_LT(sat[0].normal[1], TypeParam(-0.5));
    const auto restricted = this->contacts(ContactRule::restricted, this->block, b, this->top, 0);
    ASSERT_EQ(restricted.size(), sat.size());
    for (std::size_t i = 0; i < sat.size(); ++i) {
        EXPECT_EQ(restricted[i].feature, sat[i].feature);
        EXPECT_EQ(restricted[i].point, sat[i].point);
        EXPECT_EQ(restricted[i].normal, this->up);
        EXPECT_NEAR(restricted[i].depth, TypeParam(-0.75), this->tolerance);
    }
    EXPECT_TRUE(this->contacts(ContactRule::restricted, this->block, b, 0, 0).empty());
    EXPECT_FALSE(this->contacts(ContactRule::restricted, this->block, b, 0, 1).empty());
}

TYPED_TEST(ContactsBoundary, RestrictedUsesProductsOfBoundaryEdgesOnly) {
    // The edge along x on top of a is 1/4 above the edge along y at the bottom of b.
    const TypeParam low = TypeParam(-0.25);
    const Corners<TypeParam> a{{{-1, 0, 0}, {1, 0, 0}, {0, -1, -1}, {0, 1, -1}}};
    const Corners<TypeParam> b{{{0, -1, low}, {0, 1, low}, {-1, 0, 1}, {1, 0, 1}}};
    const auto depth = [&](unsigned boundary_a, unsigned boundary_b) {
        const auto found = this->contacts(ContactRule::restricted, a, b, boundary_a, boundary_b);
        return found.empty() ? TypeParam(0) : found[0].depth;
    };
    // In either tetrahedron, faces 2 and 3 contain edge 01; faces 0 and 1 contain edge 23, which is parallel
    // to edge 01 of the other.
    for (const unsigned face : {4u, 8u})
        for (const unsigned other : {4u, 8u}) EXPECT_NEAR(depth(face, other), low, this->tolerance);
    for (const unsigned face : {1u, 2u}) {
        EXPECT_LT(depth(face, 12), low * TypeParam(1.2));
        EXPECT_LT(depth(12, face), low * TypeParam(1.2));
    }
}

TYPED_TEST(ContactsBoundary, RestrictedIsSatWhereAllFacesAreOnTheBoundary) {
    PairMaker<TypeParam> maker;
    std::size_t seen = 0, different = 0;
    for (int i = 0; i < 2000; ++i) {
        const auto pair = maker.make(PairMaker<TypeParam>::generic);
        const auto sat = this->contacts(ContactRule::sat, pair.a, pair.b);
        ASSERT_EQ(this->contacts(ContactRule::restricted, pair.a, pair.b), sat) << i;
        seen += sat.size();
        const auto less = this->contacts(ContactRule::restricted, pair.a, pair.b, 1, 1);
        ASSERT_EQ(less.size(), sat.size());
        for (std::size_t k = 0; k < sat.size(); ++k) {
            EXPECT_LE(less[k].depth, sat[k].depth);
            different += less[k].depth < sat[k].depth ? 1 : 0;
        }
    }
    EXPECT_GT(seen, 1000u);
    EXPECT_GT(different, 500u);
}

/// A tetrahedron with legs of 4 along the axes and centre (1, 1, 1), and its mirror image whose first corner
/// is t. Their Minkowski difference is the former at twice the size. So its facets are -x, -y, -z and x + y +
/// z, at 2 and 2 / sqrt(3) from the difference of the centres.
template<class Real>
std::pair<Corners<Real>, Corners<Real>> mirrored(const std::array<Real, 3>& t) {
    const Corners<Real> a{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}}};
    return {a, moved<Real>(changed(a, [](Real x) { return -x; }), t)};
}

TYPED_TEST(ContactsBoundary, GrowthReachesAnotherFacetThanTheLeastTranslation) {
    // The centres differ by (-1, 3/4, 3/4): half of the way out along -x, a quarter along x + y + z.
    const auto [a, b] = mirrored<TypeParam>({1, TypeParam(2.75), TypeParam(2.75)});
    const TypeParam third = 1 / std::sqrt(TypeParam(3));
    const auto sat = this->contacts(ContactRule::sat, a, b);
    const auto growth = this->contacts(ContactRule::growth, a, b);
    ASSERT_EQ(growth.size(), sat.size());
    ASSERT_FALSE(growth.empty());
    for (std::size_t i = 0; i < growth.size(); ++i) {
        EXPECT_EQ(growth[i].feature, sat[i].feature);
        EXPECT_EQ(growth[i].point, sat[i].point);
        EXPECT_EQ(growth[i].normal, (std::array<TypeParam, 3>{-1, 0, 0}));
        EXPECT_NEAR(growth[i].depth, -1, this->tolerance); // x is 0..1 in both
        EXPECT_NEAR(sat[i].normal[0], third, this->tolerance);
        EXPECT_NEAR(sat[i].depth, TypeParam(-1.5) * third, this->tolerance);
    }
    for (const auto& contact : this->contacts(ContactRule::growth, a, b, 0, 0))
        EXPECT_EQ(contact.normal, growth[0].normal);
}

TYPED_TEST(ContactsBoundary, GrowthOfConcentricPairsUsesTheLeastTranslation) {
    const TypeParam third = 1 / std::sqrt(TypeParam(3));
    for (const TypeParam off : {TypeParam(0), -2 * std::numeric_limits<TypeParam>::epsilon()}) {
        const auto [a, b] = mirrored<TypeParam>({2 + off, 2, 2});
        const auto found = this->contacts(ContactRule::growth, a, b);
        ASSERT_FALSE(found.empty());
        for (const auto& contact : found) {
            for (const auto x : contact.normal) EXPECT_NEAR(x, third, this->tolerance);
            EXPECT_NEAR(contact.depth, -2 * third, this->tolerance);
        }
    }
    // For distances above rounding, the direction is that of the centres.
    const auto [a, b] = mirrored<TypeParam>({TypeParam(2) - TypeParam(0.001), 2, 2});
    EXPECT_EQ(this->contacts(ContactRule::growth, a, b).at(0).normal[0], -1);
}

} // namespace
} // namespace tandem::unit_test
