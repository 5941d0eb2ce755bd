// SPDX-License-Identifier: MIT
#include "harness/commands/options/unknown_words.h"

#include "base/error.h"
#include "harness/commands/options/help.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

/// The option names of a command without dashes, because a mistake in the dashes does not change the name.
std::vector<std::string> option_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const auto* option : app.get_options())
        names.insert(names.end(), option->get_lnames().begin(), option->get_lnames().end());
    return names;
}

/// "; did you mean --X?" with the option that begins with `name`, else the nearest; ";" if there is neither.
std::string nearest_option(const std::string& name, const std::vector<std::string>& names) {
    const auto begun = std::ranges::find_if(names, [&](const auto& n) { return n.starts_with(name); });
    const auto near = name.size() > 1 && begun != names.end() ? *begun : nearest(name, names);
    return near.empty() ? std::string(";") : fmt::format("; did you mean --{}?", near);
}

/// The message for "--algoritm=x" after a command, or before any.
std::string unknown_option(const CLI::App& app, const CLI::App* command, const std::string& word) {
    const auto text = word.substr(0, word.find('='));
    const auto name = text.substr(std::min(text.find_first_not_of('-'), text.size()));
    if (command != nullptr)
        return fmt::format("unknown option {}{} see 'tandem {} --help'", text,
                           nearest_option(name, option_names(*command)), command->get_name());
    auto names = option_names(app);
    for (const auto* each : listed_commands(app)) {
        const auto more = option_names(*each);
        if (std::ranges::find(more, name) != more.end())
            return fmt::format("option {} must come after a command: tandem {} {}; see 'tandem --help'", text,
                               each->get_name(), text);
        names.insert(names.end(), more.begin(), more.end());
    }
    return fmt::format("unknown option {}{} see 'tandem --help'", text, nearest_option(name, names));
}

std::string unknown_command(const CLI::App& app, const std::string& word) {
    std::vector<std::string> names;
    for (const auto* each : listed_commands(app)) names.push_back(each->get_name());
    return unknown("command", word, names) + "; see 'tandem --help'";
}

} // namespace

std::string unknown_word(const CLI::App& app, std::span<const std::string> line) {
    // After "--" nothing is an option.
    const auto dashes = std::ranges::find(line, "--");
    const auto is_option = [&](const std::string& word) {
        return word.size() > 1 && word.starts_with('-') && std::find(line.begin(), dashes, word) != dashes;
    };
    const auto given = app.get_subcommands();
    const auto* command = given.empty() ? nullptr : given.front();
    auto words = app.remaining();
    std::erase(words, "--");
    const auto before = std::ranges::find_if(words, is_option);
    if (command == nullptr && !words.empty() && before != words.begin())
        return unknown_command(app, words.front());
    if (before != words.end()) return unknown_option(app, nullptr, *before);
    if (command == nullptr) return {};
    auto rest = command->remaining();
    std::erase(rest, "--");
    // The value of an unknown option is also left over, so the option is reported first.
    if (const auto option = std::ranges::find_if(rest, is_option); option != rest.end())
        return unknown_option(app, command, *option);
    rest.insert(rest.end(), words.begin(), words.end());
    if (rest.empty()) return {};
    return fmt::format("unexpected argument '{0}'; see 'tandem {1} --help'", rest.front(),
                       command->get_name());
}

} // namespace tandem
