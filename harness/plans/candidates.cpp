// SPDX-License-Identifier: MIT
#include "harness/plans/candidates.h"

#include "algorithms/bounds/geometry.h"
#include "algorithms/narrow_phase/contact_settings.h"
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>

namespace tandem {

namespace {

/// Settings of cells, with the number of those that differ from the preset: the given settings that the
/// algorithm declares, with every combination of alternatives of the others.
std::vector<std::pair<std::size_t, SettingTexts>> variants(const Traversal& traversal, const Preset& preset,
                                                           const SettingTexts& given) {
    const auto has = [&](std::string_view name) { return given.contains(std::string(name)); };
    SettingTexts own;
    for (const auto* p : traversal.parameters())
        if (has(p->name)) own.insert(*given.find(std::string(p->name)));
    const auto base = resolve(traversal.parameters(), preset.values, own, traversal.name());
    std::vector<std::pair<std::size_t, SettingTexts>> all{{0, own}};
    for (const auto* p : traversal.parameters()) {
        const auto unchanged = has(p->name) ? 0 : all.size();
        for (const auto value : p->alternatives())
            for (std::size_t i = 0; i < unchanged && p->text(value) != base.text(p->name); ++i) {
                all.emplace_back(all[i].first + 1, all[i].second);
                all.back().second[std::string(p->name)] = p->text(value);
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

} // namespace

std::vector<Cell> candidates(const Request& request, const SettingTexts& given, const DeviceGroup& devices) {
    auto any = request; // names no algorithm, so that one without the presets is no error
    any.algorithms.clear();
    std::vector<std::pair<std::size_t, Cell>> fitting;
    std::string refusal;
    for (const auto* traversal : algorithms())
        for (const auto* preset : choose_presets(any, *traversal))
            for (const auto& [changes, settings] : variants(*traversal, *preset, given)) try {
                    fitting.emplace_back(changes, make_cell(*traversal, *preset, settings, devices));
                } catch (const InputError& error) {
                    if (refusal.empty()) refusal = error.what();
                }
    if (fitting.empty()) throw InputError(refusal);
    std::ranges::stable_sort(fitting, {}, [](const auto& one) { return one.first; });
    std::vector<Cell> chosen;
    std::set<std::string> seen;
    for (auto& [changes, cell] : fitting)
        if ((chosen.empty() || same_answer(cell, chosen.front())) && seen.insert(as_run(cell)).second)
            chosen.push_back(std::move(cell));
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
