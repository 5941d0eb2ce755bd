// SPDX-License-Identifier: MIT
#include "harness/profile/kernels.h"

#include <algorithm>
#include <array>
#include <set>

namespace tandem::profile {

namespace {

/// A term of the floor; none when the amount or the ceiling is unknown.
std::optional<double> nanoseconds(std::optional<double> amount, double per_second) {
    return amount && per_second > 0 ? std::optional(*amount * 1e9 / per_second) : std::nullopt;
}

/// Summary of the device time a frame, over all instrumented replays.
Summary times_of(const Measurement& m, const std::string& entry, double frames) {
    std::vector<std::int64_t> sums;
    for (const auto& replay : m.breakdowns) {
        const auto found = replay.kernels.find(entry);
        sums.push_back(found == replay.kernels.end() ? 0 : found->second.device_ns);
    }
    auto s = summarise(sums);
    for (auto* value : {&s.median, &s.q1, &s.q3, &s.low, &s.high}) *value /= frames;
    return s;
}

Floor floor_of(const KernelProfile& kernel, const Limits& limits) {
    Floor floor;
    floor.cached = kernel.bytes && *kernel.bytes <= limits.cached_bytes && limits.cached_bytes_per_s > 0;
    floor.bytes =
        nanoseconds(kernel.bytes, floor.cached ? std::max(limits.cached_bytes_per_s, limits.bytes_per_s)
                                               : limits.bytes_per_s);
    floor.operations = nanoseconds(kernel.operations, limits.operations_per_s);
    if (limits.launch_s > 0) floor.launches = kernel.launches * limits.launch_s * 1e9;
    return floor;
}

KernelProfile profile_of(const std::string& entry, const Measurement& m, const FrameFacts& facts,
                         const KernelCost* cost, const Limits& limits) {
    const auto frames = static_cast<double>(m.breakdowns.back().frame_ns.size());
    KernelProfile kernel;
    kernel.entry = entry;
    kernel.ns = times_of(m, entry, frames);
    if (const auto& last = m.breakdowns.back().kernels; last.contains(entry)) kernel.sample = last.at(entry);
    kernel.launches = static_cast<double>(kernel.sample.launches) / frames;
    if (cost != nullptr) {
        kernel.how = cost->how;
        if (cost->bytes) kernel.bytes = cost->bytes(facts);
        // Without counters the operations would be 0.
        if (cost->operations && !facts.work.empty()) kernel.operations = cost->operations(facts);
    }
    kernel.floor = floor_of(kernel, limits);
    return kernel;
}

} // namespace

std::optional<double> Floor::ns() const {
    std::optional<double> most;
    for (const auto& term : {bytes, operations, launches})
        if (term && (!most || *term > *most)) most = term;
    return most;
}

std::optional<double> KernelProfile::rate(std::optional<double> amount) const {
    return amount && ns.median > 0 ? std::optional(*amount * 1e9 / ns.median) : std::nullopt;
}

std::optional<double> KernelProfile::fraction(std::optional<double> term) const {
    return term && ns.median > 0 ? std::optional(*term / ns.median) : std::nullopt;
}

std::optional<double> KernelProfile::over_floor() const {
    const auto least = floor.ns();
    return least && *least > 0 ? std::optional(ns.median / *least) : std::nullopt;
}

std::optional<std::string_view> KernelProfile::bound() const {
    const auto times = over_floor();
    if (!times) return std::nullopt;
    if (*times >= latency_from) {
        // Undeclared bytes or operations may take the time.
        if (!floor.bytes || !operations) return std::nullopt;
        return "latency";
    }
    if (floor.launches == floor.ns()) return "launches";
    if (floor.operations == floor.ns()) return "operations";
    return floor.cached ? "cache" : "memory";
}

std::vector<KernelProfile> profile_kernels(const Measurement& m, const FrameFacts& facts,
                                           std::span<const KernelCost> costs, const Limits& limits) {
    std::set<std::string> entries;
    for (const auto& replay : m.breakdowns)
        for (const auto& [entry, sample] : replay.kernels) entries.insert(entry);
    std::vector<KernelProfile> kernels;
    double sum = 0;
    for (const auto& entry : entries) {
        const auto cost = std::ranges::find(costs, std::string_view(entry), &KernelCost::entry);
        kernels.push_back(profile_of(entry, m, facts, cost == costs.end() ? nullptr : &*cost, limits));
        sum += kernels.back().ns.median;
    }
    for (auto& kernel : kernels) kernel.time_fraction = sum > 0 ? kernel.ns.median / sum : 0;
    std::ranges::stable_sort(kernels, std::ranges::greater{}, [](const auto& k) { return k.ns.median; });
    return kernels;
}

} // namespace tandem::profile
