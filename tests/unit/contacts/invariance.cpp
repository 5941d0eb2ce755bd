// SPDX-License-Identifier: MIT
// Changes that must not affect the contacts of a pair: scale, position, order of its corners.
#include "tests/support/test.h"
#include "tests/unit/contacts/pairs.h"

namespace tandem::unit_test {
namespace {

template<class Real>
class ContactsInvariance : public testing::Test {
protected:
    std::vector<Contact<Real>> contacts(const TetrahedronPair<Real>& pair) {
        return reference_contacts(pair.given_a(), pair.given_b(), counts);
    }

    /// 'd' degenerate, 'r' rejected, 'm' intersecting.
    static char decision(const Corners<Real>& a, const Corners<Real>& b) {
        ContactCounts one;
        reference_contacts<Real>({a}, {b}, one);
        return one.degenerate != 0 ? 'd' : one.rejected != 0 ? 'r' : 'm';
    }

    /// The decision for every order of the corners of each tetrahedron in turn.
    static std::string decisions(const Corners<Real>& a, const Corners<Real>& b) {
        std::string result;
        std::array<unsigned, 4> order{0, 1, 2, 3};
        do {
            const auto reordered = [&](const Corners<Real>& c) {
                return Corners<Real>{c[order[0]], c[order[1]], c[order[2]], c[order[3]]};
            };
            result += decision(reordered(a), b);
            result += decision(a, reordered(b));
        } while (std::next_permutation(order.begin(), order.end()));
        return result;
    }

    /// Three integer edges whose length takes half the bits of Real, so that sums and differences are exact.
    std::array<std::array<Real, 3>, 3> integer_edges() {
        std::array<std::array<Real, 3>, 3> edges;
        for (auto& edge : edges)
            for (auto& x : edge)
                x = std::round(std::ldexp(maker.uniform(), std::numeric_limits<Real>::digits / 2));
        return edges;
    }

    static std::array<Real, 3> sum(const std::array<std::array<Real, 3>, 3>& edges, int x, int y, int z) {
        std::array<Real, 3> result;
        for (unsigned i = 0; i < 3; ++i)
            result[i] = Real(x) * edges[0][i] + Real(y) * edges[1][i] + Real(z) * edges[2][i];
        return result;
    }

    PairMaker<Real> maker;
    ContactCounts counts;
};

using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(ContactsInvariance, Reals);

TYPED_TEST(ContactsInvariance, PowersOfTwoScaleContactsExactly) {
    const int most = std::numeric_limits<TypeParam>::max_exponent;
    std::size_t seen = 0;
    for (int i = 0; i < 500; ++i) {
        const auto pair =
            this->maker.make(i % 2 == 0 ? PairMaker<TypeParam>::generic : PairMaker<TypeParam>::lattice);
        const auto expected = this->contacts(pair);
        seen += expected.size();
        for (const int power : {-most * 2 / 3, -7, 1, most * 2 / 3}) {
            const auto scaled = [power](TypeParam x) { return std::ldexp(x, power); };
            auto other = pair;
            other.a = changed(pair.a, scaled);
            other.b = changed(pair.b, scaled);
            auto wanted = expected;
            for (auto& contact : wanted) {
                std::transform(contact.point.begin(), contact.point.end(), contact.point.begin(), scaled);
                contact.depth = scaled(contact.depth);
            }
            ASSERT_EQ(this->contacts(other), wanted) << i << " at 2^" << power;
        }
    }
    EXPECT_GT(seen, 500u);
    EXPECT_EQ(this->counts.rejected % 5, 0u);
    EXPECT_EQ(this->counts.degenerate % 5, 0u);
}

TYPED_TEST(ContactsInvariance, DenormalCoordinatesGiveTheSameDecision) {
    const int power =
        std::numeric_limits<TypeParam>::min_exponent - std::numeric_limits<TypeParam>::digits + 1;
    std::size_t seen = 0;
    for (int i = 0; i < 500; ++i) {
        const auto pair = this->maker.make(PairMaker<TypeParam>::lattice);
        auto tiny = pair;
        tiny.a = changed(pair.a, [&](TypeParam x) { return std::ldexp(x, power); });
        tiny.b = changed(pair.b, [&](TypeParam x) { return std::ldexp(x, power); });
        const auto expected = this->contacts(pair);
        const auto found = this->contacts(tiny);
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t k = 0; k < found.size(); ++k) {
            EXPECT_EQ(found[k].feature, expected[k].feature);
            EXPECT_EQ(found[k].normal, expected[k].normal);
        }
        seen += found.size();
    }
    EXPECT_GT(seen, 100u);
}

TYPED_TEST(ContactsInvariance, PositionChangesPointsOnly) {
    const TypeParam far = std::ldexp(TypeParam(1), std::numeric_limits<TypeParam>::digits - 8);
    std::size_t seen = 0;
    for (int i = 0; i < 500; ++i) {
        const auto pair = this->maker.make(PairMaker<TypeParam>::lattice);
        auto other = pair;
        other.a = moved<TypeParam>(pair.a, {far, -far, far});
        other.b = moved<TypeParam>(pair.b, {far, -far, far});
        const auto expected = this->contacts(pair);
        const auto found = this->contacts(other);
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t k = 0; k < found.size(); ++k) {
            EXPECT_EQ(found[k].feature, expected[k].feature);
            EXPECT_EQ(found[k].normal, expected[k].normal);
            EXPECT_EQ(found[k].depth, expected[k].depth);
            EXPECT_NEAR(found[k].point[0] - far, expected[k].point[0], TypeParam(1) / 128);
        }
        seen += found.size();
    }
    EXPECT_GT(seen, 100u);
}

TYPED_TEST(ContactsInvariance, OrderOfCornersDoesNotChangeTheDecision) {
    std::string seen;
    for (int i = 0; i < 700; ++i) {
        const auto family =
            static_cast<typename PairMaker<TypeParam>::Family>(i % PairMaker<TypeParam>::family_count);
        const auto pair = this->maker.make(family);
        const auto all = this->decisions(pair.a, pair.b);
        ASSERT_EQ(all, std::string(all.size(), all[0])) << "pair " << i;
        seen += all[0];
    }
    for (const char decision : {'d', 'r', 'm'}) EXPECT_GT(std::count(seen.begin(), seen.end(), decision), 20);
}

TYPED_TEST(ContactsInvariance, ExactlyFlatIsDegenerateInEveryOrder) {
    for (int i = 0; i < 500; ++i) {
        const auto edges = this->integer_edges();
        const Corners<TypeParam> flat{{this->sum(edges, 0, 0, 0), this->sum(edges, 3, 1, 0),
                                       this->sum(edges, 1, -2, 0), this->sum(edges, -1, 5, 0)}};
        const Corners<TypeParam> solid{{this->sum(edges, 0, 0, 1), this->sum(edges, 1, 0, 0),
                                        this->sum(edges, 0, 1, 0), this->sum(edges, 0, 0, 0)}};
        ASSERT_EQ(this->decisions(flat, solid), std::string(48, 'd'));
    }
}

TYPED_TEST(ContactsInvariance, ExactlyTouchingIsNeverRejectedNorMissed) {
    std::size_t gaps = 0;
    for (int i = 0; i < 500; ++i) {
        const auto edges = this->integer_edges();
        const auto s = [&](int x, int y, int z) { return this->sum(edges, x, y, z); };
        const Corners<TypeParam> a{{s(0, 0, 0), s(3, 0, 0), s(0, 3, 0), s(0, 0, 3)}};
        const Corners<TypeParam> corner_on_face{{s(1, 1, 1), s(2, 2, 1), s(1, 2, 2), s(2, 1, 2)}};
        const Corners<TypeParam> edge_on_edge{{s(1, -1, 0), s(1, 1, 0), s(1, 0, -3), s(2, 0, -3)}};
        const Corners<TypeParam> apart{{s(2, 2, 1), s(2, 2, 2), s(1, 2, 2), s(2, 1, 2)}};
        for (const auto& b : {corner_on_face, edge_on_edge})
            ASSERT_EQ(this->decisions(a, b).find('r'), std::string::npos) << i;
        const auto found = this->contacts({a, corner_on_face});
        ASSERT_TRUE(std::any_of(found.begin(), found.end(), [](const auto& c) { return c.feature == 4; }))
            << i;
        gaps += this->decision(a, apart) == 'r' ? 1 : 0;
    }
    EXPECT_GT(gaps, 490u);
}

TYPED_TEST(ContactsInvariance, ContactsLieInBothTetrahedra) {
    const TypeParam allowed = 4096 * std::numeric_limits<TypeParam>::epsilon();
    // Volume of p with each face relative to the whole, without normals: independent of the rule's own test.
    const auto least_weight = [](const Corners<TypeParam>& t, const std::array<TypeParam, 3>& p) {
        const auto volume = [](const Corners<TypeParam>& c) {
            double m[3][3];
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) m[i][j] = double(c[i + 1][j]) - double(c[0][j]);
            return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
                   - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
                   + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
        };
        double least = 1;
        for (unsigned corner = 0; corner < 4; ++corner) {
            auto part = t;
            part[corner] = p;
            least = std::min(least, volume(part) / volume(t));
        }
        return least;
    };
    std::size_t seen = 0;
    for (int i = 0; i < 3000; ++i) {
        const auto pair = this->maker.make(PairMaker<TypeParam>::lattice);
        for (const auto& contact : this->contacts(pair)) {
            EXPECT_GT(least_weight(pair.a, contact.point), -allowed);
            EXPECT_GT(least_weight(pair.b, contact.point), -allowed);
            ++seen;
        }
    }
    EXPECT_GT(seen, 1000u);
}

} // namespace
} // namespace tandem::unit_test
