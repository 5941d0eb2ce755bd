// SPDX-License-Identifier: MIT
#include "geometry/polynomial.h"

#include <algorithm>
#include <utility>

namespace tandem::geometry {

namespace {

/// Divides by the positive common factor of the coefficients, so that they stay short.
Polynomial primitive(const Polynomial& p) {
    mpz_class factor = 0;
    for (const auto& c : p.coefficients()) factor = gcd(factor, c);
    if (factor <= 1) return p;
    auto coefficients = p.coefficients();
    for (auto& c : coefficients) c /= factor;
    return Polynomial(std::move(coefficients));
}

/// Quotient and remainder of p / q, each times a positive number. q must not be zero.
std::pair<Polynomial, Polynomial> divided(const Polynomial& p, const Polynomial& q) {
    const auto& divisor = q.coefficients();
    const mpz_class factor = abs(divisor.back());
    const int side = sgn(divisor.back());
    auto rest = p.coefficients();
    std::vector<mpz_class> quotient(rest.size());
    while (rest.size() >= divisor.size()) {
        const mpz_class lead = side * rest.back();
        const auto shift = rest.size() - divisor.size();
        for (auto& c : rest) c *= factor;
        for (auto& c : quotient) c *= factor;
        for (std::size_t i = 0; i < divisor.size(); ++i) rest[shift + i] -= lead * divisor[i];
        quotient[shift] += lead;
        rest.pop_back(); // is zero now
    }
    return {Polynomial(std::move(quotient)), Polynomial(std::move(rest))};
}

/// The coefficients of p(by + x), by Horner's method.
void shift(std::vector<mpz_class>& c, const mpz_class& by) {
    if (by == 0) return;
    for (std::size_t first = 0; first + 1 < c.size(); ++first)
        for (auto i = c.size() - 1; i-- > first;) c[i] += by * c[i + 1];
}

Polynomial negated(const Polynomial& p) { return Polynomial() - p; }

} // namespace

Polynomial::Polynomial(std::vector<mpz_class> coefficients) : coefficients_(std::move(coefficients)) {
    while (!coefficients_.empty() && coefficients_.back() == 0) coefficients_.pop_back();
}

int Polynomial::sign_at(const Dyadic& x) const {
    mpz_class value = 0, c;
    for (auto i = coefficients_.size(); i-- > 0;) {
        c = coefficients_[i] << x.exponent * (degree() - i);
        value = value * x.numerator + c;
    }
    return sgn(value);
}

Polynomial Polynomial::derivative() const {
    std::vector<mpz_class> result;
    for (std::size_t i = 1; i < coefficients_.size(); ++i) result.emplace_back(coefficients_[i] * i);
    return Polynomial(std::move(result));
}

Polynomial Polynomial::operator+(const Polynomial& other) const {
    auto result = coefficients_;
    result.resize(std::max(result.size(), other.coefficients_.size()));
    for (std::size_t i = 0; i < other.coefficients_.size(); ++i) result[i] += other.coefficients_[i];
    return Polynomial(std::move(result));
}

Polynomial Polynomial::operator-(const Polynomial& other) const {
    auto result = coefficients_;
    result.resize(std::max(result.size(), other.coefficients_.size()));
    for (std::size_t i = 0; i < other.coefficients_.size(); ++i) result[i] -= other.coefficients_[i];
    return Polynomial(std::move(result));
}

Polynomial Polynomial::operator*(const Polynomial& other) const {
    if (is_zero() || other.is_zero()) return {};
    std::vector<mpz_class> result(coefficients_.size() + other.coefficients_.size() - 1);
    for (std::size_t i = 0; i < coefficients_.size(); ++i)
        for (std::size_t j = 0; j < other.coefficients_.size(); ++j)
            result[i + j] += coefficients_[i] * other.coefficients_[j];
    return Polynomial(std::move(result));
}

/// With t from 0 to 1 on the interval and y = t / (1 - t), (1 + y)^n p has the Bernstein coefficients times
/// binomials. Its coefficients are those of the reversed p(1 + x), reversed.
int sign_on(const Polynomial& p, const DyadicInterval& interval) {
    if (p.is_zero()) return 0;
    auto c = p.coefficients();
    const auto n = p.degree();
    for (std::size_t i = 0; i < n; ++i) c[i] <<= interval.exponent * (n - i);
    shift(c, interval.numerator);
    std::ranges::reverse(c);
    shift(c, 1);
    const int side = sgn(c[0]);
    return std::ranges::all_of(c, [&](const auto& x) { return sgn(x) == side; }) ? side : 0;
}

Polynomial common_divisor(Polynomial p, Polynomial q) {
    while (!q.is_zero()) {
        auto rest = primitive(divided(p, q).second);
        p = std::move(q);
        q = std::move(rest);
    }
    return primitive(p);
}

Sturm::Sturm(const Polynomial& p) {
    const auto first = primitive(divided(p, common_divisor(p, p.derivative())).first);
    chain_ = {first, primitive(first.derivative())};
    while (!chain_.back().is_zero())
        chain_.push_back(primitive(negated(divided(chain_[chain_.size() - 2], chain_.back()).second)));
    chain_.pop_back();
}

int Sturm::variations(const Dyadic& x) const {
    int result = 0, last = 0;
    for (const auto& p : chain_) {
        const int sign = p.sign_at(x);
        if (sign == 0) continue;
        result += last * sign < 0 ? 1 : 0;
        last = sign;
    }
    return result;
}

int Sturm::count(const DyadicInterval& interval) const {
    return variations(interval.low()) - variations(interval.high());
}

Root::Root(const Polynomial& square_free, const DyadicInterval& interval)
    : polynomial_(square_free), interval_(interval) {
    constexpr unsigned fine = 12; // few signs of other polynomials need finer intervals
    while (interval_.exponent < fine) interval_ = half_of(interval_);
}

/// The sign changes at the only root, and nowhere else above the lower end.
DyadicInterval Root::half_of(const DyadicInterval& interval) const {
    const int middle = polynomial_.sign_at(interval.half(0).high());
    const bool below = middle == 0 || middle == polynomial_.sign_at(interval.high());
    return interval.half(below ? 0 : 1);
}

bool Root::is_root_of(const Polynomial& other) const {
    const auto common = common_divisor(polynomial_, other);
    return common.degree() > 0 && Sturm(common).count(interval_) > 0;
}

int Root::sign_of(const Polynomial& other) const {
    if (other.is_zero()) return 0;
    constexpr unsigned patience = 20; // the common divisor takes as long as some halvings
    auto part = interval_;
    for (unsigned halvings = 0;; ++halvings) {
        if (const int sign = sign_on(other, part); sign != 0) return sign;
        if (halvings == patience && is_root_of(other)) return 0;
        part = half_of(part);
    }
}

std::vector<Root> roots_in_unit(const Polynomial& p) {
    std::vector<Root> roots;
    const Sturm sturm(p);
    std::vector<DyadicInterval> open{{}};
    while (!open.empty()) {
        const auto interval = open.back();
        open.pop_back();
        const int count = sturm.count(interval);
        if (count == 1) roots.emplace_back(sturm.square_free(), interval);
        if (count <= 1) continue;
        open.push_back(interval.half(1));
        open.push_back(interval.half(0)); // next, so that roots are ascending
    }
    return roots;
}

} // namespace tandem::geometry
