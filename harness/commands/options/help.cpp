// SPDX-License-Identifier: MIT
#include "harness/commands/options/help.h"

#include "base/standard_streams.h"
#include "base/text_lines.h"
#include "harness/commands/options/option_groups.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <iterator>

namespace tandem {

namespace {

constexpr std::size_t usual_columns = 80; ///< without a terminal
constexpr std::size_t text_column = 24;   ///< where texts about options begin

std::size_t columns() { return output_columns(usual_columns); }

/// "  NAME    what it is"; a long name has a line of its own.
std::string entry(const std::string& name, const std::string& text) {
    const auto left = "  " + name;
    const bool fits = left.size() + 2 <= text_column;
    return (fits ? std::string() : left + "\n")
           + paragraph(fmt::format("{:<{}}{}", fits ? left : "", text_column, text), text_column, columns());
}

/// "SCENE..." of an argument.
std::string argument_name(const CLI::Option& argument) {
    auto name = argument.get_option_text();
    if (name.empty()) std::ranges::transform(argument.get_name(), std::back_inserter(name), ::toupper);
    return name;
}

/// "-o, --output FILE" of an option.
std::string option_name(const CLI::Option& option) {
    std::vector<std::string> names;
    for (const auto& name : option.get_snames()) names.push_back("-" + name);
    for (const auto& name : option.get_lnames()) names.push_back("--" + name);
    const auto& value = option.get_option_text();
    return fmt::format("{}{}{}", fmt::join(names, ", "), value.empty() ? "" : " ", value);
}

std::vector<const CLI::Option*> arguments_of(const CLI::App& app) {
    return app.get_options([](const CLI::Option* option) { return !option->nonpositional(); });
}

std::string usage_line(const CLI::App& app) {
    std::string words = "Usage: tandem";
    if (app.get_parent() == nullptr) return words + " COMMAND [OPTION]...\n";
    words += " " + app.get_name();
    for (const auto* argument : arguments_of(app))
        words +=
            argument->get_required() ? " " + argument_name(*argument) : " [" + argument_name(*argument) + "]";
    return words + " [OPTION]...\n";
}

std::string command_lines(const CLI::App& app) {
    std::string text;
    std::vector<std::string> groups;
    const auto all = listed_commands(app);
    for (const auto* command : all)
        if (std::ranges::find(groups, command->get_group()) == groups.end())
            groups.push_back(command->get_group());
    for (const auto& group : groups) {
        text += "\n" + group + ":\n";
        for (const auto* command : all)
            if (command->get_group() == group) text += entry(command->get_name(), command->get_description());
    }
    return text;
}

std::string option_lines(const CLI::App& app) {
    std::string text;
    for (const std::string group : option_groups::all) {
        const auto own = app.get_options([&](const CLI::Option* option) {
            return option->get_group() == group && option->nonpositional();
        });
        if (!own.empty()) text += "\n" + group + ":\n";
        for (const auto* option : own) text += entry(option_name(*option), option->get_description());
    }
    return text;
}

/// Four spaces, so that no example looks like a command.
std::string example_lines(const CLI::App& app) {
    if (app.get_footer().empty()) return {};
    std::string text = "\nExamples:\n";
    for (const auto& line : CLI::detail::split(app.get_footer(), '\n'))
        text += paragraph("    " + line, 8, columns());
    return text;
}

} // namespace

std::vector<const CLI::App*> listed_commands(const CLI::App& app) {
    return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

std::string help_text(const CLI::App& app) {
    auto text = paragraph(app.get_description(), 0, columns()) + "\n" + usage_line(app);
    const auto arguments = arguments_of(app);
    if (!arguments.empty()) text += "\n";
    for (const auto* argument : arguments)
        text += entry(argument_name(*argument), argument->get_description());
    return text + command_lines(app) + option_lines(app) + example_lines(app);
}

} // namespace tandem
