// SPDX-License-Identifier: MIT
#include "harness/compare/nothing_common.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <span>

namespace tandem::compare {

namespace {

std::string of_setting(const RecordedCell& cell, const std::string& name) {
    const auto found = cell.settings.find(name);
    return found == cell.settings.end() ? fmt::format("no {}", name)
                                        : fmt::format("{}={}", name, found->second);
}

/// "X / Y" for each name, or else each setting, in which two cells differ; presets are no part of a key.
std::vector<std::string> differences(const RecordedCell& before, const RecordedCell& after) {
    std::vector<std::string> found;
    for (std::size_t i = 0; i < before.names.size(); ++i)
        if (before.names[i] != after.names[i] && before.names[i].first != "preset")
            found.push_back(fmt::format("{} / {}", before.names[i].second, after.names[i].second));
    auto settings = before.settings;
    settings.insert(after.settings.begin(), after.settings.end());
    for (const auto& [name, value] : settings)
        if (of_setting(before, name) != of_setting(after, name))
            found.push_back(fmt::format("{} / {}", of_setting(before, name), of_setting(after, name)));
    return found;
}

/// Of the nearest two cells; of many only some are looked at.
std::vector<std::string> least_differences(const RecordedCells& before, const RecordedCells& after) {
    constexpr std::size_t most = 300;
    auto least = differences(before.cells.front(), after.cells.front());
    for (const auto& one : std::span(before.cells).first(std::min(most, before.cells.size())))
        for (const auto& other : std::span(after.cells).first(std::min(most, after.cells.size())))
            if (auto found = differences(one, other); found.size() < least.size()) least = std::move(found);
    return least;
}

std::string full_name(const RecordedCells& side) {
    return side.commit.empty() ? side.path : fmt::format("{}@{}", side.path, side.commit);
}

} // namespace

std::string why_nothing_common(const RecordedCells& before, const RecordedCells& after) {
    for (const auto* side : {&before, &after})
        if (side->cells.empty())
            return fmt::format("{}: none of {} records is ok and has samples; record its cells again",
                               full_name(*side), side->records);
    const auto what = fmt::format("{} and {} have no cell in common ({} and {} cells", before.path,
                                  after.path, before.cells.size(), after.cells.size());
    const auto schemas = std::pair(before.cells.front().schema, after.cells.front().schema);
    if (schemas.first != schemas.second)
        return fmt::format("{}), being of schemas {} and {}; record both with one program's schema", what,
                           schemas.first, schemas.second);
    auto least = least_differences(before, after);
    constexpr std::size_t most = 4;
    if (least.size() > most) {
        const auto more = least.size() - most;
        least.resize(most);
        least.push_back(fmt::format("{} more", more));
    }
    return fmt::format("{}; the nearest differ in {}); record the same cells", what, fmt::join(least, ", "));
}

} // namespace tandem::compare
