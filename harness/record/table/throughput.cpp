// SPDX-License-Identifier: MIT
#include "harness/record/table/throughput.h"

#include "algorithms/bodies/cost.h"

#include <numeric>

namespace tandem {

namespace {

/// `amount`, which is that of a replay, a second.
std::optional<double> per_second(const Measurement& m, double amount) {
    if (m.samples.empty()) return std::nullopt;
    const auto ns = median_ns(m);
    return ns > 0 ? std::optional(amount * 1e9 / ns) : std::nullopt;
}

} // namespace

std::optional<double> pairs_per_s(const Measurement& m) {
    const auto pairs = std::accumulate(m.candidate_pairs.begin(), m.candidate_pairs.end(), std::uint64_t{0});
    return per_second(m, static_cast<double>(pairs));
}

std::optional<double> bytes_per_s(const Row& row, const Scene& scene) {
    const auto& m = *row.measurement;
    if (m.breakdowns.empty()) return std::nullopt;
    const auto facts = mean_frame(m);
    const auto costs = row.cell->algorithm->costs(scene, m.settings);
    std::optional<double> bytes;
    for (const auto& [entry, sample] : m.breakdowns.back().kernels)
        for (const auto& cost : costs)
            if (cost.entry == entry && cost.bytes) bytes = bytes.value_or(0) + cost.bytes(facts);
    if (!bytes) return std::nullopt;
    return per_second(m, *bytes * static_cast<double>(m.candidate_pairs.size()));
}

} // namespace tandem
