// SPDX-License-Identifier: MIT
#include "geometry/polynomial.h"
#include "base/random.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using geometry::Polynomial;
using geometry::Root;
using geometry::roots_in_unit;
using geometry::sign_on;

Polynomial polynomial_of(std::vector<mpz_class> ascending) { return Polynomial(std::move(ascending)); }

/// The product of (d_i x - n_i), whose roots are n_i / d_i.
Polynomial with_roots(const std::vector<mpq_class>& roots) {
    auto result = polynomial_of({1});
    for (const auto& root : roots) result = result * polynomial_of({-root.get_num(), root.get_den()});
    return result;
}

mpq_class random_fraction(Random& random) {
    mpq_class result(static_cast<long>(random.next() % 25) - 8, 1 + random.next() % 9);
    result.canonicalize();
    return result;
}

TEST(OraclePolynomial, Arithmetic) {
    const auto p = polynomial_of({1, 2}), q = polynomial_of({-1, 2});
    EXPECT_EQ(p * q, polynomial_of({-1, 0, 4}));
    EXPECT_EQ(p + q, polynomial_of({0, 4}));
    EXPECT_TRUE((p - p).is_zero());
    EXPECT_EQ((p * q).derivative(), polynomial_of({0, 8}));
    EXPECT_EQ((p * q).sign_at({1, 1}), 0);
    EXPECT_EQ((p * q).sign_at({3, 3}), -1);
    EXPECT_EQ((p * q).sign_at({-2, 1}), 1);
}

/// Two polynomials with 0 to 2 common roots: their common divisor has these roots only.
TEST(OraclePolynomial, CommonDivisorsHaveTheCommonRoots) {
    const auto divisor = geometry::common_divisor(with_roots({mpq_class(1, 2), mpq_class(1, 4), 5}),
                                                  with_roots({mpq_class(1, 4), 7, 5}));
    EXPECT_EQ(divisor.degree(), 2u);
    EXPECT_EQ(divisor.sign_at({1, 2}), 0);
    EXPECT_EQ(divisor.sign_at({5, 0}), 0);
    EXPECT_EQ(geometry::common_divisor(with_roots({1, 2}), with_roots({3, 4})).degree(), 0u);
}

/// Rational roots, also multiple ones and those at 0 and 1, against a count of the roots in (0, 1].
TEST(OraclePolynomial, FindsEveryRootOnceInOrder) {
    Random random(1);
    for (int round = 0; round < 400; ++round) {
        std::vector<mpq_class> roots(1 + random.next() % 4);
        for (auto& root : roots) root = random_fraction(random);
        const auto found = roots_in_unit(with_roots(roots));
        std::sort(roots.begin(), roots.end());
        roots.erase(std::unique(roots.begin(), roots.end()), roots.end());
        std::erase_if(roots, [](const auto& root) { return root <= 0 || root > 1; });
        ASSERT_EQ(found.size(), roots.size());
        for (std::size_t i = 0; i < roots.size(); ++i) {
            EXPECT_EQ(found[i].sign_of(with_roots({roots[i]})), 0);
            EXPECT_EQ(found[i].sign_of(polynomial_of({-1, 1000}) * with_roots({roots[i], 3})), 0);
            const mpq_class above = roots[i] + mpq_class(1, 1000000),
                            below = roots[i] - mpq_class(1, 1000000);
            EXPECT_EQ(found[i].sign_of(with_roots({above})), -1);
            EXPECT_EQ(found[i].sign_of(with_roots({below})), 1);
        }
    }
}

/// At sqrt(1/2): polynomials with that root and others, and numbers near it.
TEST(OraclePolynomial, SignsAtAnIrrationalRoot) {
    const auto found = roots_in_unit(polynomial_of({-1, 0, 2}));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].sign_of(polynomial_of({-1, 0, 2}) * polynomial_of({5, 1, 1})), 0);
    EXPECT_EQ(found[0].sign_of(polynomial_of({1, 0, -4, 0, 4})), 0) << "its square";
    const mpz_class digits("70710678118654752440084436210484903928");
    mpz_class power;
    mpz_ui_pow_ui(power.get_mpz_t(), 10, 38);
    EXPECT_EQ(found[0].sign_of(polynomial_of({-digits, power})), 1);
    EXPECT_EQ(found[0].sign_of(polynomial_of({-digits - 1, power})), -1);
    EXPECT_EQ(found[0].sign_of(Polynomial()), 0);
    EXPECT_EQ(found[0].sign_of(polynomial_of({-3})), -1);
}

/// A certain sign means no root, and most polynomials with roots elsewhere have one.
TEST(OraclePolynomial, SignsOnTheUnitIntervalAreRight) {
    Random random(2);
    unsigned certain = 0;
    for (int round = 0; round < 1000; ++round) {
        std::vector<mpz_class> coefficients(1 + random.next() % 5);
        for (auto& c : coefficients) c = static_cast<long>(random.next() % 41) - 20;
        const auto p = polynomial_of(coefficients);
        const int sign = sign_on(p);
        if (sign == 0) continue;
        ++certain;
        EXPECT_TRUE(roots_in_unit(p).empty());
        for (unsigned eighths = 0; eighths <= 8; ++eighths) EXPECT_EQ(p.sign_at({eighths, 3}), sign);
    }
    EXPECT_GT(certain, 200u);
    EXPECT_EQ(sign_on(with_roots({mpq_class(1, 2), mpq_class(1, 2)})), 0);
    EXPECT_EQ(sign_on(Polynomial()), 0);
}

/// 8x - 5 and its negative on eighths.
TEST(OraclePolynomial, SignsOnPartsOfTheUnitInterval) {
    for (unsigned eighth = 0; eighth < 8; ++eighth) {
        const int expected = eighth < 4 ? -1 : eighth > 5 ? 1 : 0; // closed: both neighbours have the root
        EXPECT_EQ(sign_on(polynomial_of({-5, 8}), {eighth, 3}), expected) << eighth;
        EXPECT_EQ(sign_on(polynomial_of({5, -8}), {eighth, 3}), -expected) << eighth;
    }
}

} // namespace
} // namespace tandem
