// SPDX-License-Identifier: MIT
#include "backends/device.h"
#include "harness/command_line/actions.h"
#include "harness/command_line/completion.h"
#include "harness/command_line/contradictions.h"
#include "harness/command_line/unknown_words.h"
#include "harness/environment.h"
#include "harness/memory_reserve.h"
#include "harness/standard_streams.h"
#include "harness/text_lines.h"
#include "scenes/error.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>

namespace {

using tandem::InputError;

/// A subcommand: its name and summary in the help, and what adds its options.
struct Command {
    const char* name;
    const char* summary;
    tandem::Action (*add)(CLI::App& app);
};

constexpr Command commands[] = {
    {"run", "measure; print a table, append records", tandem::add_run},
    {"check", "device x algorithm agreement matrix; exit 1 on any difference", tandem::add_check},
    {"accuracy", "error beside speed over settings, for several scenes", tandem::add_accuracy},
    {"profile", "per kernel: time, registers, occupancy, bytes, operations, share of the ceilings",
     tandem::add_profile},
    {"compare", "which cells changed, by how much, how sure; exit 1 beyond --threshold", tandem::add_compare},
    {"simulate", "move a scene with dynamics; record its frames", tandem::add_simulate},
    {"export", "frames as files for ParaView and other viewers, records as a table", tandem::add_export},
    {"paper", "every table and figure of the paper beside ours, with verdicts", tandem::add_paper},
    {"report", "records, and a scene, as one page for a browser: words, tables, charts", tandem::add_report},
    {"view", "a scene in three dimensions as a page for a browser", tandem::add_view},
    {"devices", "what there is, or why there is not", tandem::add_devices},
    {"scenes", "scenes the program makes, with their parameters", tandem::add_scenes},
    {"algorithms", "algorithms with their presets and settings; one at length", tandem::add_algorithms},
    {"completion", "completion of lines by a shell", tandem::add_completion},
    {"isolated", "what a process of --isolate does", tandem::add_isolated}};

using Actions = std::vector<std::pair<CLI::App*, tandem::Action>>;

Actions add_commands(CLI::App& app) {
    const auto add_version = [](CLI::App& to) {
        return to.set_version_flag("--version", tandem::version_line,
                                   "print name, version, commit, compiler and optional parts");
    };
    app.require_subcommand(1);
    add_version(app);
    Actions actions;
    for (const auto& command : commands) {
        auto* subcommand = app.add_subcommand(command.name, command.summary);
        actions.emplace_back(subcommand, command.add(*subcommand));
        add_version(*subcommand)->group(""); // in the program's own help only
    }
    return actions;
}

/// Reads the line, then does what its subcommand says. Every mistake in the line is an InputError.
int dispatch(int argc, char** argv) {
    CLI::App app{"tandem: ways of walking bounding-volume hierarchies in tandem, measured and checked"};
    const auto actions = add_commands(app);
    const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    if (tandem::asks_for_completion(words)) return tandem::complete(app, words);
    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        tandem::put("{}", app.help());
        return 0;
    } catch (const CLI::CallForVersion& version) {
        tandem::put("{}\n", version.what());
        return 0;
    } catch (const CLI::ParseError& error) {
        const auto unknown = tandem::unknown_word(app, words);
        throw InputError(unknown.empty() ? fmt::format("{}; see 'tandem --help'", error.what()) : unknown);
    }
    const auto given =
        std::ranges::find_if(actions, [](const auto& action) { return action.first->parsed(); });
    tandem::refuse_contradictions(*given->first);
    return given->second();
}

/// Exit codes: 0 ok, 1 a check failed (from the command), 2 bad use or bad input, 3 a device or the machine
/// failed.
int run(int argc, char** argv) {
    try {
        const tandem::MemoryReserve reserve;
        return dispatch(argc, argv);
    } catch (const InputError& error) {
        tandem::tell("tandem: {}\n", tandem::visible(error.what()));
        return 2;
    } catch (const tandem::DeviceError& error) {
        tandem::tell("tandem: {}\n", tandem::visible(error.what()));
        return 3;
    } catch (const std::bad_alloc&) {
        tandem::tell("tandem: out of memory; use fewer bodies or frames\n");
        return 3;
    } catch (const std::exception& error) {
        tandem::tell("tandem: {}\n", tandem::visible(error.what()));
        return 3;
    }
}

} // namespace

/// 3 as well when what was printed could not be written.
int main(int argc, char** argv) {
    tandem::prepare_standard_streams();
    return tandem::finish_output(run(argc, argv));
}
