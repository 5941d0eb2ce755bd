// SPDX-License-Identifier: MIT
#include "geometry/lattice.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace tandem::geometry {

namespace {

/// x = mantissa * 2^exponent with an odd mantissa, unless x is zero.
struct Parts {
    std::int64_t mantissa = 0;
    int exponent = 0;
};

Parts parts(double x) {
    if (x == 0) return {};
    int exponent = 0;
    const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &exponent), 53));
    const int zeros = std::countr_zero(static_cast<std::uint64_t>(mantissa));
    return {mantissa >> zeros, exponent - 53 + zeros};
}

using AllParts = std::array<std::array<std::array<Parts, 3>, 4>, 2>;

/// The parts of all coordinates, and the smallest exponent.
std::pair<AllParts, int> all_parts(const TetraCorners& a, const TetraCorners& b) {
    AllParts result;
    int exponent = std::numeric_limits<int>::max();
    for (unsigned body = 0; body < 2; ++body)
        for (unsigned i = 0; i < 4; ++i)
            for (unsigned axis = 0; axis < 3; ++axis) {
                const auto part = parts((body == 0 ? a : b)[i][axis]);
                if (part.mantissa != 0) exponent = std::min(exponent, part.exponent);
                result[body][i][axis] = part;
            }
    if (exponent == std::numeric_limits<int>::max()) exponent = 0;
    return {result, exponent};
}

/// Fills both tetrahedra from number(body, corner, axis).
template<class Number, class Make>
Lattice<Number> lattice(int exponent, Make number) {
    Lattice<Number> result;
    result.exponent = exponent;
    for (unsigned i = 0; i < 4; ++i)
        for (unsigned axis = 0; axis < 3; ++axis) {
            result.a[i][axis] = number(0, i, axis) - number(0, 0, axis);
            result.b[i][axis] = number(1, i, axis) - number(0, 0, axis);
        }
    return result;
}

mpz_class in_units(const Parts& part, int exponent) {
    if (part.mantissa == 0) return 0;
    return mpz_class(static_cast<long>(part.mantissa)) << static_cast<unsigned>(part.exponent - exponent);
}

/// Whether all coordinates in these units fit in 61 bits.
bool fits(const AllParts& all, int exponent) {
    for (const auto& body : all)
        for (const auto& corner : body)
            for (const auto& part : corner) {
                const auto bits = std::bit_width(static_cast<std::uint64_t>(std::abs(part.mantissa)));
                if (part.mantissa != 0 && part.exponent - exponent + static_cast<int>(bits) > 61)
                    return false;
            }
    return true;
}

} // namespace

std::optional<Lattice<Int128>> small_lattice(const TetraCorners& a, const TetraCorners& b) {
    const auto [all, exponent] = all_parts(a, b);
    if (!fits(all, exponent)) return std::nullopt;
    constexpr auto max_distance = std::int64_t{1} << 40;
    bool near = true;
    const auto result = lattice<Int128>(
        exponent, [&all = all, exponent = exponent](unsigned body, unsigned i, unsigned axis) {
            const auto& part = all[body][i][axis];
            return part.mantissa == 0 ? 0 : part.mantissa * (std::int64_t{1} << (part.exponent - exponent));
        });
    for (const auto* points : {&result.a, &result.b})
        for (const auto& point : *points)
            for (const auto x : point) near &= -max_distance <= x && x <= max_distance;
    if (!near) return std::nullopt;
    return result;
}

Lattice<mpz_class> big_lattice(const TetraCorners& a, const TetraCorners& b) {
    const auto [all, exponent] = all_parts(a, b);
    return lattice<mpz_class>(exponent,
                              [&all = all, exponent = exponent](unsigned body, unsigned i, unsigned axis) {
                                  return in_units(all[body][i][axis], exponent);
                              });
}

LatticePoints lattice_points(std::span<const std::array<double, 3>> points) {
    LatticePoints result;
    result.exponent = std::numeric_limits<int>::max();
    for (const auto& point : points)
        for (const double x : point)
            if (x != 0) result.exponent = std::min(result.exponent, parts(x).exponent);
    if (result.exponent == std::numeric_limits<int>::max()) result.exponent = 0;
    for (const auto& point : points) {
        auto& own = result.points.emplace_back();
        for (unsigned axis = 0; axis < 3; ++axis) own[axis] = in_units(parts(point[axis]), result.exponent);
    }
    for (auto i = result.points.size(); i-- > 0;)
        result.points[i] = minus(result.points[i], result.points.front());
    return result;
}

} // namespace tandem::geometry
