// SPDX-License-Identifier: MIT
// Contacts of pairs whose answer is known by hand.
#include "tests/support/test.h"
#include "tests/unit/contacts/pairs.h"

namespace tandem::unit_test {
namespace {

template<class Real>
class ContactsReference : public testing::Test {
protected:
    /// Its face 3 lies in z = 0, normal up, and its height over that face is 4.
    const Corners<Real> block{{{-4, -4, 0}, {4, -4, 0}, {0, 4, 0}, {0, 0, -4}}};
    /// Corner 0 points down; the face opposite lies 2.5 above it.
    const Corners<Real> cone{{{0, 0, Real(-0.5)}, {-1, -1, 2}, {1, -1, 2}, {0, 1, 2}}};
    const unsigned top_only = 8;

    std::vector<Contact<Real>> contacts(const Corners<Real>& a, const Corners<Real>& b,
                                        unsigned boundary_a = 15, unsigned boundary_b = 15) {
        return reference_contacts<Real>({a, boundary_a}, {b, boundary_b}, counts);
    }

    static std::vector<unsigned> features(const std::vector<Contact<Real>>& contacts) {
        std::vector<unsigned> result;
        for (const auto& contact : contacts) result.push_back(contact.feature);
        return result;
    }

    static void expect_near(const std::array<Real, 3>& value, const std::array<Real, 3>& expected) {
        for (unsigned i = 0; i < 3; ++i)
            EXPECT_NEAR(value[i], expected[i], 8 * std::numeric_limits<Real>::epsilon());
    }

    ContactCounts counts;
};

using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(ContactsReference, Reals);

TYPED_TEST(ContactsReference, CornerInTetrahedronAndItsEdgesThroughTheFace) {
    const auto found = this->contacts(this->block, this->cone, this->top_only);
    ASSERT_EQ(this->features(found), (std::vector<unsigned>{4, 35, 39, 43}));
    const TypeParam fifth = TypeParam(0.2);
    const std::array<TypeParam, 3> points[] = {
        {0, 0, TypeParam(-0.5)}, {-fifth, -fifth, 0}, {fifth, -fifth, 0}, {0, fifth, 0}};
    for (unsigned i = 0; i < 4; ++i) {
        this->expect_near(found[i].point, points[i]);
        EXPECT_EQ(found[i].normal, (std::array<TypeParam, 3>{0, 0, 1}));
        EXPECT_NEAR(found[i].depth, points[i][2], 8 * std::numeric_limits<TypeParam>::epsilon());
    }
    EXPECT_EQ(this->counts, ContactCounts{});
}

TYPED_TEST(ContactsReference, EdgesOfAThroughFacesOfBCountToo) {
    const auto found = this->contacts(this->cone, this->block, 15, this->top_only);
    ASSERT_EQ(this->features(found), (std::vector<unsigned>{0, 11, 15, 19}));
    for (const auto& contact : found) EXPECT_LT(contact.normal[2], 0);
}

TYPED_TEST(ContactsReference, TouchingCornerIsOneContactOfNoDepth) {
    const auto found =
        this->contacts(this->block, moved<TypeParam>(this->cone, {0, 0, TypeParam(0.5)}), this->top_only);
    ASSERT_EQ(this->features(found), (std::vector<unsigned>{4}));
    EXPECT_EQ(found[0].point, (std::array<TypeParam, 3>{0, 0, 0}));
    EXPECT_EQ(found[0].depth, 0);
    EXPECT_FALSE(std::signbit(found[0].depth));
}

TYPED_TEST(ContactsReference, CrossingEdgesIntersectFacesOnly) {
    // The upper edge of a runs along x, 0.25 above the lower edge of b, which runs along y.
    const Corners<TypeParam> a{{{-1, 0, 0}, {1, 0, 0}, {0, -1, -1}, {0, 1, -1}}};
    const Corners<TypeParam> b{{{0, -1, TypeParam(-0.25)}, {0, 1, TypeParam(-0.25)}, {-1, 0, 1}, {1, 0, 1}}};
    const auto found = this->contacts(a, b, 12);
    ASSERT_EQ(found.size(), 4u);
    EXPECT_EQ(this->features(found), (std::vector<unsigned>{8 + 2, 8 + 3, 32 + 2, 32 + 3}));
    EXPECT_NEAR(std::abs(found[0].point[0]), 0.2, 1e-6);
    EXPECT_NEAR(std::abs(found[2].point[1]), 0.25, 1e-6);
}

TYPED_TEST(ContactsReference, FaceAxisSeparatesPairsThatTheBoundsDoNot) {
    // x + y + z <= 1 and >= 1.7; along all directions of k = 18 the two overlap.
    const Corners<TypeParam> a{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const TypeParam c = TypeParam(0.9);
    const Corners<TypeParam> b{{{c, c, c}, {c - 1, c, c}, {c, c - 1, c}, {c, c, c - 1}}};
    EXPECT_TRUE(this->contacts(a, b).empty());
    EXPECT_EQ(this->counts, (ContactCounts{0, 1}));
}

TYPED_TEST(ContactsReference, OnlyAFaceAxisSeparatesACornerFromAFace) {
    // All edges of `above` are so steep that a plane along one of them cuts the block.
    const TypeParam gap = TypeParam(0.01);
    const Corners<TypeParam> above{{{0, 0, gap}, {-1, -1, 1}, {1, -1, 3}, {0, 1, 6}}};
    EXPECT_TRUE(this->contacts(this->block, above).empty());
    EXPECT_TRUE(this->contacts(above, this->block).empty());
    EXPECT_EQ(this->counts, (ContactCounts{0, 2}));
}

TYPED_TEST(ContactsReference, EdgeAxisSeparates) {
    const TypeParam low = TypeParam(0.125);
    const Corners<TypeParam> a{{{-1, 0, 0}, {1, 0, 0}, {0, -1, -1}, {0, 1, -1}}};
    const Corners<TypeParam> b{{{0, -1, low}, {0, 1, low}, {-1, 0, 1 + low}, {1, 0, 1 + low}}};
    EXPECT_TRUE(this->contacts(a, b).empty());
    EXPECT_EQ(this->counts, (ContactCounts{0, 1}));
    EXPECT_FALSE(this->contacts(a, moved<TypeParam>(b, {0, 0, -low}), 12).empty());
    EXPECT_EQ(this->counts, (ContactCounts{0, 1}));
}

TYPED_TEST(ContactsReference, NestedCornersCountDownToHalfTheHeight) {
    const auto tiny = [](TypeParam z) {
        return Corners<TypeParam>{
            {{0, 0, z}, {TypeParam(0.5), 0, z}, {0, TypeParam(0.5), z}, {0, 0, z - TypeParam(0.5)}}};
    };
    EXPECT_EQ(this->features(this->contacts(this->block, tiny(-1), this->top_only)),
              (std::vector<unsigned>{4, 5, 6, 7}));
    EXPECT_EQ(this->features(this->contacts(this->block, tiny(TypeParam(-1.75)), this->top_only)),
              (std::vector<unsigned>{4, 5, 6}));
    EXPECT_TRUE(this->contacts(this->block, tiny(TypeParam(-2)), this->top_only).empty());
    EXPECT_EQ(this->counts, ContactCounts{});
}

TYPED_TEST(ContactsReference, WithoutBoundaryFacesThereIsNoContact) {
    EXPECT_TRUE(this->contacts(this->block, this->cone, 0, 15).empty());
    EXPECT_TRUE(this->contacts(this->block, this->cone, 15, 0).empty());
    EXPECT_EQ(this->counts, (ContactCounts{.without_boundary = 2}));
}

TYPED_TEST(ContactsReference, TheFirstOfEquallyOpposingFacesGivesTheNormal) {
    // Both faces of a at the edge along x oppose a face of b by the same angle.
    const Corners<TypeParam> a{{{-1, 0, 0}, {1, 0, 0}, {0, -1, -1}, {0, 1, -1}}};
    const Corners<TypeParam> b{{{-1, 0, TypeParam(-0.25)}, {1, 0, TypeParam(-0.25)}, {0, -1, 1}, {0, 1, 1}}};
    const auto both = this->contacts(a, b, 12);
    const auto second = this->contacts(a, b, 8);
    ASSERT_FALSE(both.empty());
    ASSERT_FALSE(second.empty());
    EXPECT_GT(both[0].normal[1], 0); // face 2, opposite corner 2
    EXPECT_LT(second[0].normal[1], 0);
}

TYPED_TEST(ContactsReference, WithoutVolumeOrNumbersAPairIsDegenerate) {
    using Limits = std::numeric_limits<TypeParam>;
    const Corners<TypeParam> flat{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}};
    const Corners<TypeParam> point{};
    std::uint64_t expected = 0;
    for (const auto& bad : {flat, point}) {
        EXPECT_TRUE(this->contacts(bad, this->block).empty());
        EXPECT_TRUE(this->contacts(this->block, bad).empty());
        expected += 2;
    }
    for (const TypeParam value : {Limits::quiet_NaN(), Limits::infinity(), Limits::max()})
        for (unsigned corner = 0; corner < 4; ++corner) {
            auto bad = this->cone;
            bad[corner][1] = value;
            EXPECT_TRUE(this->contacts(bad, this->block).empty());
            EXPECT_TRUE(this->contacts(this->block, bad).empty());
            expected += 2;
        }
    EXPECT_EQ(this->counts, (ContactCounts{expected, 0}));
}

TYPED_TEST(ContactsReference, DigestDependsOnEveryPart) {
    const auto found = this->contacts(this->block, this->cone, this->top_only);
    ASSERT_FALSE(found.empty());
    const auto base = contact_terms(1, 2, 3, 4, found[0]);
    EXPECT_EQ(contact_terms(1, 2, 3, 4, found[0]), base);
    EXPECT_NE(contact_terms(3, 4, 1, 2, found[0]), base);
    EXPECT_NE(contact_terms(2, 1, 3, 4, found[0]), base);
    for (unsigned part = 0; part < 8; ++part) {
        auto other = found[0];
        if (part < 3) other.point[part] = std::nextafter(other.point[part], TypeParam(9));
        if (part >= 3 && part < 6)
            other.normal[part - 3] = std::nextafter(other.normal[part - 3], TypeParam(9));
        if (part == 6) other.depth = std::nextafter(other.depth, TypeParam(9));
        if (part == 7) ++other.feature;
        EXPECT_NE(contact_terms(1, 2, 3, 4, other), base) << part;
    }
}

} // namespace
} // namespace tandem::unit_test
