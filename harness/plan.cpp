// SPDX-License-Identifier: MIT
#include "harness/plan.h"

#include "scenes/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>

namespace tandem {

namespace {

std::string reasons(const std::vector<BackendReport>& backends) {
    std::string text;
    for (const auto& backend : backends)
        if (!backend.reason.empty()) text += (text.empty() ? "" : "; ") + backend.reason;
    return text.empty() ? "" : fmt::format(" ({})", text);
}

template<class Value>
void add_once(std::vector<Value>& values, Value value) {
    if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
}

bool declares(const Traversal& traversal, const std::string& name) {
    const auto parameters = traversal.parameters();
    return std::any_of(parameters.begin(), parameters.end(), [&](const auto& p) { return p.name == name; });
}

/// Every combination of the values of the settings that the algorithm declares.
std::vector<Settings> combinations(const Request& request, const Traversal& traversal) {
    std::vector<Settings> all{{}};
    for (const auto& [name, values] : request.sets) {
        if (!declares(traversal, name)) continue;
        std::vector<Settings> longer;
        for (const auto& settings : all) {
            for (const auto& value : values) {
                longer.push_back(settings);
                longer.back()[name] = value;
            }
        }
        all = std::move(longer);
    }
    return all;
}

std::vector<const Traversal*> choose_algorithms(const Request& request) {
    std::vector<const Traversal*> chosen;
    for (const auto& name : request.algorithms) add_once(chosen, &algorithm(name));
    if (chosen.empty()) chosen.assign(algorithms().begin(), algorithms().end());
    return chosen;
}

void check_sets(const Request& request, std::span<const Traversal* const> chosen) {
    std::set<std::string> known;
    for (const auto* traversal : chosen)
        for (const auto& parameter : traversal->parameters()) known.insert(parameter.name);
    const std::vector<std::string> names(known.begin(), known.end());
    for (const auto& [name, values] : request.sets)
        if (!known.contains(name)) throw InputError(unknown("setting", name, names));
    for (auto set = request.sets.begin(); set != request.sets.end(); ++set)
        if (std::any_of(request.sets.begin(), set, [&](const auto& s) { return s.first == set->first; }))
            throw InputError(
                fmt::format("--set {}=... is given twice; write --set {}=V1,V2", set->first, set->first));
}

/// The presets of `traversal` that the request names; its first when it names none at all.
std::vector<const Preset*> choose_presets(const Request& request, const Traversal& traversal) {
    if (request.presets.empty()) return {&traversal.presets().front()};
    std::vector<const Preset*> chosen;
    for (const auto& candidate : traversal.presets())
        if (std::any_of(request.presets.begin(), request.presets.end(),
                        [&](const auto& name) { return name == "all" || name == candidate.name; }))
            chosen.push_back(&candidate);
    if (chosen.empty() && !request.algorithms.empty())
        throw InputError(fmt::format("{} has none of the presets {}; leave it or --preset out",
                                     traversal.name(), fmt::join(request.presets, ", ")));
    return chosen;
}

void check_presets(const Request& request, std::span<const Traversal* const> chosen) {
    std::vector<std::string> names{"all"};
    for (const auto* traversal : chosen)
        for (const auto& candidate : traversal->presets())
            if (std::find(names.begin(), names.end(), candidate.name) == names.end())
                names.push_back(candidate.name);
    for (const auto& name : request.presets)
        if (std::find(names.begin(), names.end(), name) == names.end())
            throw InputError(unknown("preset", name, names));
}

/// A cell whose settings fit its device.
Cell make_cell(const Traversal& traversal, const Preset& preset, const Settings& given, Device& device) {
    Cell cell{&traversal, preset.name,
              resolve(traversal.parameters(), preset.values, given, traversal.name()), &device};
    traversal.check(cell.settings, device.info());
    return cell;
}

} // namespace

std::vector<Device*> choose_devices(const std::vector<BackendReport>& backends,
                                    std::span<const std::string> names) {
    std::vector<Device*> present;
    std::vector<std::string> ids;
    for (const auto& backend : backends) {
        for (const auto& device : backend.devices) {
            present.push_back(device.get());
            ids.push_back(device->info().id);
        }
    }
    std::vector<Device*> chosen;
    for (const auto& name : names) {
        if (name == "all") {
            for (auto* device : present) add_once(chosen, device);
            continue;
        }
        if (name.find('+') != std::string::npos)
            throw InputError(fmt::format(
                "device {}: one cell on several devices is not supported yet; list them with ','", name));
        const auto found = std::find(ids.begin(), ids.end(), name);
        if (found == ids.end()) throw InputError(unknown("device", name, ids) + reasons(backends));
        add_once(chosen, present[static_cast<std::size_t>(found - ids.begin())]);
    }
    return chosen;
}

std::vector<Cell> plan(const Request& request, std::span<Device* const> devices, Unfit unfit) {
    const auto chosen = choose_algorithms(request);
    check_sets(request, chosen);
    check_presets(request, chosen);
    std::vector<Cell> cells;
    for (auto* device : devices)
        for (const auto* traversal : chosen)
            for (const auto* preset : choose_presets(request, *traversal))
                for (const auto& given : combinations(request, *traversal)) {
                    try {
                        cells.push_back(make_cell(*traversal, *preset, given, *device));
                    } catch (const InputError&) {
                        if (unfit == Unfit::refuse) throw;
                    }
                }
    return cells;
}

std::string describe(const Cell& cell) {
    const auto base = resolve(cell.algorithm->parameters(), preset(*cell.algorithm, cell.preset).values, {},
                              cell.algorithm->name());
    std::vector<std::string> changed;
    for (const auto& [name, value] : cell.settings)
        if (base.at(name) != value) changed.push_back(fmt::format("{}={}", name, value));
    return fmt::format("{} {}{}{} on {}", cell.algorithm->name(), cell.preset, changed.empty() ? "" : " ",
                       fmt::join(changed, ","), cell.device->info().id);
}

} // namespace tandem
