// SPDX-License-Identifier: MIT
// tandem algorithms: lists all algorithms in short, or explains the named ones at length.
#include "algorithms/traversal.h"
#include "harness/commands/listings.h"
#include "harness/commands/setting_texts.h"
#include "base/standard_streams.h"
#include "base/text_lines.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace tandem {

namespace {

using Json = nlohmann::ordered_json;

/// "NAME=VALUE" of the settings that a preset changes.
std::vector<std::string> changed_by(const Traversal& traversal, const Preset& preset) {
    const auto settings = settings_of(traversal, preset);
    std::vector<std::string> changed;
    for (const auto* p : traversal.parameters())
        if (const auto value = settings.text(p->name); value != p->text(p->initial))
            changed.push_back(fmt::format("{}={}", p->name, value));
    return changed;
}

/// A numeric parameter has a range; a parameter of words has choices; some have both.
Json parameters_json(std::span<const Parameter* const> parameters) {
    Json json = Json::array();
    for (const auto* p : parameters) {
        Json row{{"name", p->name}, {"default", p->text(p->initial)}, {"help", p->help}};
        if (p->takes_integers()) row["range"] = {p->least, p->most};
        if (p->is_length()) row["range"] = Json::array({0, p->longest});
        if (!p->choices().empty()) row["choices"] = words_of(*p);
        row["alternatives"] = alternatives_of(*p);
        json.push_back(row);
    }
    return json;
}

Json counters_json(std::span<const Counter> counters) {
    Json json = Json::array();
    for (const auto& c : counters)
        json.push_back({{"name", c.name}, {"unit", c.unit}, {"meaning", c.meaning}});
    return json;
}

Json algorithm_json(const Traversal& traversal, bool baseline) {
    Json presets = Json::array();
    for (const auto& p : traversal.presets())
        presets.push_back({{"name", p.name},
                           {"title", title_of(traversal, p)},
                           {"help", p.help},
                           {"values", p.texts()},
                           {"settings", settings_of(traversal, p).texts()}});
    return {{"name", traversal.name()},
            {"baseline", baseline},
            {"summary", traversal.summary()},
            {"parameters", parameters_json(traversal.parameters())},
            {"counters", counters_json(traversal.counters())},
            {"presets", presets}};
}

/// Prints a text wrapped to a terminal. Lines after the first begin at column `indent`.
void put_lines(const std::string& text, std::size_t indent) {
    put_text(paragraph(text, indent, output_columns()));
}

void print_heading(const Traversal& traversal, bool baseline) {
    put_lines(fmt::format("{}{}: {}", traversal.name(),
                          baseline ? " (baseline, opt-in: runs only when --algorithm names it)" : "",
                          traversal.summary()),
              2);
}

void print_counters(const Traversal& traversal) {
    put("  counters\n");
    for (const auto& c : traversal.counters())
        put_lines(fmt::format("    {:<22} {} [{}]", c.name, c.meaning, c.unit), 27);
}

/// The short form. Settings have the values of the first preset, which is the default.
void print_algorithm(const Traversal& traversal, bool baseline) {
    print_heading(traversal, baseline);
    put("  presets\n");
    for (const auto& p : traversal.presets())
        put_lines(fmt::format("    {:<18} {}: {}", p.name, title_of(traversal, p), p.help), 23);
    const auto& first = traversal.presets().front();
    const auto settings = settings_of(traversal, first);
    put("  settings, as in preset {}\n", first.name);
    for (const auto* p : traversal.parameters()) {
        const auto value = settings.text(p->name), own = p->text(p->initial);
        auto values = values_of(*p);
        if (!p->alternatives().empty())
            values += fmt::format("; auto tries {}", fmt::join(alternatives_of(*p), ", "));
        if (value != own) values += fmt::format("; {} where no preset sets it", own);
        put_lines(fmt::format("    {:<18} {:<10} {} [{}]", p->name, value, p->help, values), 34);
    }
    print_counters(traversal);
}

/// Prints everything about a setting, one line for each fact.
void explain_setting(const Traversal& traversal, const Parameter& parameter, const std::string& value) {
    constexpr std::size_t indent = 8;
    const auto line = [&](std::string_view label, const std::string& text) {
        put_lines(fmt::format("{:{}}{}: {}", "", indent, label, text), indent + 2);
    };
    put("    {} = {}\n", parameter.name, value);
    put_lines(fmt::format("{:{}}{}", "", indent, parameter.help), indent);
    line(kind_of_values(parameter), values_of(parameter));
    if (const auto values = by_preset(traversal, parameter); !values.empty()) line("presets", values);
    if (!parameter.alternatives().empty())
        line("auto tries", fmt::format("{}", fmt::join(alternatives_of(parameter), ", ")));
}

void explain_algorithm(const Traversal& traversal, bool baseline) {
    print_heading(traversal, baseline);
    put("  presets; the first is the default\n");
    for (const auto& p : traversal.presets()) {
        const auto changed = changed_by(traversal, p);
        put_lines(fmt::format("    {}, in tables \"{}\": {}", p.name, title_of(traversal, p), p.help), 8);
        put_lines(fmt::format("        {}{}", changed.empty() ? "changes no setting" : "sets ",
                              fmt::join(changed, ", ")),
                  10);
    }
    const auto& first = traversal.presets().front();
    const auto settings = settings_of(traversal, first);
    put("  settings, with their values in preset {}\n", first.name);
    for (const auto* p : traversal.parameters()) explain_setting(traversal, *p, settings.text(p->name));
    print_counters(traversal);
}

bool is_baseline(const Traversal& traversal) {
    return std::ranges::find(baselines(), &traversal) != baselines().end();
}

} // namespace

int algorithms_command(const AlgorithmsOptions& options) {
    std::vector<const Traversal*> chosen;
    for (const auto& name : options.names) chosen.push_back(&algorithm(name));
    if (chosen.empty())
        for (const auto& list : {algorithms(), baselines()})
            chosen.insert(chosen.end(), list.begin(), list.end());
    Json all = Json::array();
    for (const auto* traversal : chosen) {
        const bool baseline = is_baseline(*traversal);
        if (options.json)
            all.push_back(algorithm_json(*traversal, baseline));
        else
            (options.names.empty() ? print_algorithm : explain_algorithm)(*traversal, baseline);
    }
    if (options.json) put_text(all.dump(2) + "\n");
    return 0;
}

} // namespace tandem
