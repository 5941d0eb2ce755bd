// SPDX-License-Identifier: MIT
// tandem help NAME: explains a setting; tandem help settings: lists all of them.
#include "base/error.h"
#include "base/standard_streams.h"
#include "base/text_lines.h"
#include "harness/commands/listings.h"
#include "harness/commands/setting_texts.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tandem {

namespace {

std::vector<const Traversal*> every_algorithm() {
    std::vector<const Traversal*> all(algorithms().begin(), algorithms().end());
    all.insert(all.end(), baselines().begin(), baselines().end());
    return all;
}

/// Each setting once; algorithms that have the same setting share its declaration.
std::vector<const Parameter*> every_setting() {
    std::vector<const Parameter*> all;
    for (const auto* traversal : every_algorithm())
        for (const auto* parameter : traversal->parameters())
            if (std::ranges::find(all, parameter) == all.end()) all.push_back(parameter);
    return all;
}

/// The values in presets, each with the algorithms that have them: {"18 in all presets", {tiled, embree}}.
std::vector<std::pair<std::string, std::vector<std::string_view>>>
values_by_algorithm(const Parameter& parameter) {
    std::vector<std::pair<std::string, std::vector<std::string_view>>> all;
    for (const auto* traversal : every_algorithm()) {
        if (std::ranges::find(traversal->parameters(), &parameter) == traversal->parameters().end()) continue;
        auto text = by_preset(*traversal, parameter);
        if (text.empty()) text = parameter.text(parameter.initial) + " in all presets";
        auto found = std::ranges::find(all, text, [](const auto& entry) { return entry.first; });
        if (found == all.end()) found = all.insert(all.end(), {text, {}});
        found->second.push_back(traversal->name());
    }
    return all;
}

void put_lines(const std::string& text) { put_text(paragraph(text, 4, output_columns())); }

} // namespace

std::vector<std::string> setting_names() {
    std::vector<std::string> names;
    for (const auto* parameter : every_setting()) names.emplace_back(parameter->name);
    return names;
}

void list_settings() {
    put_lines("settings of algorithms, --set NAME=VALUE; 'tandem help NAME' explains one, 'tandem algorithms "
              "NAME' those of an algorithm");
    for (const auto* parameter : every_setting())
        put("{}\n",
            shortened(fmt::format("  {:<20} {}", parameter->name, parameter->help), output_columns()));
}

void explain_setting(const std::string& name) {
    const auto all = every_setting();
    const auto found = std::ranges::find(all, name, [](const auto* each) { return each->name; });
    if (found == all.end()) throw InputError(unknown("setting", name, setting_names()));
    const auto& parameter = **found;
    put_lines(fmt::format("{}: {}", parameter.name, parameter.help));
    put_lines(fmt::format("  {}: {}", kind_of_values(parameter), values_of(parameter)));
    for (const auto& [values, names] : values_by_algorithm(parameter))
        put_lines(fmt::format("  {}: {}", fmt::join(names, ", "), values));
    if (!parameter.alternatives().empty())
        put_lines(fmt::format("  auto tries: {}", fmt::join(alternatives_of(parameter), ", ")));
}

} // namespace tandem
