// SPDX-License-Identifier: MIT
#include "harness/plan.h"

#include "scenes/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>

namespace tandem {

namespace {

/// Why backends have no devices, in brackets; empty when all have some.
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
    return std::any_of(parameters.begin(), parameters.end(), [&](const auto* p) { return p->name == name; });
}

/// Every combination of the values of the settings that the algorithm declares.
std::vector<SettingTexts> combinations(const Request& request, const Traversal& traversal) {
    std::vector<SettingTexts> all{{}};
    for (const auto& [name, values] : request.sets) {
        if (!declares(traversal, name)) continue;
        std::vector<SettingTexts> longer;
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

/// A setting that only some of the algorithms have is no mistake: the others go without it.
void check_sets(const Request& request, std::span<const Traversal* const> chosen) {
    std::set<std::string> known;
    for (const auto* traversal : chosen)
        for (const auto* parameter : traversal->parameters()) known.emplace(parameter->name);
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
                names.emplace_back(candidate.name);
    for (const auto& name : request.presets)
        if (std::find(names.begin(), names.end(), name) == names.end())
            throw InputError(unknown("preset", name, names));
}

/// A cell whose settings fit its device.
Cell make_cell(const Traversal& traversal, const Preset& preset, const SettingTexts& given,
               const DeviceGroup& devices) {
    Cell cell{&traversal, std::string(preset.name),
              resolve(traversal.parameters(), preset.values, given, traversal.name()), devices};
    traversal.check(cell.devices, cell.settings);
    return cell;
}

/// The device of that id; throws InputError that names the reason of absence and what there is.
Device* named_device(const std::vector<BackendReport>& backends, const std::string& name) {
    std::vector<std::string> ids;
    for (const auto& backend : backends)
        for (const auto& device : backend.devices) {
            if (device->info().id == name) return device.get();
            ids.push_back(device->info().id);
        }
    throw InputError(unknown("device", name, ids) + reasons(backends));
}

/// "D" or "D+E+..." as a group.
DeviceGroup named_group(const std::vector<BackendReport>& backends, const std::string& name) {
    DeviceGroup group;
    std::size_t begin = 0;
    for (auto end = name.find('+'); begin <= name.size(); begin = end + 1, end = name.find('+', begin)) {
        end = std::min(end, name.size());
        auto* device = named_device(backends, name.substr(begin, end - begin));
        if (std::find(group.begin(), group.end(), device) != group.end())
            throw InputError(fmt::format("device {}: {} is named twice; a device works for a cell once", name,
                                         device->info().id));
        group.push_back(device);
    }
    return group;
}

} // namespace

std::string name_of(const DeviceGroup& devices) {
    std::string name;
    for (const auto* device : devices) name += (name.empty() ? "" : "+") + device->info().id;
    return name;
}

std::vector<DeviceGroup> choose_devices(const std::vector<BackendReport>& backends,
                                        std::span<const std::string> names) {
    std::vector<DeviceGroup> chosen;
    for (const auto& name : names) {
        if (name != "all") {
            add_once(chosen, named_group(backends, name));
            continue;
        }
        for (const auto& backend : backends)
            for (const auto& device : backend.devices) add_once(chosen, DeviceGroup{device.get()});
    }
    return chosen;
}

std::vector<Cell> plan(const Request& request, std::span<const DeviceGroup> devices, Unfit unfit) {
    const auto chosen = choose_algorithms(request);
    check_sets(request, chosen);
    check_presets(request, chosen);
    std::vector<Cell> cells;
    for (const auto& group : devices)
        for (const auto* traversal : chosen)
            for (const auto* preset : choose_presets(request, *traversal))
                for (const auto& given : combinations(request, *traversal)) {
                    try {
                        cells.push_back(make_cell(*traversal, *preset, given, group));
                    } catch (const InputError&) {
                        if (unfit == Unfit::refuse) throw;
                    }
                }
    return cells;
}

/// Settings that are as the preset has them are not named, so that equal cells read the same however they
/// were asked for.
std::string describe(const Cell& cell) {
    const auto base = resolve(cell.algorithm->parameters(), preset(*cell.algorithm, cell.preset).values, {},
                              cell.algorithm->name());
    std::vector<std::string> changed;
    for (const auto& [name, value] : cell.settings.texts())
        if (base.text(name) != value) changed.push_back(fmt::format("{}={}", name, value));
    return fmt::format("{} {}{}{} on {}", cell.algorithm->name(), cell.preset, changed.empty() ? "" : " ",
                       fmt::join(changed, ","), name_of(cell.devices));
}

} // namespace tandem
