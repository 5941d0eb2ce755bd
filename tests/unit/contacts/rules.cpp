// SPDX-License-Identifier: MIT
// Rules in canonical order do not depend on the order of corners and tetrahedra, and distinguish touching
// bodies from separate ones.
#include "tests/support/test.h"
#include "tests/unit/contacts/pairs.h"

#include "tests/support/contact_rules.h"

namespace tandem::unit_test {
namespace {

using Order = std::array<unsigned, 4>;

template<class Real>
Corners<Real> reordered(const Corners<Real>& c, const Order& order) {
    return {c[order[0]], c[order[1]], c[order[2]], c[order[3]]};
}

/// Bit i: the face opposite corner i of the reordered tetrahedron.
unsigned reordered(unsigned faces, const Order& order) {
    unsigned result = 0;
    for (unsigned i = 0; i < 4; ++i) result |= (faces >> order[i] & 1u) << i;
    return result;
}

constexpr unsigned edge_ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

/// A feature of the reordered tetrahedra in the numbering of the original ones.
unsigned original(unsigned feature, const Order& a, const Order& b) {
    const bool is_b = feature < 8 ? feature >= 4 : feature >= 32;
    const auto& own = is_b ? b : a;
    const auto& other = is_b ? a : b;
    if (feature < 8) return (is_b ? 4 : 0) + own[feature % 4];
    const unsigned edge = (feature - 8) % 24 / 4;
    const auto [low, high] = std::minmax(own[edge_ends[edge][0]], own[edge_ends[edge][1]]);
    const unsigned number = low == 0 ? high - 1 : low + high;
    return (is_b ? 32 : 8) + 4 * number + other[feature % 4];
}

template<class Real>
class ContactsRules : public testing::Test {
protected:
    static std::vector<Contact<Real>> contacts(const TetrahedronPair<Real>& pair, ContactRule rule,
                                               ContactCounts& counts) {
        return reference_contacts(pair.given_a(), pair.given_b(), counts, {rule, DecisionPrecision::fp32});
    }

    static void sort(std::vector<Contact<Real>>& contacts) {
        std::sort(contacts.begin(), contacts.end(), [](auto& p, auto& q) { return p.feature < q.feature; });
    }

    TetrahedronPair<Real> next(int i) {
        return maker.make(static_cast<typename PairMaker<Real>::Family>(i % PairMaker<Real>::family_count));
    }

    PairMaker<Real> maker;
};

using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(ContactsRules, Reals);

const std::vector<ContactRule> canonical_rules = support::canonical_contact_rules();

TYPED_TEST(ContactsRules, OrderOfCornersChangesFeatureNumbersOnly) {
    std::size_t seen = 0;
    for (int i = 0; i < 700; ++i) {
        const auto pair = this->next(i);
        for (const auto rule : canonical_rules) {
            ContactCounts counts;
            const auto expected = this->contacts(pair, rule, counts);
            Order a{0, 1, 2, 3}, b{3, 1, 0, 2};
            for (int turn = 0; turn < 24; ++turn) {
                auto other = pair;
                other.a = reordered(pair.a, a);
                other.b = reordered(pair.b, b);
                other.boundary_a = reordered(pair.boundary_a, a);
                other.boundary_b = reordered(pair.boundary_b, b);
                ContactCounts other_counts;
                auto found = this->contacts(other, rule, other_counts);
                for (auto& contact : found) contact.feature = original(contact.feature, a, b);
                this->sort(found);
                ASSERT_EQ(found, expected) << "pair " << i << " rule " << static_cast<int>(rule);
                ASSERT_EQ(other_counts, counts) << "pair " << i;
                std::next_permutation(a.begin(), a.end());
                if (turn % 5 == 0) std::next_permutation(b.begin(), b.end());
            }
            seen += expected.size();
        }
    }
    EXPECT_GT(seen, 1000u);
}

TYPED_TEST(ContactsRules, SwappingTheTwoReversesTheNormalOnly) {
    std::size_t seen = 0;
    for (int i = 0; i < 2000; ++i) {
        const auto pair = this->next(i);
        for (const auto rule : canonical_rules) {
            ContactCounts counts, other_counts;
            const auto expected = this->contacts(pair, rule, counts);
            auto found =
                this->contacts({pair.b, pair.a, pair.boundary_b, pair.boundary_a}, rule, other_counts);
            for (auto& contact : found) {
                auto& f = contact.feature;
                f = f < 8 ? (f + 4) % 8 : f < 32 ? f + 24 : f - 24;
                for (auto& x : contact.normal) x = TypeParam(0) - x;
            }
            this->sort(found);
            ASSERT_EQ(found, expected) << "pair " << i << " rule " << static_cast<int>(rule);
            ASSERT_EQ(other_counts, counts) << "pair " << i;
            seen += expected.size();
        }
    }
    EXPECT_GT(seen, 1000u);
}

TYPED_TEST(ContactsRules, PowersOfTwoScaleContactsExactly) {
    const int most = std::numeric_limits<TypeParam>::max_exponent;
    for (int i = 0; i < 300; ++i) {
        const auto pair = this->maker.make(PairMaker<TypeParam>::generic);
        for (const auto rule : canonical_rules)
            for (const int power : {-most * 2 / 3, -3, most * 2 / 3}) {
                const auto scaled = [power](TypeParam x) { return std::ldexp(x, power); };
                ContactCounts counts, other_counts;
                auto expected = this->contacts(pair, rule, counts);
                for (auto& contact : expected) {
                    for (auto& x : contact.point) x = scaled(x);
                    contact.depth = scaled(contact.depth);
                }
                auto other = pair;
                other.a = changed(pair.a, scaled);
                other.b = changed(pair.b, scaled);
                ASSERT_EQ(this->contacts(other, rule, other_counts), expected) << i << " at 2^" << power;
                ASSERT_EQ(other_counts, counts);
            }
    }
}

TYPED_TEST(ContactsRules, EveryNumberIsFiniteEveryNormalOfLengthOneEveryFeatureOnce) {
    auto all = canonical_rules;
    all.push_back(ContactRule::published);
    std::size_t seen = 0;
    for (int i = 0; i < 7000; ++i) {
        const auto pair = this->next(i);
        for (const auto rule : all) {
            ContactCounts counts;
            int last = -1;
            for (const auto& contact : this->contacts(pair, rule, counts)) {
                const auto& n = contact.normal;
                ASSERT_LT(last, static_cast<int>(contact.feature));
                last = static_cast<int>(contact.feature);
                ASSERT_LT(last, 56);
                for (const auto x : contact.point) ASSERT_TRUE(std::isfinite(x));
                ASSERT_TRUE(std::isfinite(contact.depth));
                ASSERT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1,
                            8 * std::numeric_limits<TypeParam>::epsilon());
                ++seen;
            }
        }
    }
    EXPECT_GT(seen, 5000u);
}

TYPED_TEST(ContactsRules, DepthAndNormalOfABoxLikeOverlapAreKnown) {
    // The top face of the block lies in z = 0; the wedge's lower face reaches 1/4 below it.
    const Corners<TypeParam> block{{{-4, -4, 0}, {4, -4, 0}, {0, 4, 0}, {0, 0, -4}}};
    const Corners<TypeParam> wedge{
        {{0, 0, 3}, {-1, -1, TypeParam(-0.25)}, {1, -1, TypeParam(-0.25)}, {0, 1, TypeParam(-0.25)}}};
    const std::map<ContactRule, std::size_t> sizes{{ContactRule::sat, 6},        {ContactRule::clip, 6},
                                                   {ContactRule::restricted, 6}, {ContactRule::vertex, 3},
                                                   {ContactRule::consistent, 3}, {ContactRule::growth, 6}};
    for (const auto rule : canonical_rules) {
        ContactCounts counts;
        const auto found = this->contacts({block, wedge}, rule, counts);
        if (sizes.contains(rule)) {
            EXPECT_EQ(found.size(), sizes.at(rule));
        }
        ASSERT_FALSE(found.empty());
        for (const auto& contact : found) {
            EXPECT_NEAR(contact.depth, -0.25, 1e-6);
            EXPECT_NEAR(contact.normal[2], 1, support::has_trait(rule, TANDEM_CUTS_POLYGONS) ? 1e-3 : 1e-6);
        }
    }
}

TYPED_TEST(ContactsRules, PublishedIgnoresEdgesOfAAndSmallTetrahedra) {
    const Corners<TypeParam> block{{{-4, -4, 0}, {4, -4, 0}, {0, 4, 0}, {0, 0, -4}}};
    const Corners<TypeParam> cone{{{0, 0, TypeParam(-0.5)}, {-1, -1, 2}, {1, -1, 2}, {0, 1, 2}}};
    ContactCounts counts;
    const auto features = [&](const Corners<TypeParam>& a, const Corners<TypeParam>& b, TypeParam scale) {
        const auto by = [scale](TypeParam x) { return x * scale; };
        std::vector<unsigned> result;
        for (const auto& contact :
             this->contacts({changed(a, by), changed(b, by), 15, 8}, ContactRule::published, counts))
            result.push_back(contact.feature);
        return result;
    };
    EXPECT_EQ(this->contacts({block, cone, 8, 15}, ContactRule::published, counts).size(), 4u);
    EXPECT_EQ(features(cone, block, 1), (std::vector<unsigned>{0}));
    EXPECT_EQ(features(cone, block, TypeParam(1e-7)), (std::vector<unsigned>{}));
}

/// The six tetrahedra of a unit cube at `corner`, one for each order of the axes, with their boundary faces.
template<class Real>
std::vector<std::pair<Corners<Real>, unsigned>> cube(const std::array<Real, 3>& corner) {
    std::vector<std::pair<Corners<Real>, unsigned>> result;
    std::array<unsigned, 3> order{0, 1, 2};
    do {
        Corners<Real> local{};
        for (unsigned i = 0; i < 3; ++i) {
            local[i + 1] = local[i];
            local[i + 1][order[i]] = 1;
        }
        unsigned boundary = 0;
        for (unsigned face = 0; face < 4; ++face)
            for (unsigned axis = 0; axis < 3; ++axis) {
                Real sum = 0;
                for (unsigned i = 0; i < 4; ++i) sum += i == face ? 0 : local[i][axis];
                if (sum == 0 || sum == 3) boundary |= 1u << face;
            }
        result.push_back({moved<Real>(local, corner), boundary});
    } while (std::next_permutation(order.begin(), order.end()));
    return result;
}

/// The deepest contact of two cubes that only touch, the upper one displaced sideways on the lower one.
template<class Real>
Real deepest_of_touching_cubes(ContactRule rule, std::size_t& sideways) {
    Real deepest = 0;
    for (const auto& [a, boundary_a] : cube<Real>({0, 0, 0}))
        for (const auto& [b, boundary_b] : cube<Real>({Real(0.25), Real(0.125), 1})) {
            ContactCounts counts;
            for (const auto& contact : reference_contacts<Real>({a, boundary_a}, {b, boundary_b}, counts,
                                                                {rule, DecisionPrecision::fp32})) {
                deepest = std::max(deepest, std::abs(contact.depth));
                sideways +=
                    std::abs(contact.depth) > Real(1e-3) && std::abs(contact.normal[2]) < Real(0.5) ? 1 : 0;
            }
        }
    return deepest;
}

TYPED_TEST(ContactsRules, CubesThatTouchAreNotDeepBySatAndClip) {
    std::size_t sideways = 0;
    for (const auto rule : {ContactRule::sat, ContactRule::clip, ContactRule::growth})
        EXPECT_LE(deepest_of_touching_cubes<TypeParam>(rule, sideways),
                  32 * std::numeric_limits<TypeParam>::epsilon());
    EXPECT_EQ(sideways, 0u);
}

/// Known limitation: the rule's normal is that of the most opposing boundary faces, which may not be the
/// touching ones.
TYPED_TEST(ContactsRules, CubesThatTouchAreDeepSidewaysByOpposing) {
    std::size_t sideways = 0;
    EXPECT_GT(deepest_of_touching_cubes<TypeParam>(ContactRule::opposing, sideways), TypeParam(0.1));
    EXPECT_GT(sideways, 0u);
}

} // namespace
} // namespace tandem::unit_test
