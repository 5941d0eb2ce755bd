// SPDX-License-Identifier: MIT
#include "harness/sampling/measurement.h"

#include "base/statistics.h"

#include <algorithm>
#include <numeric>

namespace tandem {

namespace {

double mean(const std::vector<std::uint64_t>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

} // namespace

std::int64_t since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now() - begin)
        .count();
}

StageSample& StageSample::operator+=(const StageSample& other) {
    device_ns += other.device_ns;
    host_ns += other.host_ns;
    launches += other.launches;
    waits += other.waits;
    bytes += other.bytes;
    return *this;
}

StageSamples by_stage(const Trace& trace) {
    StageSamples samples{};
    for (const auto& event : trace.events) {
        if (event.command == Command::phase) continue;
        auto& sample = samples[static_cast<std::size_t>(event.stage)];
        sample.host_ns += event.host_ns;
        sample.device_ns += std::max<std::int64_t>(event.device_ns, 0);
        sample.launches += event.command == Command::launch ? 1 : 0;
        sample.waits += event.blocked ? 1 : 0;
        const bool moves = event.command == Command::upload || event.command == Command::download;
        sample.bytes += moves ? event.bytes : 0;
    }
    return samples;
}

std::int64_t TimedReplay::total_ns() const {
    return std::accumulate(frame_ns.begin(), frame_ns.end(), std::int64_t{0});
}

void TimedReplay::add(const FrameResult& result) {
    rebuilds += result.rebuilds;
    if (result.shared.empty()) return;
    shared_ns.resize(result.shared.size());
    std::int64_t longest = 0;
    for (std::size_t i = 0; i < result.shared.size(); ++i) {
        shared_ns[i] += result.shared[i].ns;
        longest = std::max(longest, result.shared[i].ns);
    }
    longest_ns += longest;
    repartitions += result.repartitions;
}

std::optional<double> TimedReplay::imbalance() const {
    const auto sum = std::accumulate(shared_ns.begin(), shared_ns.end(), std::int64_t{0});
    if (sum <= 0) return std::nullopt;
    return static_cast<double>(longest_ns) * static_cast<double>(shared_ns.size()) / static_cast<double>(sum);
}

StageSamples InstrumentedReplay::totals() const {
    StageSamples sums{};
    for (const auto& frame : stages)
        for (std::size_t stage = 0; stage < sums.size(); ++stage) sums[stage] += frame[stage];
    return sums;
}

std::vector<std::int64_t> Measurement::totals() const {
    std::vector<std::int64_t> sums;
    for (const auto& sample : samples) sums.push_back(sample.total_ns());
    return sums;
}

std::size_t Measurement::round_count() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < samples.size(); ++i)
        count += i == 0 || samples[i].round != samples[i - 1].round ? 1 : 0;
    return count;
}

std::vector<std::uint32_t> Measurement::rounds() const {
    std::vector<std::uint32_t> result;
    for (const auto& sample : samples) result.push_back(sample.round);
    return result;
}

double median_ns(const Measurement& m) {
    if (!m.samples.empty()) return summarise(m.totals(), m.rounds()).median;
    std::vector<std::int64_t> sums;
    for (const auto& replay : m.breakdowns)
        sums.push_back(std::accumulate(replay.frame_ns.begin(), replay.frame_ns.end(), std::int64_t{0}));
    return sums.empty() ? 0 : summarise(sums).median;
}

FrameFacts mean_frame(const Measurement& m) {
    FrameFacts facts;
    if (m.candidate_pairs.empty()) return facts;
    facts.body_pairs = mean(m.body_pairs);
    facts.candidate_pairs = mean(m.candidate_pairs);
    facts.contacts = mean(m.contacts);
    for (const auto& [counter, count] : m.work)
        facts.work[counter] = static_cast<double>(count) / static_cast<double>(m.candidate_pairs.size());
    return facts;
}

} // namespace tandem
