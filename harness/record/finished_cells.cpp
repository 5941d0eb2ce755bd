// SPDX-License-Identifier: MIT
#include "harness/record/finished_cells.h"

#include "harness/record/environment.h"
#include "harness/plans/key.h"
#include "harness/record/record.h"
#include "base/error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace tandem {

namespace {

/// The key of what was asked for: with the settings that the devices took otherwise as they were given.
std::string asked_key(const nlohmann::ordered_json& record) {
    auto settings = record.at("settings").get<SettingTexts>();
    for (const auto& [name, value] : record.at("asked").items()) settings[name] = value.get<std::string>();
    const auto key = record.at("key").get<std::string>();
    return with_settings(key.substr(0, key.rfind('|')), settings);
}

} // namespace

FinishedCells::FinishedCells(const RecordFile& file, const std::string& path) {
    file.for_each([&](const nlohmann::ordered_json& record) {
        if (!record.contains("key")) return; // of ceilings or a simulation
        const auto schema = record.value("schema", nlohmann::ordered_json());
        if (schema != record_schema)
            throw InputError(
                fmt::format("{}: has records of schema {}, and this program writes {}; bring them to it "
                            "with scripts/convert_records, or choose another --out",
                            path, schema.dump(), record_schema));
        try {
            take(record);
        } catch (const nlohmann::json::exception&) {
            throw InputError(fmt::format(
                "{}: the record of {} is not as results/record.schema.json says; repair it, or "
                "choose another --out",
                path, record.at("key").dump(-1, ' ', true, nlohmann::json::error_handler_t::replace)));
        }
    });
}

void FinishedCells::take(const nlohmann::ordered_json& record) {
    if (record.at("status") == "failed" || record.at("sampling").at("interrupted") == true) return;
    auto& finished = by_key_[asked_key(record)];
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
