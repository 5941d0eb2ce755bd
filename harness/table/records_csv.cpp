// SPDX-License-Identifier: MIT
#include "harness/table/records_csv.h"

#include "harness/compare/cells.h"
#include "harness/compare/each_line.h"
#include "harness/standard_streams.h"
#include "scenes/error.h"

#include <array>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace tandem {

namespace {

using Json = nlohmann::json;

/// Columns that every table has, in this order.
constexpr std::array<std::string_view, 35> fixed_columns{
    "status",         "failure",      "algorithm",  "preset",
    "device",         "device_name",  "driver",     "scene",
    "scene_digest",   "bodies",       "tetrahedra", "first_frame",
    "last_frame",     "ms",           "ms_low",     "ms_high",
    "samples",        "rounds",       "converged",  "disturbed",
    "device_span_ms", "launches",     "waits",      "candidate_pairs",
    "contacts",       "missing",      "extra",      "contact_frames_wrong",
    "pairs_missed",   "device_bytes", "commit",     "dirty",
    "date",           "session",      "key"};

/// The value at a path of names; null where it ends early.
const Json& at(const Json& json, std::initializer_list<const char*> path) {
    static const Json null;
    const auto* value = &json;
    for (const auto* name : path) {
        if (!value->is_object()) return null;
        const auto found = value->find(name);
        if (found == value->end()) return null;
        value = &*found;
    }
    return *value;
}

/// As it stands in a field of the table, but for quotes.
std::string text_of(const Json& value) {
    if (value.is_null()) return {};
    return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string quoted(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string inside;
    for (const char c : text) inside += c == '"' ? std::string("\"\"") : std::string(1, c);
    return '"' + inside + '"';
}

/// "A+B" of one field of every device.
std::string of_devices(const Json& devices, const char* field) {
    std::string text;
    for (const auto& device : devices) text += (text.empty() ? "" : "+") + text_of(at(device, {field}));
    return text;
}

std::string sum_of(const Json& numbers) {
    if (!numbers.is_array()) return {};
    std::uint64_t sum = 0;
    for (const auto& number : numbers) sum += number.get<std::uint64_t>();
    return std::to_string(sum);
}

/// The table's texts of one record, by column.
using Fields = std::map<std::string, std::string, std::less<>>;

/// Makes them of the record.
class RecordFields {
public:
    explicit RecordFields(Json record) : record_(std::move(record)) {
        const auto& frames = record_.at("frames");
        frames_ = frames.at("last").get<double>() - frames.at("first").get<double>() + 1;
        add_names();
        add_times();
        add_answer();
        for (const auto& [name, value] : at(record_, {"settings"}).items())
            fields_["set_" + name] = text_of(value);
    }

    Fields fields() && { return std::move(fields_); }

private:
    void add(const char* column, std::initializer_list<const char*> path) {
        fields_[column] = text_of(at(record_, path));
    }

    std::string milliseconds(const Json& ns) const {
        return ns.is_number() ? fmt::format("{:.9g}", ns.get<double>() / frames_ / 1e6) : std::string();
    }

    void add_names() {
        for (const auto* name : {"status", "failure", "algorithm", "preset", "session", "key"})
            add(name, {name});
        const auto& devices = record_.at("devices");
        fields_["device"] = of_devices(devices, "id");
        fields_["device_name"] = of_devices(devices, "name");
        fields_["driver"] = of_devices(devices, "driver");
        add("scene", {"scene", "key"});
        add("scene_digest", {"scene", "digest"});
        add("bodies", {"scene", "bodies"});
        add("tetrahedra", {"scene", "tetrahedra"});
        add("first_frame", {"frames", "first"});
        add("last_frame", {"frames", "last"});
        for (const auto* name : {"commit", "dirty", "date"}) add(name, {"environment", name});
    }

    void add_times() {
        const auto& total = at(record_, {"total_ns"});
        fields_["ms"] = milliseconds(at(total, {"median"}));
        fields_["ms_low"] = milliseconds(at(total, {"low"}));
        fields_["ms_high"] = milliseconds(at(total, {"high"}));
        const auto& samples = at(total, {"samples"});
        if (samples.is_array()) fields_["samples"] = std::to_string(samples.size());
        add("rounds", {"sampling", "rounds"});
        add("converged", {"sampling", "converged"});
        const auto& disturbed = at(record_, {"conditions", "disturbed"});
        if (disturbed.is_array()) fields_["disturbed"] = disturbed.empty() ? "false" : "true";
        fields_["device_span_ms"] = milliseconds(at(record_, {"device_span_ns", "median"}));
        std::uint64_t launches = 0;
        std::uint64_t waits = 0;
        for (const auto& [name, stage] : at(record_, {"stages"}).items()) {
            const auto& on_device = at(stage, {"device_ns", "median"});
            const bool has_device = on_device.is_number() && on_device.get<double>() > 0;
            fields_["stage_" + name + "_ms"] =
                milliseconds(has_device ? on_device : at(stage, {"host_ns", "median"}));
            launches += stage.value("launches", std::uint64_t{0});
            waits += stage.value("waits", std::uint64_t{0});
        }
        if (!at(record_, {"stages"}).is_object()) return;
        fields_["launches"] = std::to_string(launches);
        fields_["waits"] = std::to_string(waits);
    }

    void add_answer() {
        fields_["candidate_pairs"] = sum_of(at(record_, {"work", "candidate_pairs"}));
        fields_["contacts"] = sum_of(at(record_, {"work", "contacts"}));
        for (const auto* name : {"missing", "extra", "contact_frames_wrong"}) add(name, {"agreement", name});
        const auto& truth = at(record_, {"error", "truth"});
        if (truth.is_object())
            fields_["pairs_missed"] = std::to_string(truth.at("missed_touching").get<std::uint64_t>()
                                                     + truth.at("missed_overlapping").get<std::uint64_t>());
        add("device_bytes", {"preparation", "device_bytes"});
        for (const auto& [name, value] : at(record_, {"work", "counters"}).items())
            fields_["count_" + name] = text_of(value);
    }

    Json record_;
    Fields fields_;
    double frames_ = 1;
};

/// Fields of the record in a line, by column.
Fields fields_of(const std::string& text, const std::string& path, std::size_t line) {
    compare::read_cell(text, path, line); // says what else it is
    try {
        return RecordFields(Json::parse(text)).fields();
    } catch (const Json::exception&) {
        throw InputError(fmt::format("{}:{}: a record that lacks fields of its schema; give files that "
                                     "'tandem run --out' wrote",
                                     path, line));
    }
}

std::vector<Fields> read_rows(const std::string& path) {
    std::vector<Fields> rows;
    const bool torn = compare::each_line(
        path, [&](auto& text, std::size_t line) { rows.push_back(fields_of(text, path, line)); });
    if (torn)
        tell("{}:{}: the last line has no end, being cut off or still written: it is ignored\n", path,
             rows.size() + 1);
    if (rows.empty()) throw InputError(fmt::format("{}: has no record; name a file of records", path));
    return rows;
}

} // namespace

CsvTable records_as_csv(const std::string& path) {
    const auto rows = read_rows(path);
    std::vector<std::string> columns(fixed_columns.begin(), fixed_columns.end());
    for (const std::string_view group : {"stage_", "count_", "set_"}) {
        std::set<std::string> names;
        for (const auto& row : rows)
            for (const auto& [name, value] : row)
                if (name.starts_with(group)) names.insert(name);
        columns.insert(columns.end(), names.begin(), names.end());
    }
    std::string table;
    const auto add_line = [&](const auto& field_of) {
        for (std::size_t i = 0; i < columns.size(); ++i) {
            if (i > 0) table += ',';
            table += quoted(field_of(columns[i]));
        }
        table += '\n';
    };
    add_line([](const std::string& column) { return column; });
    for (const auto& row : rows)
        add_line([&](const std::string& column) {
            const auto found = row.find(column);
            return found == row.end() ? std::string() : found->second;
        });
    return {std::move(table), rows.size()};
}

} // namespace tandem
