// SPDX-License-Identifier: MIT
#include "harness/record/record.h"

#include "backends/hardware.h"
#include "harness/plans/choosing/choice.h"
#include "harness/record/environment.h"
#include "harness/plans/key.h"
#include "harness/sampling/ranks/rank_team.h"
#include "harness/record/parts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>

namespace tandem {

namespace {

using record_parts::Json;

std::string hex(std::uint64_t value) { return fmt::format("{:016x}", value); }

/// Negative numbers and empty text mean unknown, which is null in a record.
Json known(std::int64_t value) { return value < 0 ? Json(nullptr) : Json(value); }

Json known(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Json digest_json(const Digest& digest) {
    return {{"count", digest.count}, {"a", hex(digest.a)}, {"b", hex(digest.b)}};
}

/// Requested values of the settings that the devices changed.
Json asked_json(const SettingTexts& requested, const SettingTexts& actual) {
    Json json = Json::object();
    for (const auto& [name, value] : requested) {
        const auto found = actual.find(name);
        if (found == actual.end() || found->second != value) json[name] = value;
    }
    return json;
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

Json record_timed_device(const Device& device) {
    auto json = record_device(device.info());
    json["clock"] = device.clock();
    return json;
}

Json record_devices(const DeviceGroup& devices) {
    Json json = Json::array();
    for (const auto* device : devices) json.push_back(record_timed_device(*device));
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

/// Values by the names that the algorithm declares; null for a counter without a value.
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

std::string status_of(const Measurement& m, const std::string& failure) {
    if (!failure.empty()) return "failed";
    return m.agreement.ok() ? "ok" : "wrong";
}

/// Takes clocks from the breakdowns: another process may have measured them, an isolated child or an earlier
/// run, with a different clock than this one.
Json devices_json(const Measurement& m, const Cell& cell) {
    auto json = record_devices(cell.devices);
    if (cell.team != nullptr) // only rank 0 has a device with a clock in this process
        for (std::size_t rank = 1; rank < cell.team->devices().size(); ++rank)
            json.push_back(record_device(cell.team->devices()[rank]));
    for (std::size_t i = 0; i < json.size(); ++i) {
        std::set<std::string> clocks;
        for (const auto& replay : m.breakdowns)
            if (i < replay.clocks.size()) clocks.insert(replay.clocks[i]);
        if (!clocks.empty()) json[i]["clock"] = fmt::format("{}", fmt::join(clocks, "; "));
    }
    return json;
}

} // namespace

Json make_record(const Cell& cell, const Scene& scene, const FrameRange& range, const Measurement& m,
                 const Outcome& outcome, const Sampling& sampling) {
    const auto& failure = outcome.failure;
    // The settings that the device used. A cell that failed earlier has only the requested ones.
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
    json["frames"] = {{"first", range.first()}, {"last", range.last()}};
    json["devices"] = devices_json(m, cell);
    json["ranks"] = cell.team != nullptr ? Json(cell.team->devices().size()) : Json();
    const bool measured = failure.empty();
    json["sampling"] = record_parts::sampling_json(m, cell, outcome, sampling);
    json["conditions"] = record_parts::conditions_json(m);
    record_parts::add_times(json, m, measured);
    json["partition"] = record_parts::partition_json(m, cell);
    json["work"] = measured ? work_json(m, *cell.algorithm) : Json();
    json["kernels"] = kernels_json(m.kernels);
    json["preparation"] =
        measured ? Json{{"host_ns", m.prepare_ns}, {"device_bytes", m.device_bytes}} : Json();
    json["agreement"] = agreement_json(m, scene);
    json["error"] = measured ? record_parts::error_json(m, range.flaws()) : Json();
    json["environment"] = record_environment();
    return json;
}

} // namespace tandem
