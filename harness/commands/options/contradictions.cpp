// SPDX-License-Identifier: MIT
#include "harness/commands/options/contradictions.h"

#include "base/error.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

/// Whether the first of two options wants the second or cannot be with it.
enum class Together { must, must_not };

/// Options are "--name", "--name WHAT" as it is to be said, or "--name=value" where one value of several
/// matters: of lists an entry, of settings what stands before the '='.
struct Rule {
    std::string_view option;
    Together together;
    std::string_view other;
    std::string_view why;
};

constexpr std::string_view only_replays = "a profile only replays frames, and nothing is measured";
constexpr std::string_view only_chunks = "nothing else that is exported is made of it";
constexpr std::string_view only_auto = "nothing else has a choice to make";

constexpr Rule rules[] = {
    {"--repeat", Together::must_not, "--noise", "N samples are taken however they scatter"},
    {"--repeat", Together::must_not, "--seconds", "N samples are taken however long that takes"},
    {"--truth-contacts", Together::must, "--truth=contacts", "no other truth has contacts"},
    {"--choose-seconds", Together::must, "--algorithm=auto", only_auto},
    {"--choose-afresh", Together::must, "--algorithm=auto", only_auto},
    {"--threads", Together::must_not, "--set=threads", "both say how many threads device host has"},
    {"--profile", Together::must_not, "--dry-run", "one replays frames and the other only lists cells"},
    {"--profile", Together::must_not, "--resume", only_replays},
    {"--profile", Together::must_not, "--repeat", only_replays},
    {"--profile", Together::must_not, "--noise", only_replays},
    {"--profile", Together::must_not, "--seconds", only_replays},
    {"--profile", Together::must_not, "--seed", only_replays},
    {"--profile", Together::must_not, "--isolate", only_replays},
    {"--profile", Together::must_not, "--truth=pairs", only_replays},
    {"--profile", Together::must_not, "--truth=contacts", only_replays},
    {"--dry-run", Together::must_not, "--dump-pairs", "no cell is measured whose pairs could be written"},
    {"--dry-run", Together::must_not, "--dump-contacts",
     "no cell is measured whose contacts could be written"},
    {"--draw-only", Together::must_not, "--measure-only", "nothing would be left to do"},
    {"--draw-only", Together::must_not, "--again", "nothing is measured"},
    {"--draw-only", Together::must_not, "--steps", "nothing is measured"},
    {"--pose", Together::must, "--mesh FILE", "a scene brings its own poses"},
    {"--resume", Together::must, "-o FILE", "that recording is what it goes on with"},
    {"--checkpoint", Together::must, "-o FILE", "checkpoints are kept beside a recording"},
    {"--pictures", Together::must, "-o FILE", "that recording is what they show"},
    {"--chunks", Together::must_not, "--csv", "a file of records has no chunks"},
    {"--builder", Together::must, "--chunks FILE", only_chunks},
    {"--chunk-bytes", Together::must, "--chunks FILE", only_chunks},
    {"--k", Together::must, "--chunks FILE", only_chunks},
};

/// Null where the command has no such option.
const CLI::Option* option_of(const CLI::App& command, std::string_view text) {
    return command.get_option_no_throw(std::string(text.substr(0, text.find_first_of("= "))));
}

/// Values apart by commas are one result each, or one together, as the option has it.
bool has_value(const CLI::Option& option, std::string_view value) {
    return std::ranges::any_of(option.results(), [&](const std::string& result) {
        const auto entries = CLI::detail::split(result, ',');
        return std::ranges::any_of(
            entries, [&](const std::string& entry) { return entry.substr(0, entry.find('=')) == value; });
    });
}

bool is_given(const CLI::Option& option, std::string_view text) {
    const auto equals = text.find('=');
    return option.count() > 0
           && (equals == std::string_view::npos || has_value(option, text.substr(equals + 1)));
}

/// As it would be written: "--truth contacts".
std::string written(std::string_view text) {
    std::string result(text);
    std::ranges::replace(result, '=', ' ');
    return result;
}

/// Other devices have no threads of ours. Commands that take all where none is named have some.
void refuse_idle_threads(const CLI::App& command) {
    const auto* threads = option_of(command, "--threads");
    if (threads == nullptr || threads->count() == 0) return;
    const auto& devices = command.get_option("--device")->results();
    const bool all = devices.empty() && command.get_name() == "check";
    const auto is_host = [](const std::string& group) {
        const auto parts = CLI::detail::split(group, '+');
        return std::ranges::any_of(parts, [](const auto& part) {
            return part == "host" || part.starts_with("host:") || part == "all" || part == "each";
        });
    };
    if (!all && std::ranges::none_of(devices, is_host))
        throw InputError("--threads goes with --device host; other devices have none to set");
}

/// Whether an option of a rule is this one, whatever its value where the rule names none.
bool is_about(std::string_view of_rule, std::string_view option) {
    return of_rule == option || of_rule == option.substr(0, option.find('='));
}

} // namespace

bool line_speaks_against(const CLI::App& command, std::string_view option) {
    const auto gives = [&](std::string_view text) {
        const auto* given = option_of(command, text);
        return given != nullptr && is_given(*given, text);
    };
    return std::ranges::any_of(rules, [&](const Rule& rule) {
        return rule.together == Together::must_not
               && ((is_about(rule.option, option) && gives(rule.other))
                   || (is_about(rule.other, option) && gives(rule.option)));
    });
}

void refuse_contradictions(const CLI::App& command) {
    for (const auto& rule : rules) {
        const auto* option = option_of(command, rule.option);
        const auto* other = option_of(command, rule.other);
        if (option == nullptr || other == nullptr || !is_given(*option, rule.option)) continue;
        const bool must = rule.together == Together::must;
        if (is_given(*other, rule.other) != must)
            throw InputError(fmt::format("{} {} {}; {}", written(rule.option),
                                         must ? "goes with" : "does not go with", written(rule.other),
                                         rule.why));
    }
    refuse_idle_threads(command);
}

} // namespace tandem
