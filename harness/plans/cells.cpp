// SPDX-License-Identifier: MIT
#include "harness/plans/cells.h"

#include "harness/plans/candidates.h"
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>

namespace tandem {

namespace {

template<class Value>
void add_once(std::vector<Value>& values, Value value) {
    if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
}

bool declares(const Traversal& traversal, const std::string& name) {
    const auto parameters = traversal.parameters();
    return std::any_of(parameters.begin(), parameters.end(), [&](const auto* p) { return p->name == name; });
}

/// Every combination of values of the settings that the algorithm declares. For auto (null) all settings
/// count, because each candidate uses those that it declares.
std::vector<SettingTexts> combinations(const Request& request, const Traversal* traversal) {
    std::vector<SettingTexts> all{{}};
    for (const auto& [name, values] : request.sets) {
        if (traversal != nullptr && !declares(*traversal, name)) continue;
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

/// Whether no algorithm was named by itself.
bool names_all(const Request& request) {
    return request.algorithms.empty()
           || std::ranges::find(request.algorithms, "all") != request.algorithms.end();
}

/// The algorithms of the request; null stands for auto.
std::vector<const Traversal*> choose_algorithms(const Request& request) {
    std::vector<const Traversal*> chosen;
    for (const auto& name : request.algorithms) {
        if (name == automatic && !request.may_choose)
            throw InputError("--algorithm auto is for 'tandem run' only; name an algorithm that 'tandem "
                             "algorithms' lists");
        if (name == "all")
            for (const auto* each : algorithms()) add_once(chosen, each);
        else
            add_once(chosen, name == automatic ? nullptr : &algorithm(name));
    }
    if (chosen.empty()) chosen.assign(algorithms().begin(), algorithms().end());
    return chosen;
}

/// The algorithms whose settings and presets the request may name: for auto all algorithms.
std::vector<const Traversal*> named_by(std::span<const Traversal* const> chosen) {
    if (std::find(chosen.begin(), chosen.end(), nullptr) == chosen.end())
        return {chosen.begin(), chosen.end()};
    return {algorithms().begin(), algorithms().end()};
}

/// The names of all algorithms and baselines for which `has` is true.
template<class Has>
std::vector<std::string_view> names_of_those(const Has& has) {
    std::vector<std::string_view> names;
    for (const auto& list : {algorithms(), baselines()})
        for (const auto* traversal : list)
            if (has(*traversal)) names.push_back(traversal->name());
    return names;
}

/// Throws where `what`, such as "setting", is not of the chosen algorithms but of others.
void refuse_that_of_others(std::string_view what, const std::string& name,
                           const std::vector<std::string_view>& owners,
                           std::span<const Traversal* const> chosen) {
    if (owners.empty()) return;
    std::vector<std::string_view> own;
    for (const auto* traversal : chosen) own.push_back(traversal->name());
    throw InputError(fmt::format("{} '{}' belongs to {}, not to {}; name another algorithm, or leave it out",
                                 what, name, fmt::join(owners, ", "), fmt::join(own, ", ")));
}

/// Checks the names of settings. It is no mistake when only some of the algorithms have a setting.
void check_sets(const Request& request, std::span<const Traversal* const> chosen) {
    std::set<std::string> known;
    for (const auto* traversal : chosen)
        for (const auto* parameter : traversal->parameters()) known.emplace(parameter->name);
    const std::vector<std::string> names(known.begin(), known.end());
    for (const auto& [name, values] : request.sets)
        if (!known.contains(name)) {
            // An initialiser, because clang 14 captures no structured binding.
            const auto has = [&name = name](const Traversal& traversal) {
                return std::ranges::any_of(traversal.parameters(),
                                           [&](const auto* parameter) { return parameter->name == name; });
            };
            refuse_that_of_others("setting", name, names_of_those(has), chosen);
            throw InputError(unknown("setting", name, names));
        }
    for (auto set = request.sets.begin(); set != request.sets.end(); ++set)
        if (std::any_of(request.sets.begin(), set, [&](const auto& s) { return s.first == set->first; }))
            throw InputError(
                fmt::format("--set {}=... is given twice; write --set {}=V1,V2", set->first, set->first));
}

/// Throws where a preset is asked for by a former name, and no preset of this algorithm is by its own.
void refuse_former_name(const std::string& name, const Request& request, const Traversal& traversal) {
    const auto asked = [&](const Preset& preset) {
        return std::ranges::any_of(request.presets,
                                   [&](const auto& one) { return one == "all" || one == preset.name; });
    };
    if (std::ranges::any_of(traversal.presets(), asked)) return;
    for (const auto& preset : traversal.presets())
        if (preset.former_name == name)
            throw InputError(fmt::format("preset '{}' of {} is now called '{}'; give --preset {}", name,
                                         traversal.name(), preset.name, preset.name));
}

void check_presets(const Request& request, std::span<const Traversal* const> chosen) {
    std::vector<std::string> names{"all"};
    for (const auto* traversal : chosen)
        for (const auto& candidate : traversal->presets())
            if (std::find(names.begin(), names.end(), candidate.name) == names.end())
                names.emplace_back(candidate.name);
    for (const auto& name : request.presets) {
        for (const auto* traversal : chosen) refuse_former_name(name, request, *traversal);
        if (std::find(names.begin(), names.end(), name) != names.end()) continue;
        const auto has = [&name](const Traversal& traversal) {
            return std::ranges::any_of(traversal.presets(),
                                       [&](const auto& preset) { return preset.name == name; });
        };
        refuse_that_of_others("preset", name, names_of_those(has), chosen);
        throw InputError(unknown("preset", name, names));
    }
}

/// The cells of one algorithm, or of auto, on one group of devices.
void add_cells(std::vector<Cell>& cells, const Request& request, const Traversal* traversal,
               const DeviceGroup& devices, const Unfit& unfit) {
    const auto add = [&](const auto& make) {
        try {
            cells.push_back(make());
        } catch (const InputError& error) {
            unfit(error);
        }
    };
    const auto all = combinations(request, traversal);
    if (traversal == nullptr) {
        for (const auto& given : all) add([&] { return undecided_cell(request, given, devices); });
        return;
    }
    for (const auto* preset : choose_presets(request, *traversal))
        for (const auto& given : all) add([&] { return make_cell(*traversal, *preset, given, devices); });
}

} // namespace

std::vector<const Preset*> choose_presets(const Request& request, const Traversal& traversal) {
    if (request.presets.empty()) return {&traversal.presets().front()};
    std::vector<const Preset*> chosen;
    for (const auto& candidate : traversal.presets())
        if (std::any_of(request.presets.begin(), request.presets.end(),
                        [&](const auto& name) { return name == "all" || name == candidate.name; }))
            chosen.push_back(&candidate);
    if (chosen.empty() && !names_all(request))
        throw InputError(fmt::format("{} has none of the presets {}; leave it or --preset out",
                                     traversal.name(), fmt::join(request.presets, ", ")));
    return chosen;
}

Cell make_cell(const Traversal& traversal, const Preset& preset, const SettingTexts& given,
               const DeviceGroup& devices) {
    Cell cell{&traversal, std::string(preset.name),
              resolve(traversal.parameters(), preset.values, with_rule_of_output(given), traversal.name()),
              devices};
    traversal.check(cell.devices, cell.settings);
    return cell;
}

void refuse(const InputError& error) { throw error; }

std::vector<Cell> plan(const Request& request, std::span<const DeviceGroup> devices, const Unfit& unfit) {
    const auto chosen = choose_algorithms(request);
    const auto named = named_by(chosen);
    check_sets(request, named);
    check_presets(request, named);
    std::vector<Cell> cells;
    for (const auto& group : devices)
        for (const auto* traversal : chosen) add_cells(cells, request, traversal, group, unfit);
    return cells;
}

std::size_t drop_repeated(std::vector<Cell>& cells) {
    const auto before = cells.size();
    std::vector<Cell> once;
    for (auto& cell : cells) {
        const auto is_same = [&](const Cell& other) {
            return cell.candidates.empty() && other.candidates.empty() && other.algorithm == cell.algorithm
                   && other.preset == cell.preset && other.settings == cell.settings
                   && other.devices == cell.devices;
        };
        if (std::ranges::none_of(once, is_same)) once.push_back(std::move(cell));
    }
    cells = std::move(once);
    return before - cells.size();
}

SettingTexts changes(const Cell& cell) {
    const auto base = resolve(cell.algorithm->parameters(), preset(*cell.algorithm, cell.preset).values, {},
                              cell.algorithm->name());
    SettingTexts changed;
    for (const auto& [name, value] : cell.settings.texts())
        if (base.text(name) != value) changed.emplace(name, value);
    return changed;
}

std::string method_of(const Cell& cell, const SettingTexts& left_out) {
    if (!cell.candidates.empty()) return std::string(automatic);
    std::vector<std::string> changed;
    for (const auto& [name, value] : changes(cell))
        if (!left_out.contains(name)) changed.push_back(fmt::format("{}={}", name, value));
    return fmt::format("{}{}{}", title_of(*cell.algorithm, preset(*cell.algorithm, cell.preset)),
                       changed.empty() ? "" : " ", fmt::join(changed, ","));
}

std::string describe(const Cell& cell) {
    return fmt::format("{} on {}", method_of(cell), name_of(cell.devices));
}

} // namespace tandem
