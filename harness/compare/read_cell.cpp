// SPDX-License-Identifier: MIT
#include "harness/compare/cells.h"

#include "harness/statistics.h"
#include "scenes/error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace tandem::compare {

namespace {

using Json = nlohmann::json;

/// What a line is instead of a record; read_cell() adds where.
struct NoRecord : std::runtime_error {
    using std::runtime_error::runtime_error;
};

constexpr auto what_to_give = "give files that 'tandem run --out' wrote";

/// Empty where the field is null or not there.
std::string text_at(const Json& json, const char* name) {
    const auto found = json.find(name);
    return found == json.end() || found->is_null() ? std::string() : found->get<std::string>();
}

void check_schema(const Json& json) {
    if (!json.is_object() || !json.contains("schema") || !json.contains("key"))
        throw NoRecord(fmt::format("is no record of a cell; {}", what_to_give));
    const auto schema = json.at("schema").get<std::int64_t>();
    if (schema < 2)
        throw NoRecord(
            fmt::format("a record of schema {}; bring it to schema 2 with scripts/convert_records", schema));
    if (schema > 3)
        throw NoRecord(fmt::format("a record of schema {}, and this program knows 2 and 3; compare with the "
                                   "program that wrote it",
                                   schema));
}

/// "A+B" of one field of every device.
std::string of_devices(const Json& devices, const char* field) {
    std::string text;
    for (const auto& device : devices)
        text += (text.empty() ? "" : "+") + device.at(field).get<std::string>();
    return text;
}

/// "NAME:par=value,par=value": parameters become settings, which the scene's name goes without.
std::string split_scene(const std::string& key, std::map<std::string, std::string>& settings) {
    const auto colon = key.find(':');
    if (colon == std::string::npos) return key;
    std::map<std::string, std::string> parameters;
    for (std::size_t at = colon; at < key.size();) {
        const auto end = std::min(key.find(',', at + 1), key.size());
        const auto equals = key.find('=', at);
        if (equals >= end) return key;
        parameters[key.substr(at + 1, equals - at - 1)] = key.substr(equals + 1, end - equals - 1);
        at = end;
    }
    // A parameter with the name of a setting would hide it.
    for (const auto& [name, value] : parameters)
        if (settings.contains(name)) return key;
    settings.merge(parameters);
    return key.substr(0, colon);
}

/// What was done with flawed tetrahedra where that changes answers; records from before it do not say.
std::string handling_of(const Json& json) {
    const auto error = json.find("error");
    if (error == json.end() || !error->is_object() || !error->contains("inputs")) return {};
    const auto handling = error->at("inputs").at("handling").get<std::string>();
    return handling == "flat" ? "" : "degenerate=" + handling;
}

void read_names(const Json& json, RecordedCell& cell) {
    cell.settings = json.at("settings").get<std::map<std::string, std::string>>();
    const auto& devices = json.at("devices");
    const auto& frames = json.at("frames");
    const auto& scene = json.at("scene");
    cell.names = {{"algorithm", json.at("algorithm").get<std::string>()},
                  {"preset", json.at("preset").get<std::string>()},
                  {"devices", of_devices(devices, "id")},
                  {"model", of_devices(devices, "name")},
                  {"driver", of_devices(devices, "driver")},
                  {"scene", split_scene(scene.at("key").get<std::string>(), cell.settings)},
                  {"frames", fmt::format("frames {}:{}", frames.at("first").get<std::uint64_t>(),
                                         frames.at("last").get<std::uint64_t>())},
                  {"handling", handling_of(json)},
                  {"digest", "digest " + scene.at("digest").get<std::string>()}};
    const auto is_gpu = [](const Json& device) { return device.at("kind") == "gpu"; };
    cell.on_gpus = !devices.empty() && std::all_of(devices.begin(), devices.end(), is_gpu);
}

/// Work has the digest, checked or not; records from before that have it where they were checked.
std::optional<Answer> answer_of(const Json& json, const char* name) {
    for (const auto* place : {"work", "agreement"}) {
        const auto part = json.find(place);
        if (part == json.end() || !part->is_object() || !part->contains(name)) continue;
        const auto& digest = part->at(name);
        return Answer{digest.at("count").get<std::uint64_t>(), digest.at("a").get<std::string>(),
                      digest.at("b").get<std::string>()};
    }
    return std::nullopt;
}

void read_times(const Json& json, RecordedCell& cell) {
    const auto found = json.find("total_ns");
    if (found == json.end() || found->is_null()) return;
    const auto samples = found->at("samples").get<std::vector<double>>();
    cell.samples = samples.size();
    const bool in_rounds = cell.schema >= 3 && found->contains("rounds");
    if (cell.schema >= 3 && !in_rounds && !samples.empty())
        throw NoRecord("total_ns has no rounds, which schema 3 asks for; record the cell again");
    auto numbers =
        in_rounds ? found->at("rounds").get<std::vector<std::int64_t>>() : std::vector<std::int64_t>();
    if (in_rounds && numbers.size() != samples.size())
        throw NoRecord(fmt::format("total_ns has {} samples and {} rounds; record the cell again",
                                   samples.size(), numbers.size()));
    std::map<std::int64_t, std::vector<double>> rounds;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (!(samples[i] > 0))
            throw NoRecord(fmt::format("a sample of {} ns is no time; record the cell again", samples[i]));
        rounds[in_rounds ? numbers[i] : static_cast<std::int64_t>(i)].push_back(samples[i]);
    }
    for (const auto& [number, values] : rounds) cell.rounds.push_back({number, median(values)});
}

RecordedCell cell_of(const Json& json, std::size_t line) {
    check_schema(json);
    RecordedCell cell;
    cell.line = line;
    cell.schema = json.at("schema").get<int>();
    cell.key = json.at("key").get<std::string>();
    cell.status = json.at("status").get<std::string>();
    cell.failure = text_at(json, "failure");
    read_names(json, cell);
    cell.session = text_at(json, "session");
    const auto sampling = json.find("sampling");
    if (sampling != json.end() && sampling->is_object() && sampling->contains("seed")
        && sampling->at("seed").is_number_unsigned())
        cell.seed = sampling->at("seed").get<std::uint64_t>();
    read_times(json, cell);
    cell.pairs = answer_of(json, "digest");
    cell.contacts = answer_of(json, "contact_digest");
    const auto& environment = json.at("environment");
    cell.commit = text_at(environment, "commit");
    cell.processor = text_at(environment, "processor");
    cell.dirty = environment.at("dirty").get<bool>();
    return cell;
}

} // namespace

RecordedCell read_parsed_cell(const Json& record, const std::string& path, std::size_t line) {
    try {
        if (record.is_discarded()) throw NoRecord(fmt::format("is not JSON; {}", what_to_give));
        return cell_of(record, line);
    } catch (const NoRecord& problem) {
        throw InputError(fmt::format("{}:{}: {}", path, line, problem.what()));
    } catch (const Json::exception& problem) {
        // "[json.exception.type_error.302] what": the number means nothing to a user.
        const std::string what = problem.what();
        throw InputError(fmt::format("{}:{}: is no record of a cell ({}); {}", path, line,
                                     what.substr(std::min(what.find("] ") + 2, what.size())), what_to_give));
    }
}

RecordedCell read_cell(const std::string& text, const std::string& path, std::size_t line) {
    return read_parsed_cell(Json::parse(text, nullptr, false), path, line);
}

} // namespace tandem::compare
