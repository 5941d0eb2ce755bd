// SPDX-License-Identifier: MIT
#include "harness/record.h"

#include "backends/hardware.h"
#include "harness/choosing/choice.h"
#include "harness/environment.h"
#include "harness/key.h"
#include "harness/statistics.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <numeric>

namespace tandem {

namespace {

using Json = nlohmann::ordered_json;

std::string hex(std::uint64_t value) { return fmt::format("{:016x}", value); }

/// Negative and empty mean not known, which is null in a record.
Json known(std::int64_t value) { return value < 0 ? Json(nullptr) : Json(value); }

Json known(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Json digest_json(const Digest& digest) {
    return {{"count", digest.count}, {"a", hex(digest.a)}, {"b", hex(digest.b)}};
}

Json statistics_json(const Summary& s) {
    return {{"median", s.median}, {"q1", s.q1}, {"q3", s.q3}, {"low", s.low}, {"high", s.high}};
}

/// The replays, then what is said of their rounds.
Json total_json(const Measurement& m) {
    const auto totals = m.totals();
    const auto rounds = m.rounds();
    Json json{{"samples", totals}, {"rounds", rounds}};
    if (!totals.empty()) json.update(statistics_json(summarise(totals, rounds)));
    json["frames"] = Json::array();
    for (const auto& sample : m.samples) json["frames"].push_back(sample.frame_ns);
    return json;
}

/// Of what every instrumented replay has, frame by frame: their sums with statistics, and the median of each
/// frame. `of(replay)` gives a vector by frame.
template<class Of>
Json replays_json(const Measurement& m, const Of& of) {
    std::vector<std::int64_t> sums;
    std::vector<std::vector<std::int64_t>> by_frame;
    for (const auto& replay : m.breakdowns) {
        const std::vector<std::int64_t> frames = of(replay);
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

/// One number of one stage.
Json stage_times_json(const Measurement& m, std::size_t stage, std::int64_t StageSample::*member) {
    return replays_json(m, [&](const InstrumentedReplay& replay) {
        std::vector<std::int64_t> values;
        for (const auto& frame : replay.stages) values.push_back(frame[stage].*member);
        return values;
    });
}

/// Counts are of the last replay; times of all.
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

/// By entry point, as stages_json.
Json kernel_times_json(const Measurement& m) {
    Json json = Json::object();
    if (m.breakdowns.empty()) return json;
    for (const auto& [entry, last] : m.breakdowns.back().kernels) {
        std::vector<std::int64_t> times;
        for (const auto& replay : m.breakdowns) {
            const auto found = replay.kernels.find(entry);
            times.push_back(found == replay.kernels.end() ? 0 : found->second.device_ns);
        }
        Json samples{{"samples", times}};
        samples.update(statistics_json(summarise(times)));
        json[entry] = {{"launches", last.launches}, {"device_ns", samples}};
    }
    return json;
}

/// Null where a command told no times.
Json device_span_json(const Measurement& m) {
    for (const auto& replay : m.breakdowns)
        if (std::ranges::any_of(replay.span_ns, [](auto span) { return span < 0; })) return nullptr;
    return m.breakdowns.empty() ? Json() : replays_json(m, [](const auto& replay) { return replay.span_ns; });
}

/// Settings that the devices did not take as they were asked for, as they were.
Json asked_json(const SettingTexts& asked, const SettingTexts& taken) {
    Json json = Json::object();
    for (const auto& [name, value] : asked) {
        const auto found = taken.find(name);
        if (found == taken.end() || found->second != value) json[name] = value;
    }
    return json;
}

Json conditions_json(const Measurement& m) {
    if (m.conditions.empty()) return nullptr;
    Json disturbed = Json::array();
    std::vector<Condition> before, after;
    for (const auto& round : m.conditions) {
        if (const auto why = round.disturbed()) disturbed.push_back({{"round", round.round}, {"why", *why}});
        before.push_back(round.before);
        after.push_back(round.after);
    }
    return {{"disturbed", disturbed}, {"before", conditions_json(before)}, {"after", conditions_json(after)}};
}

/// How it was sampled, and what is to be thought of it.
Json sampling_json(const Measurement& m, const Cell& cell, const Outcome& outcome, const Sampling& sampling) {
    const auto rounds = round_medians(m.totals(), m.rounds());
    const auto change = drift(rounds);
    const auto& enough = sampling.enough;
    return {{"rounds", rounds.size()},
            {"cells", sampling.cells},
            {"seed", sampling.seed},
            {"repeat", enough.repeat ? Json(*enough.repeat) : Json()},
            {"noise", enough.repeat ? Json() : Json(noise_of(cell.devices, enough))},
            {"seconds", enough.repeat ? Json() : Json(enough.seconds)},
            {"spent_seconds", static_cast<double>(outcome.sampler->state().spent_ns) * 1e-9},
            {"converged", enough.repeat ? Json() : Json(outcome.converged)},
            {"interrupted", sampling.interrupted},
            {"continued", m.continued},
            {"outliers", count_outliers(rounds)},
            {"drift", change ? Json(*change) : Json()}};
}

} // namespace

Json record_scene(const Scene& scene) {
    std::size_t inverted = 0;
    std::size_t degenerate = 0;
    for (const auto& body : scene.bodies) {
        inverted += scene.meshes[body.mesh].inverted;
        degenerate += scene.meshes[body.mesh].degenerate;
    }
    return {{"name", scene.name},
            {"key", scene.key},
            {"digest", hex(scene.digest)},
            {"units", scene.units},
            {"bodies", scene.bodies.size()},
            {"vertices", vertex_count(scene)},
            {"tetrahedra", tetrahedron_count(scene)},
            {"inverted", inverted},
            {"degenerate", degenerate}};
}

Json record_device(const DeviceInfo& info) {
    return {{"id", info.id},
            {"name", info.name},
            {"driver", info.driver},
            {"compiler", info.compiler},
            {"hardware", info.hardware.empty() ? Json() : Json(hardware_digest(info.hardware))},
            {"kind", info.is_gpu ? "gpu" : "cpu"},
            {"compute_units", info.compute_units},
            {"memory_bytes", info.global_bytes}};
}

Json record_devices(const DeviceGroup& devices) {
    Json json = Json::array();
    for (const auto* device : devices) json.push_back(record_device(device->info()));
    return json;
}

namespace {

Json kernels_json(const std::vector<KernelFacts>& kernels) {
    Json json = Json::array();
    for (const auto& kernel : kernels)
        json.push_back({{"entry", kernel.entry},
                        {"defines", kernel.defines},
                        {"compile_ms", kernel.compile_ms},
                        {"registers", known(kernel.registers)},
                        {"local_bytes", known(kernel.local_bytes)},
                        {"spill_bytes", known(kernel.spill_bytes)}});
    return json;
}

} // namespace

Json record_environment() {
    const auto e = environment();
    return {{"commit", known(e.commit)},       {"dirty", e.dirty},           {"date", e.date},
            {"processor", known(e.processor)}, {"cores", e.cores},           {"memory_bytes", e.memory},
            {"compiler", e.compiler},          {"sources", sources_digest()}};
}

namespace {

/// Null when nothing was compared (--no-check).
Json agreement_json(const Measurement& m, const Scene& scene) {
    const auto& a = m.agreement;
    if (a.frames == 0) return nullptr;
    return {{"reference", reference_method(scene) == Method::brute_force ? "brute force" : "sweep"},
            {"frames", a.frames},
            {"missing", a.missing},
            {"extra", a.extra},
            {"contact_frames_wrong", a.contact_frames_wrong},
            {"digest", digest_json(a.digest)},
            {"contact_digest", digest_json(a.contact_digest)}};
}

/// By the names that the algorithm declares; null where nothing was counted.
Json counters_json(const Measurement& m, const Traversal& algorithm) {
    Json json = Json::object();
    for (const auto& counter : algorithm.counters()) {
        const auto found = m.work.find(counter.name);
        json[std::string(counter.name)] = found == m.work.end() ? Json() : Json(found->second);
    }
    return json;
}

Json work_json(const Measurement& m, const Traversal& algorithm) {
    return {{"body_pairs", m.body_pairs},
            {"candidate_pairs", m.candidate_pairs},
            {"contacts", m.contacts},
            {"digest", digest_json(m.agreement.digest)},
            {"contact_digest", digest_json(m.agreement.contact_digest)},
            {"counters", counters_json(m, algorithm)},
            {"rejected", m.rejected},
            {"undecided_by_filter", m.undecided_by_filter},
            {"undecided_by_double", m.undecided_by_double},
            {"retries", m.retries},
            {"batches", m.batches},
            {"submissions", m.submissions}};
}

Json spread_json(const std::vector<double>& samples) {
    const auto s = spread(samples);
    return s ? Json{{"median", s->median}, {"p99", s->p99}, {"max", s->maximum}} : Json();
}

/// Null where contacts were not compared with exact ones.
Json contact_errors_json(const AnswerErrors& e) {
    if (!e.contacts) return nullptr;
    const auto& c = *e.contacts;
    return {{"complete", e.every_contact},
            {"overlapping", c.overlapping},
            {"unanswered", c.unanswered},
            {"not_finite", c.not_finite},
            {"depth_relative", spread_json(c.depth_relative)},
            {"depth_ulps", spread_json(c.depth_ulps)},
            {"normal_degrees", spread_json(c.normal_degrees)},
            {"point", spread_json(c.point)},
            {"hausdorff", spread_json(c.hausdorff)},
            {"volume_relative", spread_json(c.volume_relative)},
            {"no_volume", c.no_volume}};
}

Json drift_json(const AnswerErrors& e) {
    if (!e.drift) return nullptr;
    const auto& d = *e.drift;
    return {{"vertices", d.vertices},
            {"median", d.median},
            {"p99", d.p99},
            {"max", d.max},
            {"of_bound", d.of_bound}};
}

Json truth_json(const AnswerErrors& e) {
    const auto upper = e.missed_upper95();
    const auto ratio = e.candidate_ratio();
    Json json{{"frames", e.frames},
              {"candidates", e.pairs.candidates},
              {"false", e.pairs.disjoint},
              {"touching", e.pairs.touching},
              {"overlapping", e.pairs.overlapping},
              {"invalid", e.pairs.invalid},
              {"missed_touching", e.pairs.missed_touching},
              {"missed_overlapping", e.pairs.missed_overlapping},
              {"missed_upper95", upper ? Json(*upper) : Json()},
              {"candidate_ratio", ratio ? Json(*ratio) : Json()},
              {"invalid_tetrahedra", e.invalid_tetrahedra}};
    for (unsigned tier = 0; tier < tier_count; ++tier)
        json["decided"][tier_names[tier]] = e.decided.tiers[tier];
    json["decisions"] = e.decisions ? Json(*e.decisions) : Json();
    json["contacts"] = contact_errors_json(e);
    json["drift"] = drift_json(e);
    return json;
}

/// As many bodies as a record names; it says of how many there are.
constexpr std::size_t most_flawed_bodies = 16;

Json inputs_json(const Flaws& flaws) {
    Json bodies = Json::array();
    for (const auto& body : std::span(flaws.bodies).first(std::min(flaws.bodies.size(), most_flawed_bodies)))
        bodies.push_back({{"body", body.body},
                          {"degenerate", body.degenerate},
                          {"non_finite", body.non_finite},
                          {"frame", body.frame},
                          {"first", body.first}});
    return {{"handling", name_of(flaws.handling)},
            {"degenerate_elements", flaws.degenerate},
            {"non_finite_elements", flaws.non_finite},
            {"flawed_bodies", flaws.bodies.size()},
            {"bodies", bodies}};
}

Json error_json(const Measurement& m, const Flaws& flaws) {
    return {{"degenerate_pairs", m.degenerate},
            {"inputs", inputs_json(flaws)},
            {"truth", m.errors ? truth_json(*m.errors) : Json()}};
}

std::string status_of(const Measurement& m, const std::string& failure) {
    if (!failure.empty()) return "failed";
    return m.agreement.ok() ? "ok" : "wrong";
}

} // namespace

Json make_record(const Cell& cell, const Scene& scene, const FrameRange& range, const Measurement& m,
                 const Outcome& outcome, const Sampling& sampling) {
    const auto& failure = outcome.failure;
    // Those the device took; of a cell that failed before that, those that were asked for.
    const auto& settings = m.settings.empty() ? cell.settings : m.settings;
    Json json;
    json["schema"] = record_schema;
    json["key"] = key_of(cell, settings, scene, range);
    json["session"] = session_id();
    json["command"] = known(without_folders(command_line()));
    json["status"] = status_of(m, failure);
    json["failure"] = known(failure);
    json["algorithm"] = cell.algorithm->name();
    json["preset"] = cell.preset;
    json["settings"] = settings.texts();
    json["asked"] = asked_json(cell.settings.texts(), settings.texts());
    json["chosen"] = cell.chosen ? choice_json(*cell.chosen) : Json();
    json["scene"] = record_scene(scene);
    json["frames"] = {{"first", range.first}, {"last", range.last}};
    json["devices"] = record_devices(cell.devices);
    const bool measured = failure.empty();
    json["sampling"] = sampling_json(m, cell, outcome, sampling);
    json["conditions"] = conditions_json(m);
    json["total_ns"] = measured || !m.samples.empty() ? total_json(m) : Json();
    json["breakdown_ns"] =
        m.breakdowns.empty() ? Json() : replays_json(m, [](const auto& replay) { return replay.frame_ns; });
    json["device_span_ns"] = device_span_json(m);
    json["stages"] = stages_json(m);
    json["kernel_times"] = kernel_times_json(m);
    json["work"] = measured ? work_json(m, *cell.algorithm) : Json();
    json["kernels"] = kernels_json(m.kernels);
    json["preparation"] =
        measured ? Json{{"host_ns", m.prepare_ns}, {"device_bytes", m.device_bytes}} : Json();
    json["agreement"] = agreement_json(m, scene);
    json["error"] = measured ? error_json(m, range.flaws) : Json();
    json["environment"] = record_environment();
    return json;
}

} // namespace tandem
