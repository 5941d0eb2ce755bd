// SPDX-License-Identifier: MIT
#include "algorithms/answer/contact_digest.h"

#include <bit>

namespace tandem {

namespace {

std::uint64_t scrambled(std::uint64_t x) { // SplitMix64 (Steele, Lea, Flood 2014)
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9u;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebu;
    return x ^ x >> 31;
}

} // namespace

template<class Real>
std::pair<std::uint64_t, std::uint64_t> contact_terms(std::uint32_t body_a, std::uint32_t tet_a,
                                                      std::uint32_t body_b, std::uint32_t tet_b,
                                                      const Contact<Real>& contact) {
    const auto joined = [](std::uint64_t high, std::uint64_t low) { return high << 32 | low; };
    std::uint64_t term = scrambled(joined(body_a, tet_a));
    term = scrambled(term + joined(body_b, tet_b));
    term = scrambled(term + contact.feature);
    const auto& p = contact.point;
    const auto& n = contact.normal;
    const std::array<Real, 8> values{p[0], p[1], p[2], n[0], n[1], n[2], contact.depth, contact.pressure};
    if constexpr (sizeof(Real) == 8)
        for (const Real value : values) term = scrambled(term + std::bit_cast<std::uint64_t>(value));
    else
        for (unsigned i = 0; i < 8; i += 2)
            term = scrambled(term
                             + joined(std::bit_cast<std::uint32_t>(values[i + 1]),
                                      std::bit_cast<std::uint32_t>(values[i])));
    return {term, scrambled(term + 0x9e3779b97f4a7c15u)};
}

template std::pair<std::uint64_t, std::uint64_t> contact_terms(std::uint32_t, std::uint32_t, std::uint32_t,
                                                               std::uint32_t, const Contact<float>&);
template std::pair<std::uint64_t, std::uint64_t> contact_terms(std::uint32_t, std::uint32_t, std::uint32_t,
                                                               std::uint32_t, const Contact<double>&);

} // namespace tandem
