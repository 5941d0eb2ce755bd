// SPDX-License-Identifier: MIT
#include "harness/record/record.h"

#include "harness/choosing/choice.h"
#include "harness/plans/key.h"
#include "harness/record/parts.h"
#include "harness/record/schema.h"
#include "harness/plans/rank_team.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>

namespace tandem::record_parts {

namespace {

/// The settings that the device used. A cell that failed earlier has only the requested ones.
const Settings& settings_of(const CellRecord& r) {
    return r.m.settings.empty() ? r.cell.settings : r.m.settings;
}

/// Requested values of the settings that the devices changed.
Json asked_json(const CellRecord& r) {
    const auto actual = settings_of(r).texts();
    Json json = Json::object();
    for (const auto& [name, value] : r.cell.settings.texts()) {
        const auto found = actual.find(name);
        if (found == actual.end() || found->second != value) json[name] = value;
    }
    return json;
}

std::string status_of(const CellRecord& r) {
    if (!r.is_measured()) return "failed";
    return r.m.agreement.ok() ? "ok" : "wrong";
}

/// Takes clocks from the breakdowns: another process may have measured them, an isolated child or an earlier
/// run, with a different clock than this one.
Json devices_json(const CellRecord& r) {
    std::vector<RecordedDevice> devices;
    for (const auto* device : r.cell.devices) devices.push_back({device->info(), device->clock()});
    if (r.cell.team != nullptr) // only rank 0 has a device with a clock in this process
        for (std::size_t rank = 1; rank < r.cell.team->devices().size(); ++rank)
            devices.push_back({r.cell.team->devices()[rank], {}});
    for (std::size_t i = 0; i < devices.size(); ++i) {
        std::set<std::string> clocks;
        for (const auto& replay : r.m.breakdowns)
            if (i < replay.clocks.size()) clocks.insert(replay.clocks[i]);
        if (!clocks.empty()) devices[i].clock = fmt::format("{}", fmt::join(clocks, "; "));
    }
    return array_json(device_fields(), devices);
}

/// Which run it was, and how it ended.
Fields<CellRecord> run_fields() {
    return {
        {"schema", constant(record_schema),
         "version of this schema; scripts/convert_records brings records of versions 1 to 3 to it",
         [](auto&) { return record_schema; }},
        {"key",
         text(),
         "algorithm|back end:model, driver of each device joined by +|scene with "
         "parameters@digest|first:last|"
         "settings; first:last,degenerate=skip where tetrahedra were skipped; records of equal keys are "
         "comparable: the same thing was measured on the same model of device with the same driver",
         [](auto& r) { return key_of(r.cell, settings_of(r), r.scene, r.range); },
         {.column = "key"}},
        {"session",
         nullable(pattern_of_digest()),
         "of all records that one run of the program wrote: their cells took turns; null in records from "
         "before it",
         [](auto&) { return session_id(); },
         {.column = "session"}},
        {"command", nullable(text()), "command line of that run; null when unknown",
         [](auto&) { return known_or_null(without_folders(command_line())); }},
        {"status",
         one_of({"ok", "wrong", "failed"}),
         "ok: no difference from the reference, or not compared (agreement null); wrong: an answer or a "
         "timed sample differs; failed: the cell did not finish; it has the samples that were taken before",
         status_of,
         {.column = "status"}},
        {"failure",
         nullable(text()),
         "why the cell did not finish; null unless status is failed",
         [](auto& r) { return known_or_null(r.outcome.failure); },
         {.column = "failure"}}};
}

Json steps_json(const CellRecord& r) {
    if (!r.scene.step) return nullptr;
    Json steps = Json::array();
    bool are_numbers = true;
    for (auto frame = r.range.first(); frame <= r.range.last(); ++frame) {
        steps.push_back(r.scene.step(frame));
        are_numbers &= steps.back() == frame;
    }
    return are_numbers ? Json() : steps;
}

/// What was measured.
Fields<CellRecord> subject_fields() {
    return {{"algorithm",
             text(),
             "name, as 'tandem algorithms' lists it",
             [](auto& r) { return r.cell.algorithm->name(); },
             {.column = "algorithm"}},
            {"preset",
             text(),
             "preset of the algorithm that the settings started from",
             [](auto& r) { return r.cell.preset; },
             {.column = "preset"}},
            {"settings", settings_type(),
             "every setting of the algorithm as the device took it, such as group_size 1 on host; 'tandem "
             "algorithms' explains each",
             [](auto& r) { return settings_of(r).texts(); }},
            {"asked", settings_type(),
             "settings that the devices did not take as they were asked for, as they were", asked_json},
            {"chosen",
             nullable(choice_type(
                 "how algorithm and settings were chosen; null where the user named them; records from "
                 "before it have none")),
             "",
             [](auto& r) { return r.cell.chosen ? *r.cell.chosen : Json(); },
             {.optional = true}},
            {"scene", scene_fields().type("what was collided"), "",
             [](auto& r) { return scene_fields().write(r.scene); }},
            {"frames", frames_fields().type("range of frames that a sample replays once"), "",
             [](auto& r) {
                 return frames_fields().write({r.range.first(), r.range.last()});
             }},
            {"steps",
             nullable(array_of(count())),
             "the steps of the simulation that these frames are of, in a recording whose frames are not "
             "numbered by their steps; else null",
             steps_json,
             {.since = 4}},
            {"devices", array_of(device_fields().type("one device")).with("minItems", 1),
             "devices the cell ran on", devices_json},
            {"ranks",
             nullable(integer_from(2)),
             "ranks of a job that shared the frames, started by a launcher of MPI, each with one of devices, "
             "in their order; null where one process did them",
             [](auto& r) { return r.cell.team != nullptr ? Json(r.cell.team->devices().size()) : Json(); },
             {.since = 4}}};
}

const Fields<CellRecord>& record_fields() {
    static const auto fields =
        run_fields()
            .with(subject_fields())
            .with(sampling_fields())
            .with(time_fields())
            .with(partition_fields())
            .with(answer_fields())
            .with(error_fields())
            .with({{"environment",
                    environment_fields().type("where, when and with what the record was made; no host name"),
                    "", [](auto&) { return environment_fields().write(environment()); }}});
    return fields;
}

} // namespace

Type record_type() {
    return with_record_rules(record_fields().type(
        "One measured cell: algorithm x settings x scene x devices. One object a line; unknown is null."));
}

} // namespace tandem::record_parts

namespace tandem {

nlohmann::ordered_json make_record(const Cell& cell, const Scene& scene, const FrameRange& range,
                                   const Measurement& m, const Outcome& outcome, const Sampling& sampling) {
    return record_parts::record_fields().write({cell, scene, range, m, outcome, sampling});
}

} // namespace tandem
