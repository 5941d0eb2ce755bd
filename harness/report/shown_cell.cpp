// SPDX-License-Identifier: MIT
#include "harness/report/records.h"
#include "harness/statistics.h"
#include "harness/text_lines.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem::report {

namespace {

using Record = nlohmann::json;

/// The value at a path of names; null where it ends early.
const Record& at(const Record& record, std::initializer_list<const char*> path) {
    static const Record null;
    const auto* value = &record;
    for (const auto* name : path) {
        if (!value->is_object()) return null;
        const auto found = value->find(name);
        if (found == value->end()) return null;
        value = &*found;
    }
    return *value;
}

/// Nanoseconds of a replay as milliseconds of a frame.
Json per_frame(const Record& ns, double frames) {
    return ns.is_number() ? Json(rounded(ns.get<double>() / frames / 1e6)) : Json();
}

Json time_of(const Record& summary, double frames) {
    if (!at(summary, {"median"}).is_number()) return nullptr;
    return {per_frame(summary.at("median"), frames), per_frame(at(summary, {"low"}), frames),
            per_frame(at(summary, {"high"}), frames)};
}

/// Of a text as long as anyone reads; null of none.
Json shown_text(const Record& text) {
    return text.is_string() ? Json(one_line(text.get<std::string>(), 2000)) : Json();
}

Json sum_of(const Record& counts) {
    if (!counts.is_array()) return nullptr;
    std::uint64_t sum = 0;
    for (const auto& count : counts) sum += count.get<std::uint64_t>();
    return sum;
}

/// {stage: [device ms, host ms, launches, waits]} of a frame.
Json stages_of(const Record& record, double frames) {
    Json stages = Json::object();
    for (const auto& [name, stage] : at(record, {"stages"}).items())
        stages[name] = {per_frame(at(stage, {"device_ns", "median"}), frames),
                        per_frame(at(stage, {"host_ns", "median"}), frames),
                        stage.value("launches", std::uint64_t{0}), stage.value("waits", std::uint64_t{0})};
    return stages;
}

/// [launches, waits] of a replay; nulls where no stages were timed.
std::pair<Json, Json> counts_of(const Json& stages) {
    if (stages.empty()) return {};
    std::uint64_t launches = 0;
    std::uint64_t waits = 0;
    for (const auto& [name, stage] : stages.items()) {
        launches += stage[2].get<std::uint64_t>();
        waits += stage[3].get<std::uint64_t>();
    }
    return {launches, waits};
}

/// What the exact truth said of the answer; null where it was not asked.
Json error_of(const Record& record) {
    const auto& truth = at(record, {"error", "truth"});
    if (!truth.is_object()) return nullptr;
    const auto missed = truth.at("missed_touching").get<std::uint64_t>()
                        + truth.at("missed_overlapping").get<std::uint64_t>();
    const auto meeting =
        missed + truth.at("touching").get<std::uint64_t>() + truth.at("overlapping").get<std::uint64_t>();
    const auto candidates = truth.at("candidates").get<double>();
    const auto wrongly_kept = truth.at("false").get<double>();
    Json error{
        {"missed", missed},
        {"missed_share",
         meeting > 0 ? Json(rounded(static_cast<double>(missed) / static_cast<double>(meeting))) : Json()},
        {"false_share", candidates > 0 ? Json(rounded(wrongly_kept / candidates)) : Json()}};
    const auto& contacts = at(truth, {"contacts"});
    for (const auto* name : {"depth_relative", "normal_degrees", "point", "hausdorff", "volume_relative"})
        if (const auto& median = at(contacts, {name, "median"}); median.is_number())
            error[name] = rounded(median.get<double>());
    return error;
}

/// The median of the replays, by frame.
Json curve_of(const Record& replays) {
    constexpr std::size_t most_frames = 512;
    if (!replays.is_array() || replays.empty() || replays[0].size() < 2) return nullptr;
    const auto count = std::min(replays[0].size(), most_frames);
    Json curve = Json::array();
    for (std::size_t frame = 0; frame < count; ++frame) {
        std::vector<double> times;
        for (const auto& replay : replays)
            if (frame < replay.size()) times.push_back(replay[frame].get<double>());
        curve.push_back(rounded(median(times) / 1e6));
    }
    return curve;
}

Json rounds_of(const compare::RecordedCell& cell, double frames) {
    Json rounds = Json::array();
    for (const auto& round : cell.rounds) rounds.push_back(rounded(round.ns / frames / 1e6));
    return rounds;
}

std::string device_of(const Record& record) {
    std::string text;
    for (const auto& device : record.at("devices"))
        text += fmt::format("{}{} ({})", text.empty() ? "" : " + ", device.at("id").get<std::string>(),
                            device.at("name").get<std::string>());
    return text;
}

Json commit_of(const compare::RecordedCell& cell) {
    return (cell.commit.empty() ? "unknown" : cell.commit) + (cell.dirty ? ", with changes" : "");
}

} // namespace

double rounded(double value) { return std::stod(fmt::format("{:.6g}", value)); }

const std::vector<CellField> cell_fields{{"algorithm", true},
                                         {"preset", true},
                                         {"device", true},
                                         {"driver", true},
                                         {"scene", true},
                                         {"frames", true},
                                         {"status", true},
                                         {"failure", true},
                                         {"settings", true},
                                         {"ms"},
                                         {"rounds"},
                                         {"samples"},
                                         {"stages"},
                                         {"launches"},
                                         {"waits"},
                                         {"pairs"},
                                         {"contacts"},
                                         {"error"},
                                         {"conditions", true},
                                         {"sampling", true},
                                         {"commit", true},
                                         {"date"},
                                         {"command", true},
                                         {"file"},
                                         {"line"},
                                         {"bodies"},
                                         {"tetrahedra"},
                                         {"label"}};

ShownCell shown_cell(const Record& record, const std::string& path, std::size_t line, std::size_t file) {
    ShownCell cell{.recorded = compare::read_parsed_cell(record, path, line)};
    const auto& read = cell.recorded;
    const auto first = record.at("frames").at("first").get<std::uint64_t>();
    const auto last = record.at("frames").at("last").get<std::uint64_t>();
    cell.frames = static_cast<double>(last - std::min(first, last) + 1);
    cell.scene = record.at("scene").at("key").get<std::string>();
    cell.scene_name = record.at("scene").at("name").get<std::string>();
    cell.scene_digest = record.at("scene").at("digest").get<std::string>();
    const auto& total = at(record, {"total_ns"});
    auto stages = stages_of(record, cell.frames);
    auto [launches, waits] = counts_of(stages);
    cell.row = Json::array({read.names[0].second,
                            read.names[1].second,
                            device_of(record),
                            read.names[4].second,
                            cell.scene,
                            fmt::format("{}:{}", first, last),
                            read.status,
                            shown_text(at(record, {"failure"})),
                            read.settings,
                            time_of(total, cell.frames),
                            read.rounds.size(),
                            read.samples,
                            std::move(stages),
                            std::move(launches),
                            std::move(waits),
                            sum_of(at(record, {"work", "candidate_pairs"})),
                            sum_of(at(record, {"work", "contacts"})),
                            error_of(record),
                            conditions_text(record),
                            sampling_text(record),
                            commit_of(read),
                            shown_text(at(record, {"environment", "date"})),
                            shown_text(at(record, {"command"})),
                            file,
                            line,
                            at(record, {"scene", "bodies"}),
                            at(record, {"scene", "tetrahedra"})});
    cell.curve = curve_of(at(total, {"frames"}));
    cell.rounds = rounds_of(read, cell.frames);
    return cell;
}

} // namespace tandem::report
