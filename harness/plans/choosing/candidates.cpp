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

/// Settings over those that were given, and of how many a preset has another value.
struct Variant {
    SettingTexts settings;
    std::size_t changes = 0;
};

/// Those of the settings that the algorithm declares.
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

/// Every combination of the alternatives of the settings that nobody gave; the preset's own values too.
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

bool same_answer(const Cell& a, const Cell& b) {
    return geometry_of(a.settings) == geometry_of(b.settings)
           && contact_settings_of(a.settings) == contact_settings_of(b.settings)
           && a.settings[parameters::contact_rule] == b.settings[parameters::contact_rule]
           && a.settings[parameters::output] == b.settings[parameters::output];
}

/// What the devices make of a cell: on the host work-groups of any size are of one work-item.
std::string as_taken(const Cell& cell) {
    std::string text(cell.algorithm->name());
    for (const auto* device : cell.devices)
        text += fmt::format("|{}", cell.algorithm->fitted(cell.settings, device->info()).texts());
    return text;
}

/// Cells with the changes that each takes.
using Changed = std::vector<std::pair<std::size_t, Cell>>;

/// Adds what of one preset fits the devices. `refusal` keeps why the first that does not fit does not.
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
    auto any = request; // an algorithm without the presets is no mistake here
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
    std::set<std::string> taken;
    for (auto& [changes, cell] : fitting(request, given, devices, refusal))
        if ((chosen.empty() || same_answer(cell, chosen.front())) && taken.insert(as_taken(cell)).second)
            chosen.push_back(std::move(cell));
    if (chosen.empty()) throw InputError(refusal);
    return chosen;
}

Cell undecided_cell(const Request& request, const SettingTexts& given, const DeviceGroup& devices) {
    auto all = candidates(request, given, devices);
    auto cell = all.front();
    cell.candidates = std::move(all);
    return cell;
}

} // namespace tandem
