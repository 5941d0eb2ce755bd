// SPDX-License-Identifier: MIT
#include "harness/commands/options/unknown_words.h"

#include "base/error.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

/// Options of a command without their dashes, as a mistake in dashes is none in the name.
std::vector<std::string> option_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const auto* option : app.get_options())
        names.insert(names.end(), option->get_lnames().begin(), option->get_lnames().end());
    return names;
}

/// An option that begins as the word does is meant before one that takes fewer letters to reach.
std::string nearest_option(const std::string& name, const std::vector<std::string>& names) {
    const auto begun = std::ranges::find_if(names, [&](const auto& n) { return n.starts_with(name); });
    return name.size() > 1 && begun != names.end() ? *begun : nearest(name, names);
}

/// Those of the help.
std::vector<const CLI::App*> commands_of(const CLI::App& app) {
    return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

/// "--algoritm=x" behind a command, or before any.
std::string unknown_option(const CLI::App& app, const CLI::App* command, const std::string& word) {
    const auto text = word.substr(0, word.find('='));
    const auto name = text.substr(std::min(text.find_first_not_of('-'), text.size()));
    if (command != nullptr)
        return fmt::format("unknown option {}; did you mean --{}? see 'tandem {} --help'", text,
                           nearest_option(name, option_names(*command)), command->get_name());
    auto names = option_names(app);
    for (const auto* each : commands_of(app)) {
        const auto more = option_names(*each);
        if (std::ranges::find(more, name) != more.end())
            return fmt::format("option {} belongs behind a command: tandem {} {}; see 'tandem --help'", text,
                               each->get_name(), text);
        names.insert(names.end(), more.begin(), more.end());
    }
    return fmt::format("unknown option {}; did you mean --{}? see 'tandem --help'", text,
                       nearest_option(name, names));
}

std::string unknown_command(const CLI::App& app, const std::string& word) {
    std::vector<std::string> names;
    for (const auto* each : commands_of(app)) names.push_back(each->get_name());
    return unknown("command", word, names) + "; see 'tandem --help'";
}

} // namespace

std::string unknown_word(const CLI::App& app, std::span<const std::string> line) {
    // Behind "--" nothing is an option.
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
    auto behind = command->remaining();
    std::erase(behind, "--");
    // A value of an option that is unknown itself is left over as well.
    if (const auto option = std::ranges::find_if(behind, is_option); option != behind.end())
        return unknown_option(app, command, *option);
    behind.insert(behind.end(), words.begin(), words.end());
    if (behind.empty()) return {};
    return fmt::format("'{0}' is too much; see 'tandem {1} --help'", behind.front(), command->get_name());
}

} // namespace tandem
