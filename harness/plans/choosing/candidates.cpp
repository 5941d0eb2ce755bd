// SPDX-License-Identifier: MIT
#include "harness/plans/choosing/candidates.h"

#include "algorithms/bounds/geometry.h"
#include "algorithms/narrow_phase/contact_settings.h"
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>

namespace tandem {

namespace {

/// The given settings with alternatives, and the number of settings that differ from the preset.
struct Variant {
    SettingTexts settings;
    std::size_t changes = 0;
};

/// The given settings that the algorithm declares.
SettingTexts declared(const Traversal& traversal, const SettingTexts& given) {
    SettingTexts own;
    for (const auto* parameter : traversal.parameters())
        if (const auto found = given.find(std::string(parameter->name)); found != given.end())
            own.insert(*found);
    return own;
}

bool is_free(const Parameter& parameter, const SettingTexts& given) {
    return !parameter.alternatives().empty() && !given.contains(std::string(parameter.name))
           && !given.contains(std::string(parameter.alternative_setting));
}

/// Every combination of alternatives of the settings that are not given, with the preset's own values.
std::vector<Variant> variants(const Traversal& traversal, const Preset& preset, const SettingTexts& given) {
    const auto base = resolve(traversal.parameters(), preset.values, given, traversal.name());
    std::vector<Variant> all{{given}};
    for (const auto* parameter : traversal.parameters()) {
        if (!is_free(*parameter, given)) continue;
        const std::string name(parameter->name);
        const auto unchanged = all.size();
        for (const auto value : parameter->alternatives()) {
            if (parameter->text(value) == base.text(name)) continue;
            for (std::size_t i = 0; i < unchanged; ++i) {
                all.push_back({all[i].settings, all[i].changes + 1});
                all.back().settings[name] = parameter->text(value);
            }
        }
    }
    return all;
}

/// The geometry, as far as the answer depends on it.
Geometry geometry_of_answer(const Settings& settings) {
    auto geometry = geometry_of(settings);
    if (contacts_are_equal_for_every_k(settings)) {
        geometry.k = Geometry{}.k;
        geometry.coordinate_axes = false;
    }
    return geometry;
}

bool same_answer(const Cell& a, const Cell& b) {
    return geometry_of_answer(a.settings) == geometry_of_answer(b.settings)
           && contact_settings_of(a.settings) == contact_settings_of(b.settings)
           && a.settings[parameters::contact_rule] == b.settings[parameters::contact_rule]
           && a.settings[parameters::output] == b.settings[parameters::output];
}

/// How the devices run a cell: on the host, for example, a work-group has one work-item whatever its size.
std::string as_run(const Cell& cell) {
    std::string text(cell.algorithm->name());
    for (const auto* device : cell.devices)
        text += fmt::format("|{}", cell.algorithm->fitted(cell.settings, device->info()).texts());
    return text;
}

/// Cells with the number of settings that differ from the preset.
using Changed = std::vector<std::pair<std::size_t, Cell>>;

/// Adds the variants of one preset that fit the devices. `refusal` receives the first reason for an unfit
/// one.
void add_fitting(Changed& cells, const Traversal& traversal, const Preset& preset, const SettingTexts& given,
                 const DeviceGroup& devices, std::string& refusal) {
    for (const auto& variant : variants(traversal, preset, declared(traversal, given))) {
        try {
            cells.emplace_back(variant.changes, make_cell(traversal, preset, variant.settings, devices));
        } catch (const InputError& error) {
            if (refusal.empty()) refusal = error.what();
        }
    }
}

Changed fitting(const Request& request, const SettingTexts& given, const DeviceGroup& devices,
                std::string& refusal) {
    auto any = request; // names no algorithm, so that one without the presets is no error
    any.algorithms.clear();
    Changed cells;
    for (const auto* traversal : algorithms())
        for (const auto* preset : choose_presets(any, *traversal))
            add_fitting(cells, *traversal, *preset, given, devices, refusal);
    std::stable_sort(cells.begin(), cells.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    return cells;
}

} // namespace

std::vector<Cell> candidates(const Request& request, const SettingTexts& given, const DeviceGroup& devices) {
    std::string refusal;
    std::vector<Cell> chosen;
    std::set<std::string> seen;
    for (auto& [changes, cell] : fitting(request, given, devices, refusal))
        if ((chosen.empty() || same_answer(cell, chosen.front())) && seen.insert(as_run(cell)).second)
            chosen.push_back(std::move(cell));
    if (chosen.empty()) throw InputError(refusal);
    return chosen;
}

bool may_differ_in_k(const Cell& candidate) { return contacts_are_equal_for_every_k(candidate.settings); }

Cell undecided_cell(const Request& request, const SettingTexts& given, const DeviceGroup& devices) {
    auto all = candidates(request, given, devices);
    auto cell = all.front();
    cell.candidates = std::move(all);
    return cell;
}

} // namespace tandem
