// SPDX-License-Identifier: MIT
#include "geometry/rounding.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tandem::geometry {

namespace {

constexpr long digits = 53;
constexpr long smallest = -1074; // exponent of the smallest subnormal

long bits(const mpz_class& x) { return static_cast<long>(mpz_sizeinbase(x.get_mpz_t(), 2)); }

/// Rounds (whole + fraction) 2^exponent once. The fraction is in (0, 1) if `inexact`, else 0. If inexact,
/// `whole` has more than `digits` bits.
double rounded(mpz_class whole, bool inexact, long exponent) {
    if (whole == 0) return 0;
    const long last = std::max(exponent + bits(whole) - digits, smallest);
    const long drop = last - exponent;
    if (drop > 0) {
        const auto by = static_cast<unsigned long>(drop);
        const mpz_class half = mpz_class(1) << (by - 1);
        mpz_class kept = whole >> by;
        const mpz_class rest = whole - (kept << by);
        if (rest > half || (rest == half && (inexact || mpz_odd_p(kept.get_mpz_t()) != 0))) ++kept;
        whole = std::move(kept);
        exponent = last;
    }
    const long finite = std::clamp(exponent, -4000L, 4000L);
    return std::ldexp(whole.get_d(), static_cast<int>(finite));
}

} // namespace

double nearest(const mpq_class& x) {
    const mpz_class magnitude = abs(x.get_num());
    // The quotient has at least digits + 3 bits, so rounding needs only whether a remainder exists.
    const long exponent = bits(magnitude) - bits(x.get_den()) - (digits + 3);
    const mpz_class numerator =
        exponent < 0 ? mpz_class(magnitude << static_cast<unsigned long>(-exponent)) : magnitude;
    const mpz_class denominator = exponent > 0
                                      ? mpz_class(x.get_den() << static_cast<unsigned long>(exponent))
                                      : mpz_class(x.get_den());
    const mpz_class whole = numerator / denominator;
    return sgn(x) * rounded(whole, whole * denominator != numerator, exponent);
}

double nearest_root(const mpq_class& x) {
    // The square needs twice the digits of the root, and an even exponent.
    long exponent = bits(x.get_num()) - bits(x.get_den()) - 2 * (digits + 3);
    exponent -= exponent % 2 != 0;
    const mpq_class square = scaled(x, -exponent);
    const mpz_class whole = square.get_num() / square.get_den();
    mpz_class root, rest;
    mpz_sqrtrem(root.get_mpz_t(), rest.get_mpz_t(), whole.get_mpz_t());
    return rounded(root, rest != 0 || whole != square, exponent / 2);
}

mpq_class scaled(const mpq_class& x, long exponent) {
    const auto by = static_cast<unsigned long>(std::abs(exponent));
    return exponent < 0 ? mpq_class(x >> by) : mpq_class(x << by);
}

} // namespace tandem::geometry
