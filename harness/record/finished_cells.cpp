// SPDX-License-Identifier: MIT
#include "harness/record/finished_cells.h"

#include "harness/program/environment.h"
#include "harness/fields/field.h"
#include "harness/plans/key.h"
#include "harness/record/record.h"
#include "base/error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace tandem {

namespace {

/// The key with the settings that the user requested, which the record lists where a device changed them.
std::string requested_key(const nlohmann::ordered_json& record) {
    auto settings = record.at("settings").get<SettingTexts>();
    for (const auto& [name, value] : record.at("asked").items()) settings[name] = value.get<std::string>();
    const auto key = record.at("key").get<std::string>();
    return with_settings(key.substr(0, key.rfind('|')), settings);
}

} // namespace

FinishedCells::FinishedCells(const RecordFile& file, const std::string& path) {
    file.for_each([&](const nlohmann::ordered_json& record) {
        if (!record.contains("key")) return; // a record of ceilings or of a simulation
        const auto schema = record.value("schema", nlohmann::ordered_json());
        if (schema != record_schema)
            throw InputError(
                fmt::format("{}: has records of schema {}, but this program writes schema {}; convert "
                            "them with scripts/convert_records, or choose another --out",
                            path, schema.dump(), record_schema));
        try {
            add(record);
        } catch (const nlohmann::json::exception&) {
            throw InputError(fmt::format(
                "{}: the record of {} does not match results/record.schema.json; repair it, or "
                "choose another --out",
                path, record.at("key").dump(-1, ' ', true, nlohmann::json::error_handler_t::replace)));
        }
    });
}

void FinishedCells::add(const nlohmann::ordered_json& record) {
    if (record.at("status") == "failed" || record.at("sampling").at("interrupted") == true) return;
    auto& finished = by_key_[requested_key(record)];
    const auto& sources = record.at("environment").at("sources");
    finished.same_sources |= sources.is_string() && sources == sources_digest();
    const auto& spent = record.at("sampling").at("spent_seconds");
    finished.seconds = spent.is_null() ? 0 : spent.get<double>();
}

bool FinishedCells::has(const Cell& cell, const Scene& scene, const FrameRange& range) const {
    const auto found = by_key_.find(key_of(cell, cell.settings, scene, range));
    return found != by_key_.end() && found->second.same_sources;
}

std::optional<double> FinishedCells::seconds(const Cell& cell, const Scene& scene,
                                             const FrameRange& range) const {
    const auto found = by_key_.find(key_of(cell, cell.settings, scene, range));
    return found == by_key_.end() || found->second.seconds <= 0 ? std::nullopt
                                                                : std::optional(found->second.seconds);
}

} // namespace tandem
