// SPDX-License-Identifier: MIT
#include "harness/commands/options/topics.h"

#include "algorithms/traversal.h"
#include "base/error.h"
#include "base/standard_streams.h"
#include "harness/commands/listings.h"
#include "harness/commands/options/actions.h"
#include "harness/commands/options/command_line.h"
#include "harness/commands/options/help.h"
#include "harness/program/external.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>
#include <memory>

namespace tandem {

namespace {

constexpr std::string_view all_settings = "settings";

std::vector<std::string> algorithm_names() {
    std::vector<std::string> names;
    for (const auto& list : {algorithms(), baselines()})
        for (const auto* each : list) names.emplace_back(each->name());
    return names;
}

bool has(const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
}

/// Prints the help of a command. Returns the exit code.
int print_help(const CLI::App& command) {
    if (is_external(command.get_name())) return run_external(command.get_name(), {"--help"});
    put_text(help_text(command));
    return 0;
}

[[noreturn]] void refuse_topic(const std::string& topic, const CLI::App& program) {
    const auto near = nearest(topic, topic_names(program));
    throw InputError(
        fmt::format("unknown topic '{}'{}; 'tandem help' lists commands, and 'tandem help settings' settings",
                    topic, near.empty() ? "" : fmt::format("; the nearest is '{}'", near)));
}

/// Explains a topic; a command and a setting may have one name. Returns the exit code.
int explain(const CLI::App& program, const std::string& topic) {
    const auto commands = listed_commands(program);
    const auto command =
        std::ranges::find(commands, topic, [](const auto* each) { return each->get_name(); });
    const bool is_setting = has(setting_names(), topic);
    int code = 0;
    if (command != commands.end()) {
        code = print_help(**command);
        if (is_setting) put("\nThe setting of this name:\n");
    } else if (has(algorithm_names(), topic)) {
        code = algorithms_command({{topic}, false});
    } else if (topic == all_settings) {
        list_settings();
    } else if (!is_setting) {
        refuse_topic(topic, program);
    }
    if (is_setting) explain_setting(topic);
    return code;
}

} // namespace

std::vector<std::string> topic_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const auto* command : listed_commands(app)) names.push_back(command->get_name());
    names.emplace_back(all_settings);
    for (const auto& list : {algorithm_names(), setting_names()})
        names.insert(names.end(), list.begin(), list.end());
    return names;
}

Action add_help(CLI::App& app) {
    auto topic = std::make_shared<std::string>();
    app.add_option("topic", *topic,
                   "a command, an algorithm, a setting, or 'settings' (default: the help of the program)");
    app.footer("tandem help run\n"
               "tandem help contact_rule\n"
               "tandem help settings");
    return [topic, program = app.get_parent()] {
        if (!topic->empty()) return explain(*program, *topic);
        put_text(help_text(*program));
        return 0;
    };
}

} // namespace tandem
