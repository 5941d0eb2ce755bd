// SPDX-License-Identifier: MIT
#include "harness/record/parts.h"
#include "harness/sampling/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tandem::record_parts {

namespace {

Json statistics_json(const Summary& s) {
    return {{"median", s.median}, {"q1", s.q1}, {"q3", s.q3}, {"low", s.low}, {"high", s.high}};
}

/// The samples, then statistics over their rounds.
Json total_json(const Measurement& m) {
    const auto totals = m.totals();
    const auto rounds = m.rounds();
    Json json{{"samples", totals}, {"rounds", rounds}};
    if (!totals.empty()) json.update(statistics_json(summarise(totals, rounds)));
    json["frames"] = Json::array();
    for (const auto& sample : m.samples) json["frames"].push_back(sample.frame_ns);
    return json;
}

/// Sums over the frames of each instrumented replay with statistics, and the median of each frame.
/// `values_of(replay)` returns one value a frame.
template<class ValuesOf>
Json replays_json(const Measurement& m, const ValuesOf& values_of) {
    std::vector<std::int64_t> sums;
    std::vector<std::vector<std::int64_t>> by_frame;
    for (const auto& replay : m.breakdowns) {
        const std::vector<std::int64_t> frames = values_of(replay);
        by_frame.resize(frames.size());
        for (std::size_t i = 0; i < frames.size(); ++i) by_frame[i].push_back(frames[i]);
        sums.push_back(std::accumulate(frames.begin(), frames.end(), std::int64_t{0}));
    }
    Json json{{"samples", sums}};
    if (sums.empty()) return json;
    json.update(statistics_json(summarise(sums)));
    json["frames"] = Json::array();
    for (const auto& samples : by_frame)
        json["frames"].push_back(static_cast<std::int64_t>(std::llround(summarise(samples).median)));
    return json;
}

/// One value of one stage.
Json stage_times_json(const Measurement& m, std::size_t stage, std::int64_t StageSample::*member) {
    return replays_json(m, [&](const InstrumentedReplay& replay) {
        std::vector<std::int64_t> values;
        for (const auto& frame : replay.stages) values.push_back(frame[stage].*member);
        return values;
    });
}

/// Counts come from the last replay, times from all replays.
Json stages_json(const Measurement& m) {
    Json json = Json::object();
    if (m.breakdowns.empty()) return json;
    const auto last = m.breakdowns.back().totals();
    for (std::size_t stage = 0; stage < stage_names.size(); ++stage) {
        const auto& sum = last[stage];
        if (std::ranges::all_of(m.breakdowns, [&](const auto& r) { return r.totals()[stage].host_ns == 0; }))
            continue;
        json[std::string(stage_names[stage])] = {
            {"device_ns", stage_times_json(m, stage, &StageSample::device_ns)},
            {"host_ns", stage_times_json(m, stage, &StageSample::host_ns)},
            {"launches", sum.launches},
            {"waits", sum.waits},
            {"bytes", sum.bytes}};
    }
    return json;
}

/// Samples of a named entry of the map `sums`, one a replay; 0 for a replay without the entry.
template<class Sums, class Time>
Json named_times_json(const Measurement& m, const std::string& name, Sums sums, Time time) {
    std::vector<std::int64_t> times;
    for (const auto& replay : m.breakdowns) {
        const auto found = (replay.*sums).find(name);
        times.push_back(found == (replay.*sums).end() ? 0 : found->second.*time);
    }
    Json samples{{"samples", times}};
    samples.update(statistics_json(summarise(times)));
    return samples;
}

/// Times by kernel entry point; counts as in stages_json.
Json kernel_times_json(const Measurement& m) {
    Json json = Json::object();
    if (m.breakdowns.empty()) return json;
    for (const auto& [entry, last] : m.breakdowns.back().kernels)
        json[entry] = {{"launches", last.launches},
                       {"device_ns",
                        named_times_json(m, entry, &InstrumentedReplay::kernels, &KernelSample::device_ns)}};
    return json;
}

/// Times by name of the host work; counts as in stages_json.
Json host_work_json(const Measurement& m) {
    Json json = Json::object();
    if (m.breakdowns.empty()) return json;
    for (const auto& [name, last] : m.breakdowns.back().host_work)
        json[name] = {
            {"stage", stage_names[static_cast<std::size_t>(last.stage)]},
            {"times", last.times},
            {"host_ns", named_times_json(m, name, &InstrumentedReplay::host_work, &HostWorkSample::host_ns)}};
    return json;
}

/// Null when a command has no device times.
Json device_span_json(const Measurement& m) {
    for (const auto& replay : m.breakdowns)
        if (std::ranges::any_of(replay.span_ns, [](auto span) { return span < 0; })) return nullptr;
    return m.breakdowns.empty() ? Json() : replays_json(m, [](const auto& replay) { return replay.span_ns; });
}

} // namespace

void add_times(Json& record, const Measurement& m, bool measured) {
    record["total_ns"] = measured || !m.samples.empty() ? total_json(m) : Json();
    record["breakdown_ns"] =
        m.breakdowns.empty() ? Json() : replays_json(m, [](const auto& replay) { return replay.frame_ns; });
    record["device_span_ns"] = device_span_json(m);
    record["stages"] = stages_json(m);
    record["kernel_times"] = kernel_times_json(m);
    record["host_work"] = host_work_json(m);
}

} // namespace tandem::record_parts
