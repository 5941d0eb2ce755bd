// SPDX-License-Identifier: MIT
#include "algorithms/answer/digest.h"

#include "base/parallel.h"

namespace tandem {

namespace {

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014), as in pairs.clh.
std::uint64_t split_mix(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

} // namespace

Digest digest_of(const Pair& p) {
    const auto first = std::uint64_t{p.body_a} << 32 | p.tet_a;
    const auto second = std::uint64_t{p.body_b} << 32 | p.tet_b;
    const auto term = split_mix(split_mix(first) + second);
    return {1, term, split_mix(term + 0x9e3779b97f4a7c15u)};
}

Digest digest_of(std::span<const Pair> pairs) {
    const auto parts = in_parts(pairs);
    std::vector<Digest> found(parts.size());
    parallel_for(parts.size(), [&](std::size_t i) {
        for (const auto& p : parts[i]) found[i] += digest_of(p);
    });
    Digest digest;
    for (const auto& part : found) digest += part;
    return digest;
}

} // namespace tandem
