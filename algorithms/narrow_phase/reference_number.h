// SPDX-License-Identifier: MIT
// Numbers of one or two words, for the serial reference; number.clh describes them.
#pragma once

#include "algorithms/narrow_phase/reference_geometry.h"

namespace tandem::narrow_phase {

/// The sum of two words, of which the second is at most a rounding of the first.
template<class Real>
struct Number {
    Real value = 0, rest = 0;

    Number operator-() const { return {-value, -rest}; }
};

template<class Real>
using NumberVector = std::array<Number<Real>, 3>;

template<class Real>
Vector<Real> values(const NumberVector<Real>& a) {
    return {a[0].value, a[1].value, a[2].value};
}

/// Arithmetic with or without second words.
template<class Real>
class Arithmetic {
public:
    explicit Arithmetic(bool precise) : precise_(precise) {}

    /// Bounds the error of a product over its magnitude, and that of a sum over the sum of the magnitudes.
    Real roundoff() const {
        constexpr Real u = unit_roundoff<Real>;
        return precise_ ? 8 * u * u : u;
    }

    Number<Real> sum(const Number<Real>& a, const Number<Real>& b) const {
        const Real total = a.value + b.value;
        if (!precise_) return {total};
        const Real of_b = total - a.value;
        const Real lost = (a.value - (total - of_b)) + (b.value - of_b); // Knuth 1969
        return rounded_off(total, lost + (a.rest + b.rest));
    }

    Number<Real> product(const Number<Real>& a, const Number<Real>& b) const {
        const Real whole = a.value * b.value;
        if (!precise_) return {whole};
        const auto [a_high, a_low] = halves(a.value);
        const auto [b_high, b_low] = halves(b.value);
        const Real lost =
            ((a_high * b_high - whole) + a_high * b_low + a_low * b_high) + a_low * b_low; // Dekker 1971
        return rounded_off(whole, lost + (a.value * b.rest + a.rest * b.value));
    }

    Number<Real> quotient(const Number<Real>& a, const Number<Real>& b) const {
        const Real first = a.value / b.value;
        if (!precise_) return {first};
        return rounded_off(first, sum(a, -product({first}, b)).value / b.value);
    }

    Number<Real> difference(const Number<Real>& a, const Number<Real>& b) const { return sum(a, -b); }

    /// From p to q; with second words exact but for the scale of subnormal numbers.
    NumberVector<Real> between(const Vector<Real>& p, const Vector<Real>& q, Real scale) const {
        NumberVector<Real> result;
        for (unsigned i = 0; i < 3; ++i) {
            const auto whole = difference({q[i]}, {p[i]});
            result[i] = {whole.value * scale, whole.rest * scale};
        }
        return result;
    }

    Number<Real> dot(const NumberVector<Real>& a, const NumberVector<Real>& b) const {
        return sum(sum(product(a[0], b[0]), product(a[1], b[1])), product(a[2], b[2]));
    }

    NumberVector<Real> cross(const NumberVector<Real>& a, const NumberVector<Real>& b) const {
        NumberVector<Real> result;
        for (unsigned i = 0; i < 3; ++i) {
            const unsigned j = (i + 1) % 3, k = (i + 2) % 3;
            result[i] = difference(product(a[j], b[k]), product(a[k], b[j]));
        }
        return result;
    }

private:
    static Number<Real> rounded_off(Real value, Real rest) {
        const Real sum = value + rest;
        return {sum, rest - (sum - value)};
    }

    /// The upper and the lower half of a number's digits.
    static std::pair<Real, Real> halves(Real a) {
        const Real spread = std::ldexp(Real(1), (std::numeric_limits<Real>::digits + 1) / 2) + 1;
        const Real high = spread * a - (spread * a - a);
        return {high, a - high};
    }

    bool precise_;
};

} // namespace tandem::narrow_phase
