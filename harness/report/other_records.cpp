// SPDX-License-Identifier: MIT
// Profiles, ceilings and simulations as the page draws them.
#include "harness/report/records.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fmt/format.h>

namespace tandem::report {

namespace {

using Record = nlohmann::json;

std::string first_device(const Record& record) {
    const auto& device = record.at("devices").at(0);
    return fmt::format("{} ({})", device.at("id").get<std::string>(), device.at("name").get<std::string>());
}

std::string name_of(const Record& record) {
    auto name = fmt::format("{} {} k = {}, {}, on {}", record.at("algorithm").get<std::string>(),
                            record.at("preset").get<std::string>(),
                            record.at("settings").value("k", std::string("?")),
                            record.at("scene").at("key").get<std::string>(), first_device(record));
    if (record.at("status") != "ok")
        name = fmt::format("{}: {}", record.at("status").get<std::string>(), name);
    return name;
}

Json number_at(const Record& record, const char* name) {
    const auto value = record.value(name, Record());
    return value.is_number() ? Json(rounded(value.get<double>())) : Json();
}

} // namespace

Json shown_profile(const Record& record, const std::string& path) {
    Json kernels = Json::array();
    for (const auto& kernel : record.at("kernels")) {
        const auto& ns = kernel.at("device_ns");
        Json shown{{"entry", kernel.at("entry").get<std::string>()},
                   {"stage", kernel.at("stage").get<std::string>()},
                   {"ms",
                    {ns.at("median").get<double>() / 1e6, ns.at("low").get<double>() / 1e6,
                     ns.at("high").get<double>() / 1e6}}};
        for (const auto* name : {"share", "launches", "bytes", "operations", "bytes_per_s",
                                 "operations_per_s", "of_bytes", "of_operations", "over_floor", "occupancy"})
            shown[name] = number_at(kernel, name);
        shown["bound"] = kernel.value("bound", Record());
        kernels.push_back(std::move(shown));
    }
    Json ceilings = Json::object();
    for (const auto* name : {"bytes_per_s", "cached_bytes_per_s", "operations_per_s"})
        ceilings[name] = number_at(record.at("ceilings"), name);
    return {{"name", name_of(record)},
            {"file", std::filesystem::path(path).filename().string()},
            {"ceilings", ceilings},
            {"kernels", kernels}};
}

Json shown_ceilings(const Record& record) {
    const auto& device = record.at("device");
    Json shown{{"device", fmt::format("{} ({})", device.at("id").get<std::string>(),
                                      device.at("name").get<std::string>())},
               {"date", record.at("environment").at("date").get<std::string>()}};
    for (const auto& [name, value] : record.items())
        if (value.is_object() && value.contains("median"))
            shown["values"][name] = rounded(value.at("median").get<double>());
    return shown;
}

/// Steps of one session; of more than can be drawn every so many.
struct Simulations::Run {
    static constexpr std::size_t most = 600;
    std::string session, name, status, failure;
    std::size_t steps = 0, stride = 1;
    std::vector<Json> kept; ///< [step, ms by part..., contacts found, contacts kept]

    void add(Json step) {
        if (steps++ % stride != 0) return;
        kept.push_back(std::move(step));
        if (kept.size() < most) return;
        stride *= 2;
        std::vector<Json> fewer;
        for (std::size_t i = 0; i < kept.size(); i += 2) fewer.push_back(std::move(kept[i]));
        kept = std::move(fewer);
    }
};

namespace {

constexpr std::array host_parts{"broad", "narrow", "reduce", "assemble", "solve", "move"};

Json step_of(const Record& line) {
    auto step = Json::array({line.at("step").get<std::size_t>()});
    for (const auto* part : host_parts)
        step.push_back(rounded(line.at("host_ns").at(part).get<double>() / 1e6));
    for (const auto* count : {"contacts_found", "contacts_kept"})
        step.push_back(line.at(count).get<std::uint64_t>());
    return step;
}

} // namespace

void Simulations::add(const Record& line, const std::string& path) {
    const auto session = path + line.value("session", std::string());
    auto found = std::ranges::find(runs_, session, [](const auto& run) { return run->session; });
    if (found == runs_.end()) {
        runs_.push_back(std::make_shared<Run>());
        found = std::prev(runs_.end());
        (*found)->session = session;
        (*found)->name = std::filesystem::path(path).filename().string();
    }
    auto& run = **found;
    if (line.at("kind") == "step") return run.add(step_of(line));
    run.name =
        fmt::format("{}, contacts by {}", line.at("scene").at("key").get<std::string>(), name_of(line));
    run.status = line.at("status").get<std::string>();
    if (const auto failure = line.value("failure", Record()); failure.is_string()) run.failure = failure;
}

Json Simulations::shown() const {
    Json all = Json::array();
    for (const auto& run : runs_) {
        if (all.size() == most_runs) break;
        all.push_back({{"name", run->name},
                       {"status", run->status.empty() ? "not ended" : run->status},
                       {"failure", run->failure},
                       {"steps", run->steps},
                       {"parts", host_parts},
                       {"kept", run->kept}});
    }
    return all;
}

} // namespace tandem::report
