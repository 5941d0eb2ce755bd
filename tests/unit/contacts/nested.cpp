// SPDX-License-Identifier: MIT
// One tetrahedron inside the other, with or without shared corners, edges and faces. Rules sat and clip give
// the least translation, rule growth the translation along its own normal.
#include "tests/support/test.h"
#include "tests/unit/contacts/pairs.h"

#include "harness/verify/accuracy/answer_errors.h"
#include "tests/support/oracle_nested.h"
#include "tests/support/oracle_pairs.h"

namespace tandem::unit_test {
namespace {

using namespace support;

template<class Real>
class ContactsNested : public testing::Test {
protected:
    static constexpr double unit_roundoff = std::numeric_limits<Real>::epsilon() / 2;

    /// Common normal and depth of the pair's contacts.
    static Contact<Real> contact_of(const OraclePair& pair, ContactRule rule) {
        ContactCounts counts;
        const auto contacts = reference_contacts<Real>({narrowed<Real>(pair.a)}, {narrowed<Real>(pair.b)},
                                                       counts, {rule, DecisionPrecision::fp32});
        EXPECT_FALSE(contacts.empty());
        return contacts.empty() ? Contact<Real>{} : contacts.front();
    }

    static std::array<double, 3> normal_of(const Contact<Real>& contact) {
        std::array<double, 3> normal;
        std::copy_n(contact.normal.begin(), 3, normal.begin());
        return normal;
    }

    /// An error of depth in unit roundoffs of the longest edge.
    static double roundings(const OraclePair& pair, const Contact<Real>& contact, double depth) {
        const double size = std::max(longest_edge(pair.a), longest_edge(pair.b));
        return std::abs(-static_cast<double>(contact.depth) - depth) / (unit_roundoff * size);
    }
};

using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(ContactsNested, Reals);

template<class Visit>
void for_each_nested(Visit visit) {
    for (unsigned nesting = 0; nesting < static_cast<unsigned>(Nesting::count); ++nesting) {
        NestedMaker maker(nesting + 1);
        for (int i = 0; i < 100; ++i) {
            SCOPED_TRACE(name(static_cast<Nesting>(nesting)));
            visit(maker.make(static_cast<Nesting>(nesting)));
        }
    }
}

// Measured: 1.5 roundings, and 2e-5 degrees in float.
TYPED_TEST(ContactsNested, SatAndClipHaveTheLeastTranslation) {
    for_each_nested([&](const OraclePair& pair) {
        const auto truth = contact_truth(pair.a, pair.b, 64 * this->unit_roundoff);
        ASSERT_TRUE(truth);
        for (const auto rule : {ContactRule::sat, ContactRule::clip}) {
            const auto contact = this->contact_of(pair, rule);
            EXPECT_LT(this->roundings(pair, contact, truth->depth), 4);
            EXPECT_LT(nearest_angle(truth->normals, this->normal_of(contact)), 1e4 * this->unit_roundoff);
        }
    });
}

TYPED_TEST(ContactsNested, GrowthHasTheTranslationAlongItsNormal) {
    const auto expect_right = [&](const OraclePair& pair) {
        const auto contact = this->contact_of(pair, ContactRule::growth);
        EXPECT_LT(this->roundings(pair, contact, translation_along(pair, this->normal_of(contact))), 4);
    };
    for_each_nested(expect_right);
    // Also for pairs that are not nested, whose intersection may end before the translation does.
    Random random(1);
    for (int i = 0; i < 300; ++i) {
        const auto pair = random_pair(Family::generic, random);
        if (relation(pair.a, pair.b) == Relation::overlapping) expect_right(pair);
    }
}

} // namespace
} // namespace tandem::unit_test
