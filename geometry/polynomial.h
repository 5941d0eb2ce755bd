// SPDX-License-Identifier: MIT
#pragma once

#include <gmpxx.h>
#include <vector>

namespace tandem::geometry {

/// A number that is an integer divided by a power of two.
struct Dyadic {
    mpz_class numerator;
    unsigned exponent = 0; ///< of the power of two
};

/// The times from numerator / 2^exponent to (numerator + 1) / 2^exponent.
struct DyadicInterval {
    mpz_class numerator;
    unsigned exponent = 0;

    Dyadic low() const { return {numerator, exponent}; }
    Dyadic high() const { return {numerator + 1, exponent}; }
    /// The first half (0) or the second one (1).
    DyadicInterval half(unsigned index) const { return {2 * numerator + index, exponent + 1}; }
};

/// A polynomial in one variable with integer coefficients.
class Polynomial {
public:
    Polynomial() = default; ///< zero
    /// Coefficients in ascending order; the last ones may be zero.
    explicit Polynomial(std::vector<mpz_class> coefficients);

    bool is_zero() const { return coefficients_.empty(); }
    std::size_t degree() const { return coefficients_.size() - 1; } ///< not of the zero polynomial
    const std::vector<mpz_class>& coefficients() const { return coefficients_; }
    int sign_at(const Dyadic& x) const;
    Polynomial derivative() const;

    Polynomial operator+(const Polynomial& other) const;
    Polynomial operator-(const Polynomial& other) const;
    Polynomial operator*(const Polynomial& other) const;
    bool operator==(const Polynomial&) const = default;

private:
    std::vector<mpz_class> coefficients_; ///< ascending; the last one is not zero
};

/// The sign of a polynomial on a closed interval when its Bernstein coefficients show that it is 1 or -1 at
/// all points. Otherwise 0, which is also the sign of the zero polynomial.
int sign_on(const Polynomial& p, const DyadicInterval& interval = {});

/// A greatest common divisor, up to a constant factor. Not both may be zero.
Polynomial common_divisor(Polynomial p, Polynomial q);

/// Counts distinct roots of a polynomial by Sturm's theorem (1829). It must not be zero.
class Sturm {
public:
    explicit Sturm(const Polynomial& p);
    /// Number of roots in an interval without its lower end.
    int count(const DyadicInterval& interval) const;
    /// The polynomial with each of its roots once, up to a constant factor.
    const Polynomial& square_free() const { return chain_.front(); }

private:
    int variations(const Dyadic& x) const;

    std::vector<Polynomial> chain_; ///< starts with the square-free polynomial
};

/// An algebraic number: the only root of a polynomial in an interval without its lower end.
class Root {
public:
    Root(const Polynomial& square_free, const DyadicInterval& interval);

    /// The exact sign of another polynomial here. Halves the interval until the other one has a sign on all
    /// of it, unless the two have this root in common.
    int sign_of(const Polynomial& other) const;

private:
    DyadicInterval half_of(const DyadicInterval& interval) const;
    bool is_root_of(const Polynomial& other) const;

    Polynomial polynomial_;
    DyadicInterval interval_;
};

/// The distinct roots in (0, 1], ascending, of a polynomial that is not zero.
std::vector<Root> roots_in_unit(const Polynomial& p);

} // namespace tandem::geometry
