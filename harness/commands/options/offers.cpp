// SPDX-License-Identifier: MIT
#include "harness/commands/options/offers.h"

#include "algorithms/traversal.h"
#include "backends/registry.h"
#include "harness/commands/options/topics.h"
#include "harness/plans/cells.h"
#include "scenes/dynamics_settings.h"
#include "scenes/hard/hard.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <set>

namespace tandem {

namespace {

using Words = std::vector<std::string>;

std::vector<const Traversal*> every_algorithm() {
    std::vector<const Traversal*> all(algorithms().begin(), algorithms().end());
    all.insert(all.end(), baselines().begin(), baselines().end());
    return all;
}

/// The algorithms that --algorithm names in the line; all when it names none.
std::vector<const Traversal*> named_algorithms(const LineBefore& before) {
    std::set<std::string> names;
    for (std::size_t i = 0; i < before.words.size(); ++i) {
        std::string value;
        if (before.words[i].starts_with("--algorithm=")) value = before.words[i].substr(12);
        if (before.words[i] == "--algorithm" && i + 1 < before.words.size()) value = before.words[i + 1];
        for (auto& name : CLI::detail::split(value, ',')) names.insert(std::move(name));
    }
    auto named = every_algorithm();
    std::erase_if(named, [&](const auto* each) { return !names.contains(std::string(each->name())); });
    return named.empty() ? every_algorithm() : named;
}

Words algorithm_names(const LineBefore& before) {
    Words names;
    for (const auto* each : every_algorithm()) names.emplace_back(each->name());
    if (before.command->get_name() == "algorithms") return names;
    names.emplace_back("all");
    if (before.command->get_name() == "run") names.emplace_back(automatic);
    return names;
}

Words preset_names(const LineBefore& before) {
    std::set<std::string> names{"all"};
    for (const auto* each : named_algorithms(before))
        for (const auto& preset : each->presets()) names.emplace(preset.name);
    return {names.begin(), names.end()};
}

Words device_names(const LineBefore&) {
    Words names{"all"};
    for (const auto& backend : discover())
        for (const auto& device : backend.devices) names.push_back(device->info().id);
    return names;
}

Words requirable_names(const LineBefore&) {
    Words names;
    for (const auto& backend : discover()) {
        names.push_back(backend.name);
        for (const auto& device : backend.devices)
            if (device->info().id != backend.name) names.push_back(device->info().id);
    }
    return names;
}

/// "NAME=" of every setting, or the values of the setting whose name is already typed.
Words settings(const LineBefore& before, const std::string& typed) {
    const auto equals = typed.find('=');
    std::set<std::string> texts;
    for (const auto* each : named_algorithms(before))
        for (const auto* parameter : each->parameters()) {
            const auto name = std::string(parameter->name) + "=";
            if (equals == std::string::npos) texts.insert(name);
            if (typed.substr(0, equals + 1) != name) continue;
            for (const auto& word : parameter->choices()) texts.emplace(word.text);
        }
    return {texts.begin(), texts.end()};
}

Words dynamics(const std::string& typed) {
    const auto equals = typed.find('=');
    Words texts;
    if (equals == std::string::npos)
        for (const auto& preset : dynamics_presets()) texts.emplace_back(preset.name);
    for (const auto& setting : dynamics_settings()) {
        const auto name = std::string(setting.name) + "=";
        if (equals == std::string::npos) texts.push_back(name);
        if (typed.substr(0, equals + 1) == name) texts = setting.words;
    }
    return texts;
}

/// The scene kind whose parameters are being typed; null before the colon.
const SceneKind* kind_in(const std::string& typed) {
    for (const auto& kinds : {scene_kinds(), hard_kinds()})
        for (const auto& kind : kinds)
            if (typed.starts_with(kind.name + ":")) return &kind;
    return nullptr;
}

/// The scene kinds. The hard ones are many, so they are offered only after "hard".
Words scene_names(const std::string& typed) {
    Words names;
    for (const auto& kind : scene_kinds()) names.push_back(kind.name);
    if (typed.starts_with("hard"))
        for (const auto& kind : hard_kinds()) names.push_back(kind.name);
    return names;
}

Offer offer_scenes(const std::string& typed) {
    const auto* kind = kind_in(typed);
    if (kind == nullptr) return {scene_names(typed)};
    Words names;
    for (const auto& parameter : kind->parameters) names.push_back(parameter.name + "=");
    return {names, ",", kind->name.size() + 1}; // names of hard kinds contain a colon
}

} // namespace

Offer offer_values(const LineBefore& before, const CLI::Option& option, const std::string& text) {
    const auto name = option.get_lnames().empty() ? std::string() : option.get_lnames().front();
    if (name == "algorithm") return {algorithm_names(before), ","};
    if (name == "preset") return {preset_names(before), ","};
    if (name == "device") return {device_names(before), ",+"};
    if (name == "require") return {requirable_names(before), ","};
    if (name == "scene") return offer_scenes(text);
    if (name == "set") return {settings(before, text), "=,"};
    if (name == "dynamics") return {dynamics(text), "="};
    const auto& choices = option.get_option_text();
    if (choices.find('|') == std::string::npos) return {};
    return {CLI::detail::split(choices, '|')};
}

Offer offer_arguments(const LineBefore& before, const std::string& text) {
    const auto name = before.command->get_name();
    if (name == "algorithms") return {algorithm_names(before)};
    if (name == "help") return {topic_names(*before.command->get_parent())};
    if (name == "completion") return {{"bash", "zsh"}};
    static const std::set<std::string> with_scenes{"run", "check", "accuracy", "simulate", "export", "view"};
    return with_scenes.contains(name) ? offer_scenes(text) : Offer{};
}

} // namespace tandem
