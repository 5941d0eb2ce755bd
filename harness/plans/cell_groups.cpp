// SPDX-License-Identifier: MIT
#include "harness/plans/cell_groups.h"

#include "harness/plans/cell_filter.h"

#include <algorithm>
#include <fmt/format.h>
#include <optional>

namespace tandem {

namespace {

std::vector<std::string> devices_of(const Product& product) {
    if (product.request.devices.empty()) return {default_device};
    return product.request.devices;
}

/// Whether a field of an exclusion matches the value. An empty field matches every value.
bool has(const std::vector<std::string>& field, std::string_view value) {
    return field.empty() || std::ranges::find(field, value) != field.end();
}

/// Whether the settings of an exclusion match the cell. A setting that the cell does not have never matches.
bool has_settings(const Cell& cell, const Request& request) {
    const auto texts = cell.settings.texts();
    return std::ranges::all_of(request.sets, [&](const auto& set) {
        const auto own = texts.find(set.first);
        return own != texts.end() && has(set.second, own->second);
    });
}

/// Whether a list of devices matches those of the cell. An empty list matches all.
bool has_devices(const std::vector<std::string>& names, const Cell& cell, const ChooseDevices& choose) {
    return names.empty() || std::ranges::any_of(names, [&](const std::string& name) {
               try {
                   const auto named = choose({name});
                   return std::ranges::find(named, cell.devices) != named.end();
               } catch (const InputError&) {
                   return false; // this machine has no such device
               }
           });
}

bool matches(const Product& excluded, const CellGroup& group, const Cell& cell, const ChooseDevices& choose) {
    const auto& request = excluded.request;
    const auto algorithm = cell.candidates.empty() ? cell.algorithm->name() : automatic;
    return has(excluded.scenes, group.scene) && has(excluded.frames, group.frames)
           && has(request.algorithms, algorithm) && has(request.presets, cell.preset)
           && has_devices(request.devices, cell, choose) && has_settings(cell, request);
}

CellGroup& group_of(std::vector<CellGroup>& groups, const std::string& scene, const std::string& frames) {
    for (auto& group : groups)
        if (group.scene == scene && group.frames == frames) return group;
    return groups.emplace_back(CellGroup{scene, frames, {}});
}

/// The devices of all names, each once. Names of absent devices go to `unfit`.
std::vector<DeviceGroup> chosen(const std::vector<std::string>& names, const ChooseDevices& choose,
                                const Unfit& unfit) {
    std::vector<DeviceGroup> all;
    for (const auto& name : names) try {
            for (auto& group : choose({name}))
                if (std::ranges::find(all, group) == all.end()) all.push_back(std::move(group));
        } catch (const InputError& error) {
            unfit(error);
        }
    return all;
}

void add_product(CellGroups& all, const Product& product, const ChooseDevices& choose, const Unfit& unfit) {
    auto request = product.request;
    request.may_choose = true;
    const auto cells = plan(request, chosen(devices_of(product), choose, unfit), unfit);
    const auto frames = product.frames.empty() ? std::vector<std::string>{""} : product.frames;
    for (const auto& scene : product.scenes)
        for (const auto& range : frames) {
            auto& own = group_of(all.groups, scene, range).cells;
            own.insert(own.end(), cells.begin(), cells.end());
        }
}

void exclude(CellGroups& all, const Exclusion& exclusion, const ChooseDevices& choose) {
    std::size_t matched = 0;
    for (auto& group : all.groups)
        matched += std::erase_if(
            group.cells, [&](const Cell& cell) { return matches(exclusion.product, group, cell, choose); });
    if (matched == 0 && !exclusion.may_be_empty)
        throw InputError(
            fmt::format("{}: matches no cell of the plan; correct it or leave it out", exclusion.location));
    all.excluded += matched;
}

} // namespace

void replace(PlanFile& plan, const Product& given) {
    const auto put = [](std::vector<std::string>& field, const std::vector<std::string>& texts) {
        if (!texts.empty()) field = texts;
    };
    const auto& asked = given.request;
    const bool replaces = !(given.frames.empty() && asked.algorithms.empty() && asked.presets.empty()
                            && asked.devices.empty() && asked.sets.empty());
    for (auto& exclusion : plan.exclusions) exclusion.may_be_empty = replaces;
    for (auto& product : plan.products) {
        put(product.frames, given.frames);
        put(product.request.algorithms, asked.algorithms);
        put(product.request.presets, asked.presets);
        put(product.request.devices, asked.devices);
        for (const auto& set : asked.sets) {
            std::erase_if(product.request.sets, [&](const auto& own) { return own.first == set.first; });
            product.request.sets.push_back(set);
        }
    }
}

std::vector<std::string> devices_of(const PlanFile& plan) {
    std::vector<std::string> names;
    for (const auto& product : plan.products)
        for (auto& name : devices_of(product))
            if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
    return names;
}

CellGroups make_groups(const PlanFile& plan, const ChooseDevices& choose, Shard shard) {
    CellGroups all;
    Unfit unfit = refuse;
    if (plan.skips_impossible) unfit = [&](const InputError& error) { ++all.impossible[error.what()]; };
    for (const auto& product : plan.products) add_product(all, product, choose, unfit);
    for (auto& group : all.groups) all.repeated += drop_repeated(group.cells);
    for (const auto& exclusion : plan.exclusions) exclude(all, exclusion, choose);
    all.numbered = all.groups.size();
    std::vector<CellGroup> own;
    for (std::size_t number = shard.index; number < all.groups.size(); number += shard.of)
        if (!all.groups[number].cells.empty()) own.push_back(std::move(all.groups[number]));
    all.groups = std::move(own);
    return all;
}

void keep_matching(CellGroups& all, const std::string& expression, Shard shard) {
    const CellFilter filter(expression);
    std::size_t count = 0;
    std::optional<Cell> example;
    for (auto& group : all.groups) {
        count += group.cells.size();
        if (!example && !group.cells.empty()) example = group.cells.front();
        filter.apply(group.cells);
    }
    if (expression.empty()) return;
    std::erase_if(all.groups, [](const CellGroup& group) { return group.cells.empty(); });
    if (all.groups.empty() && example && shard.of == 1) filter.refuse_none(count, *example);
}

} // namespace tandem
