// SPDX-License-Identifier: MIT
#include "harness/commands/setting_texts.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tandem {

std::vector<std::string> words_of(const Parameter& parameter) {
    std::vector<std::string> words;
    for (const auto& word : parameter.choices()) words.emplace_back(word.text);
    return words;
}

std::vector<std::string> alternatives_of(const Parameter& parameter) {
    std::vector<std::string> texts;
    for (const auto value : parameter.alternatives()) texts.push_back(parameter.text(value));
    return texts;
}

std::string values_of(const Parameter& parameter) {
    auto values = words_of(parameter);
    if (parameter.is_length()) return fmt::format("0..{}", parameter.longest);
    if (parameter.takes_integers())
        values.insert(values.begin(), fmt::format("{}..{}", parameter.least, parameter.most));
    return fmt::format("{}", fmt::join(values, ", "));
}

Settings settings_of(const Traversal& traversal, const Preset& preset) {
    return resolve(traversal.parameters(), preset.values, {}, traversal.name());
}

std::string by_preset(const Traversal& traversal, const Parameter& parameter) {
    std::vector<std::pair<std::string, std::vector<std::string_view>>> values;
    for (const auto& preset : traversal.presets()) {
        const auto value = settings_of(traversal, preset).text(parameter.name);
        const auto found = std::ranges::find(values, value, [](const auto& entry) { return entry.first; });
        if (found == values.end())
            values.push_back({value, {preset.name}});
        else
            found->second.push_back(preset.name);
    }
    const auto own = parameter.text(parameter.initial);
    if (values.size() == 1 && values.front().first == own) return {};
    std::vector<std::string> texts;
    texts.reserve(values.size() + 1);
    for (const auto& [value, presets] : values)
        texts.push_back(fmt::format("{} in {}", value, fmt::join(presets, ", ")));
    if (std::ranges::find(values, own, [](const auto& entry) { return entry.first; }) == values.end())
        texts.push_back(own + " where no preset sets it");
    return fmt::to_string(fmt::join(texts, "; "));
}

std::string_view kind_of_values(const Parameter& parameter) {
    return parameter.takes_integers() || parameter.is_length() ? "range" : "choices";
}

} // namespace tandem
