// SPDX-License-Identifier: MIT
#include "harness/record/parts.h"
#include "base/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tandem::record_parts {

namespace {

/// Samples with statistics, if there are any.
struct Times {
    std::vector<std::int64_t> samples;
    std::optional<Summary> statistics = {};
    std::vector<std::uint32_t> rounds = {}; ///< by sample
    Json frames = Json::array();
};

Field<Times> samples_field(const std::string& meaning) {
    return {"samples", samples(), meaning, &Times::samples};
}

Field<Times> statistic(const std::string& name, const std::string& meaning, double Summary::*member) {
    return {name,
            number_from(0),
            meaning,
            [member](const Times& t) { return t.statistics ? Json((*t.statistics).*member) : absent(); },
            {.optional = true}};
}

Fields<Times> statistics_fields() {
    return {
        statistic("median", "median of the samples, nanoseconds", &Summary::median),
        statistic("q1", "first quartile, nanoseconds (Hyndman and Fan 1996, definition 7)", &Summary::q1),
        statistic("q3", "third quartile, nanoseconds (definition 7)", &Summary::q3),
        statistic(
            "low",
            "lower end of the 95 % percentile-bootstrap interval of the median, nanoseconds; expanded for "
            "few rounds (base/statistics.h) since commits of 2026-11-23, of ten rounds a sixth "
            "narrower before",
            &Summary::low),
        statistic("high", "upper end of that interval, nanoseconds", &Summary::high)};
}

const Fields<Times>& total_fields() {
    static const auto fields =
        Fields<Times>{
            samples_field("one a replay, in order; empty for tandem check and for a failed cell"),
            {"rounds", counts(),
             "the round of each sample, from 0; where the session was not prepared anew for each, as before "
             "schema 3, each sample is a round",
             &Times::rounds}}
            .with(statistics_fields())
            .with({{"frames", array_of(samples().with("description", "one replay")),
                    "[replay][frame] the parts of each sample in nanoseconds", &Times::frames}});
    return fields;
}

const Fields<Times>& replays_fields() {
    static const auto fields =
        Fields<Times>{samples_field("")}
            .with(statistics_fields())
            .with({{"frames", samples(), "nanoseconds of each frame, the median of the replays",
                    &Times::frames}});
    return fields;
}

const Fields<Times>& summary_fields() {
    static const auto fields = Fields<Times>{samples_field("")}.with(statistics_fields());
    return fields;
}

Type replays_type() {
    return definition("replays",
                      summarised(replays_fields().type("one sample a replay, the sum of its frames, their "
                                                       "statistics, and the median of each frame")));
}

Type summary_type() {
    return definition("summary",
                      summarised(summary_fields().type("samples, one a replay, and their statistics")));
}

/// The samples, then statistics over their rounds.
Json total_json(const Measurement& m) {
    Times times{.samples = m.totals(), .rounds = m.rounds()};
    if (!times.samples.empty()) times.statistics = summarise(times.samples, times.rounds);
    for (const auto& sample : m.samples) times.frames.push_back(sample.frame_ns);
    return total_fields().write(times);
}

/// Sums over the frames of each instrumented replay with statistics, and the median of each frame.
/// `values_of(replay)` returns one value a frame. There is a replay.
template<class ValuesOf>
Json replays_json(const Measurement& m, const ValuesOf& values_of) {
    Times times;
    std::vector<std::vector<std::int64_t>> by_frame;
    for (const auto& replay : m.breakdowns) {
        const std::vector<std::int64_t> frames = values_of(replay);
        by_frame.resize(frames.size());
        for (std::size_t i = 0; i < frames.size(); ++i) by_frame[i].push_back(frames[i]);
        times.samples.push_back(std::accumulate(frames.begin(), frames.end(), std::int64_t{0}));
    }
    times.statistics = summarise(times.samples);
    for (const auto& values : by_frame)
        times.frames.push_back(static_cast<std::int64_t>(std::llround(summarise(values).median)));
    return replays_fields().write(times);
}

/// A stage of the instrumented replays. Counts come from the last replay, times from all replays.
struct StageTimes {
    const Measurement& m;
    std::size_t stage;
    StageSample last;

    Json times(std::int64_t StageSample::*member) const {
        return replays_json(m, [&](const InstrumentedReplay& replay) {
            std::vector<std::int64_t> values;
            for (const auto& frame : replay.stages) values.push_back(frame[stage].*member);
            return values;
        });
    }
};

const Fields<StageTimes>& stage_fields() {
    static const Fields<StageTimes> fields{
        {"device_ns", replays_type(),
         "nanoseconds of its commands by the device's own clock; 0 where it ran nothing there",
         [](auto& s) { return s.times(&StageSample::device_ns); }},
        {"host_ns", replays_type(),
         "nanoseconds of the host inside its calls and its host work, waiting included",
         [](auto& s) { return s.times(&StageSample::host_ns); }},
        {"launches", count(), "kernel launches, over all frames of a replay",
         [](auto& s) { return s.last.launches; }},
        {"waits", count(), "times the host blocked on the device, over all frames of a replay",
         [](auto& s) { return s.last.waits; }},
        {"bytes", count(), "bytes of uploads and downloads, over all frames of a replay",
         [](auto& s) { return s.last.bytes; }}};
    return fields;
}

/// Meanings of the stages, in the order of stage_names.
constexpr std::array<const char*, stage_names.size()> stage_meanings{
    "vertices into the world",
    "bounds of every node",
    "body pairs, by the host or, with broad = device, by kernels",
    "node pairs that walks start from",
    "walks in tandem to the candidate pairs",
    "redistribution of work between launches",
    "decision and contacts of the candidate pairs",
    "canonical order of pairs and contacts",
    "reduction of contacts",
    "response to contacts",
    "host work before the device's",
    "host work after the device's",
    "device to host",
    "host to device",
    "messages between ranks of a job"};

/// Absent for a stage that takes no time.
Json stage_json(const Measurement& m, std::size_t stage) {
    if (std::ranges::all_of(m.breakdowns, [&](const auto& r) { return r.totals()[stage].host_ns == 0; }))
        return absent();
    return stage_fields().write({m, stage, m.breakdowns.back().totals()[stage]});
}

const Fields<Measurement>& stages_fields() {
    static const auto fields = [] {
        const auto type = definition("stage", stage_fields().type("one stage"));
        std::vector<Field<Measurement>> stages;
        for (std::size_t i = 0; i < stage_names.size(); ++i)
            stages.push_back({std::string(stage_names[i]),
                              type,
                              stage_meanings[i],
                              [i](const Measurement& m) { return stage_json(m, i); },
                              {.optional = true}});
        return Fields<Measurement>(std::move(stages));
    }();
    return fields;
}

/// An entry of a map of the last instrumented replay.
template<class Sample>
struct Named {
    const Sample& last;
    std::vector<std::int64_t> samples; ///< one a replay; 0 for a replay without the entry

    Json times() const {
        return summary_fields().write({.samples = samples, .statistics = summarise(samples)});
    }
};

/// One object for each entry of the map `sums` of the last replay.
template<class Sample>
Json named_json(const Measurement& m, const Fields<Named<Sample>>& fields,
                std::map<std::string, Sample> InstrumentedReplay::*sums, std::int64_t Sample::*time) {
    Json json = Json::object();
    if (m.breakdowns.empty()) return json;
    for (const auto& [name, last] : m.breakdowns.back().*sums) {
        Named<Sample> named{last, {}};
        for (const auto& replay : m.breakdowns) {
            const auto found = (replay.*sums).find(name);
            named.samples.push_back(found == (replay.*sums).end() ? 0 : found->second.*time);
        }
        json[name] = fields.write(named);
    }
    return json;
}

const Fields<Named<KernelSample>>& kernel_time_fields() {
    static const Fields<Named<KernelSample>> fields{
        {"launches", count(), "in one replay", [](auto& k) { return k.last.launches; }},
        {"device_ns", summary_type(), "nanoseconds by the device's own clock, one sample a replay",
         [](auto& k) { return k.times(); }}};
    return fields;
}

const Fields<Named<HostWorkSample>>& host_work_fields() {
    static const Fields<Named<HostWorkSample>> fields{
        {"stage", one_of(stage_names), "stage that it is within",
         [](auto& w) { return stage_names[static_cast<std::size_t>(w.last.stage)]; }},
        {"times", count(), "in one replay", [](auto& w) { return w.last.times; }},
        {"host_ns", summary_type(), "nanoseconds, one sample a replay", [](auto& w) { return w.times(); }}};
    return fields;
}

const Fields<Named<PhaseSample>>& phase_fields() {
    static const Fields<Named<PhaseSample>> fields{
        {"host_ns", summary_type(), "nanoseconds, one sample a replay", [](auto& p) { return p.times(); }}};
    return fields;
}

/// Null when a command has no device times.
Json device_span_json(const Measurement& m) {
    for (const auto& replay : m.breakdowns)
        if (std::ranges::any_of(replay.span_ns, [](auto span) { return span < 0; })) return nullptr;
    return m.breakdowns.empty() ? Json() : replays_json(m, [](const auto& replay) { return replay.span_ns; });
}

Json breakdown_json(const Measurement& m) {
    return m.breakdowns.empty() ? Json()
                                : replays_json(m, [](const auto& replay) { return replay.frame_ns; });
}

/// Times as they were sampled.
Fields<CellRecord> span_fields() {
    return {
        {"total_ns",
         nullable(
             summarised(total_fields().type("host nanoseconds of replays in which nothing but the span of "
                                            "each frame was timed: the headline. A sample is one replay, the "
                                            "sum of its frames; statistics are of the medians of rounds"))),
         "", [](auto& r) { return r.is_measured() || !r.m.samples.empty() ? total_json(r.m) : Json(); }},
        {"breakdown_ns", nullable(replays_type()),
         "host nanoseconds of replays with timestamps on every command, one a round, which 'stages' divides; "
         "longer than total_ns",
         [](auto& r) { return breakdown_json(r.m); }},
        {"device_span_ns", nullable(replays_type()),
         "device nanoseconds of those replays, the sum over frames from the begin of the first command to "
         "the end of the last; less the sum of device_ns it is the time between commands; null when the "
         "backend tells no times",
         [](auto& r) { return device_span_json(r.m); }}};
}

} // namespace

Fields<CellRecord> time_fields() {
    return span_fields().with(
        {{"stages",
          stages_fields().type("what those replays spent, by stage; a stage that did not occur is left out"),
          "", [](auto& r) { return r.m.breakdowns.empty() ? Json::object() : stages_fields().write(r.m); }},
         {"kernel_times",
          map_of(kernel_time_fields().type("one kernel"), "^[a-z][a-z0-9_]*$"),
          "what those replays spent, by entry point of kernels",
          [](auto& r) {
              return named_json(r.m, kernel_time_fields(), &InstrumentedReplay::kernels,
                                &KernelSample::device_ns);
          },
          {.since = 3}},
         {"host_work",
          map_of(host_work_fields().type("one kind of work"), "^[a-z][a-z ]*$"),
          "what the host did by itself in those replays, by name; each is within a stage as well",
          [](auto& r) {
              return named_json(r.m, host_work_fields(), &InstrumentedReplay::host_work,
                                &HostWorkSample::host_ns);
          },
          {.since = 4}},
         {"phases",
          map_of(phase_fields().type("one phase"), "^[a-z][a-z ]*$"),
          "parts of frames of those replays that the paper's release times, by name, with all commands and "
          "waits in them: 'initialization' and 'narrow phase' of cells with residency=published",
          [](auto& r) {
              return named_json(r.m, phase_fields(), &InstrumentedReplay::phases, &PhaseSample::host_ns);
          },
          {.since = 4}}});
}

} // namespace tandem::record_parts
