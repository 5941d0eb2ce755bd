// SPDX-License-Identifier: MIT
#include "harness/sampling/ranks/rank_team.h"
#include "harness/record/parts.h"
#include "harness/sampling/statistics.h"

namespace tandem::record_parts {

namespace {

/// One value of a device in every frame of the last sample.
Json by_frame(const Measurement& m, std::size_t device, std::uint64_t DeviceWork::*member) {
    Json json = Json::array();
    for (const auto& frame : m.shared) json.push_back(frame[device].*member);
    return json;
}

/// Times by replay, by the host's clock, within the span that total_ns measures.
Json times_json(const Measurement& m, std::size_t device) {
    std::vector<std::int64_t> samples;
    std::vector<std::uint32_t> rounds;
    for (const auto& sample : m.samples) {
        samples.push_back(sample.shared_ns[device]);
        rounds.push_back(sample.round);
    }
    const auto s = summarise(samples, rounds);
    return {{"samples", samples}, {"median", s.median}, {"low", s.low}, {"high", s.high}};
}

/// Medians of the instrumented replays, without stages that took no time.
Json stages_json(const Measurement& m, std::size_t device) {
    Json json = Json::object();
    for (std::size_t stage = 0; stage < stage_names.size(); ++stage) {
        std::vector<std::int64_t> on_device, on_host;
        for (const auto& replay : m.breakdowns) {
            on_device.push_back(replay.by_device[device][stage].device_ns);
            on_host.push_back(replay.by_device[device][stage].host_ns);
        }
        const auto host = on_host.empty() ? 0.0 : summarise(on_host).median;
        if (host <= 0) continue;
        json[std::string(stage_names[stage])] = {{"device_ns", summarise(on_device).median},
                                                 {"host_ns", host}};
    }
    return json;
}

/// Sums over the frames of the last sample; null without an exchange.
Json exchange_json(const Measurement& m, std::size_t device) {
    DeviceWork sum;
    for (const auto& frame : m.shared) {
        sum.exchange_ns += frame[device].exchange_ns;
        sum.exchange_bytes += frame[device].exchange_bytes;
        sum.messages += frame[device].messages;
    }
    if (sum.exchange_ns == 0) return nullptr;
    return {{"host_ns", sum.exchange_ns}, {"bytes", sum.exchange_bytes}, {"messages", sum.messages}};
}

} // namespace

Json partition_json(const Measurement& m, const Cell& cell) {
    if (m.samples.empty() || m.shared.empty()) return nullptr;
    std::vector<double> imbalances;
    for (const auto& sample : m.samples) imbalances.push_back(sample.imbalance().value_or(1));
    std::ranges::sort(imbalances);
    const auto infos = infos_of(cell);
    Json devices = Json::array();
    for (std::size_t i = 0; i < m.shared.front().size(); ++i)
        devices.push_back({{"device", infos[i].id},
                           {"ns", times_json(m, i)},
                           {"bodies", by_frame(m, i, &DeviceWork::bodies)},
                           {"body_pairs", by_frame(m, i, &DeviceWork::body_pairs)},
                           {"candidate_pairs", by_frame(m, i, &DeviceWork::pairs)},
                           {"exchange", exchange_json(m, i)},
                           {"stages", stages_json(m, i)}});
    return {{"imbalance", imbalances[imbalances.size() / 2]},
            {"repartitions", m.samples.back().repartitions},
            {"devices", devices}};
}

} // namespace tandem::record_parts
