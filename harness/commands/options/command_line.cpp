// SPDX-License-Identifier: MIT
#include "harness/commands/options/command_line.h"

#include "harness/program/external.h"
#include "harness/commands/options/citation.h"
#include "harness/commands/options/completion.h"
#include "harness/commands/options/contradictions.h"
#include "harness/commands/options/external_options.h"
#include "harness/commands/options/help.h"
#include "harness/commands/options/unknown_words.h"
#include "harness/program/environment.h"
#include "harness/program/run_on_ranks.h"
#include "base/standard_streams.h"
#include "base/error.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <span>

namespace tandem {

namespace {

/// A subcommand: its name, its group and its summary in the help, and the function that adds its options;
/// none for an external one.
struct Subcommand {
    const char* name;
    const char* group;
    const char* summary;
    Action (*add)(CLI::App& app) = nullptr;
};

constexpr auto measuring = "Measure and check";
constexpr auto scenes = "Scenes and files";
constexpr auto pages = "Pages";
constexpr auto listings = "What there is";
constexpr auto hidden = "";

constexpr Subcommand subcommands[] = {
    {"run", measuring, "measure algorithms in scenes: print tables, and append records to a file", add_run},
    {"check", measuring,
     "compare every algorithm on every device with the reference; exit 1 on any difference", add_check},
    {"accuracy", measuring, "show errors against the exact truth beside times, over scenes and settings",
     add_accuracy},
    {"profile", measuring,
     "show each kernel's time, registers, occupancy, bytes, operations and share of the ceilings",
     add_profile},
    {"compare", measuring,
     "show which cells changed between records, by how much and how surely; exit 1 beyond "
     "--threshold"},
    {"simulate", scenes, "move a scene by its dynamics, and record its frames", add_simulate},
    {"export", scenes, "write frames for ParaView and other viewers, or records as a table", add_export},
    {"convert", scenes, "convert a mesh of any format that meshio reads to .vtu"},
    {"report", pages, "draw records, and a scene, on one HTML page with tables and charts"},
    {"view", pages, "draw a scene in three dimensions on an HTML page"},
    {"paper", pages,
     "measure every table and figure of the paper, and draw them beside its own, with verdicts"},
    {"devices", listings, "list the available devices, or the reason why there are none", add_devices},
    {"scenes", listings, "list the built-in scenes with their parameters", add_scenes},
    {"algorithms", listings, "list the algorithms with their presets and settings, or explain the named ones",
     add_algorithms},
    {"completion", listings, "print the completion script for a shell", add_completion},
    {"help", listings, "explain a command, an algorithm or a setting; 'tandem help settings' lists settings",
     add_help},
    {"isolated", hidden, "the child process of --isolate", add_isolated}};

using Actions = std::vector<std::pair<CLI::App*, Action>>;

/// Adds all commands, but the options of those only that are `needed`.
Actions add_commands(CLI::App& app, const std::function<bool(std::string_view)>& needed) {
    const auto add_version = [](CLI::App& to) {
        return to.set_version_flag("--version", version_line,
                                   "print name, version, commit, compiler and optional parts");
    };
    app.require_subcommand(1);
    app.get_help_ptr()->description("print this help");
    add_version(app);
    app.add_flag_callback(
        "--cite", [] { throw CLI::CallForVersion(fmt::format("% {}\n{}", version_line(), citation()), 0); },
        "print how to cite tandem and the papers whose methods it hosts (BibTeX)");
    app.footer("tandem run pile\ntandem check pile --frames 20\ntandem help run\ntandem help contact_rule");
    Actions actions;
    for (const auto& command : subcommands) {
        auto* subcommand = app.add_subcommand(command.name, command.summary)->group(command.group);
        if (command.add == nullptr || !needed(command.name)) continue;
        actions.emplace_back(subcommand, command.add(*subcommand));
        add_version(*subcommand)->group(""); // hidden: only the help of the program shows it
    }
    return actions;
}

/// Whether only options of commands that are among the words are needed, which are added several times
/// faster than all: not by the help of the program, completion, and messages about words before a command.
bool begins_with_command(std::span<const std::string> words) {
    return !words.empty() && !asks_for_completion(words)
           && std::ranges::any_of(subcommands, [&](const auto& each) { return words.front() == each.name; });
}

/// Completes the line; asks an external subcommand in it for its options.
int complete_line(CLI::App& app, std::span<const std::string> line) {
    if (const auto name = std::ranges::find_if(line, is_external); name != line.end())
        add_declared_options(*app.get_subcommand(*name), *name);
    return complete(app, line);
}

/// The message of an error, and where the option is explained.
std::string with_help(const CLI::App& app, const CLI::ParseError& error) {
    const auto given = app.get_subcommands();
    return fmt::format("{}; see 'tandem {}--help'", error.what(),
                       given.empty() ? "" : given.front()->get_name() + " ");
}

} // namespace

bool is_external(const std::string& word) {
    return std::ranges::any_of(subcommands,
                               [&](const auto& each) { return each.add == nullptr && word == each.name; });
}

Action read_command_line(int argc, const char* const* argv) {
    const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    if (!words.empty() && is_external(words.front()))
        return [words] {
            report_idle_ranks(words.front());
            return run_external(words.front(), {words.begin() + 1, words.end()});
        };
    // The actions share ownership of the app, because they read its options later.
    const auto app = std::make_shared<CLI::App>(
        "tandem measures which method finds all colliding tetrahedra of moving meshes fastest, and whether "
        "its answer is correct.");
    const bool needs_all = !begins_with_command(words);
    const auto actions = add_commands(*app, [&](std::string_view name) {
        return needs_all || std::ranges::find(words, name) != words.end();
    });
    if (asks_for_completion(words)) return [app, words] { return complete_line(*app, words); };
    const auto print = [](const std::string& text) {
        return [text]() -> int {
            put_text(text);
            return 0;
        };
    };
    try {
        app->parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        const auto given = app->get_subcommands();
        return print(help_text(given.empty() ? *app : *given.front()));
    } catch (const CLI::CallForVersion& version) {
        const std::string text = version.what();
        return print(text.ends_with('\n') ? text : text + '\n');
    } catch (const CLI::ParseError& error) {
        const auto unknown = unknown_word(*app, words);
        throw InputError(unknown.empty() ? with_help(*app, error) : unknown);
    }
    const auto given =
        std::ranges::find_if(actions, [](const auto& action) { return action.first->parsed(); });
    refuse_contradictions(*given->first);
    return [app, act = given->second] {
        const auto& name = app->get_subcommands().front()->get_name();
        if (name != "run") report_idle_ranks(name);
        return act();
    };
}

} // namespace tandem
