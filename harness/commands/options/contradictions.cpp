// SPDX-License-Identifier: MIT
#include "harness/commands/options/contradictions.h"

#include "base/error.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

/// Whether the first of two options requires the second or excludes it.
enum class OptionRule { requires_other, excludes_other };

/// Options are "--name", "--name WHAT" for the message, or "--name=value" when the rule is about one value.
/// That is an entry of a list, or the name before '=' of a setting.
struct Rule {
    std::string_view option;
    OptionRule relation;
    std::string_view other;
    std::string_view reason;
};

constexpr std::string_view only_replays = "--profile only replays frames and measures nothing";
constexpr std::string_view only_chunks = "only exported chunks depend on it";
constexpr std::string_view only_auto = "only auto makes a choice";

constexpr Rule rules[] = {
    {"--repeat", OptionRule::excludes_other, "--noise", "exactly N samples are taken, whatever their noise"},
    {"--repeat", OptionRule::excludes_other, "--seconds", "exactly N samples are taken, whatever their time"},
    {"--truth-contacts", OptionRule::requires_other, "--truth=contacts", "only that truth has contacts"},
    {"--choose-seconds", OptionRule::requires_other, "--algorithm=auto", only_auto},
    {"--choose-afresh", OptionRule::requires_other, "--algorithm=auto", only_auto},
    {"--threads", OptionRule::excludes_other, "--set=threads",
     "both set the number of threads of device host"},
    {"--profile", OptionRule::excludes_other, "--dry-run",
     "one replays frames and the other only lists cells"},
    {"--profile", OptionRule::excludes_other, "--resume", only_replays},
    {"--profile", OptionRule::excludes_other, "--repeat", only_replays},
    {"--profile", OptionRule::excludes_other, "--noise", only_replays},
    {"--profile", OptionRule::excludes_other, "--seconds", only_replays},
    {"--profile", OptionRule::excludes_other, "--seed", only_replays},
    {"--profile", OptionRule::excludes_other, "--isolate", only_replays},
    {"--profile", OptionRule::excludes_other, "--truth=pairs", only_replays},
    {"--profile", OptionRule::excludes_other, "--truth=contacts", only_replays},
    {"--keys", OptionRule::requires_other, "--dry-run", "only that list has keys"},
    {"--dry-run", OptionRule::excludes_other, "--dump-pairs",
     "no cell is measured, so there are no pairs to write"},
    {"--dry-run", OptionRule::excludes_other, "--dump-contacts",
     "no cell is measured, so there are no contacts to write"},
    {"--dry-run", OptionRule::excludes_other, "--dump-distances",
     "no cell is measured, so there are no distances to write"},
    {"--dry-run", OptionRule::excludes_other, "--dump-surfaces",
     "no cell is measured, so there are no surfaces to write"},
    {"--columns=GB/s", OptionRule::excludes_other, "--no-count",
     "the bytes of some kernels follow from counters"},
    {"--dry-run", OptionRule::excludes_other, "--columns", "no cell is measured, so there is no table"},
    {"--profile", OptionRule::excludes_other, "--columns", only_replays},
    {"--pose", OptionRule::requires_other, "--mesh FILE", "a scene has its own poses"},
    {"--resume", OptionRule::requires_other, "-o FILE", "it continues that recording"},
    {"--checkpoint", OptionRule::requires_other, "-o FILE", "checkpoints are stored beside a recording"},
    {"--pictures", OptionRule::requires_other, "-o FILE", "the pictures show that recording"},
    {"--chunks", OptionRule::excludes_other, "--csv", "a file of records has no chunks"},
    {"--builder", OptionRule::requires_other, "--chunks FILE", only_chunks},
    {"--chunk-bytes", OptionRule::requires_other, "--chunks FILE", only_chunks},
    {"--k", OptionRule::requires_other, "--chunks FILE", only_chunks},
};

/// The option that a rule names; null when the command has no such option.
const CLI::Option* option_of(const CLI::App& command, std::string_view text) {
    return command.get_option_no_throw(std::string(text.substr(0, text.find_first_of("= "))));
}

/// Values separated by commas are one result or several, depending on the option.
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

/// The option as on a command line: "--truth contacts".
std::string as_typed(std::string_view text) {
    std::string result(text);
    std::ranges::replace(result, '=', ' ');
    return result;
}

/// --threads applies to device host only. `check` uses all devices by default, so it includes the host.
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
        throw InputError("--threads requires --device host; other devices have no such threads");
}

/// Whether an option of a rule is `option`. A rule without a value applies to every value.
bool is_about(std::string_view rule_option, std::string_view option) {
    return rule_option == option || rule_option == option.substr(0, option.find('='));
}

} // namespace

bool conflicts_with_line(const CLI::App& command, std::string_view option) {
    const auto gives = [&](std::string_view text) {
        const auto* given = option_of(command, text);
        return given != nullptr && is_given(*given, text);
    };
    return std::ranges::any_of(rules, [&](const Rule& rule) {
        return rule.relation == OptionRule::excludes_other
               && ((is_about(rule.option, option) && gives(rule.other))
                   || (is_about(rule.other, option) && gives(rule.option)));
    });
}

void refuse_contradictions(const CLI::App& command) {
    for (const auto& rule : rules) {
        const auto* option = option_of(command, rule.option);
        const auto* other = option_of(command, rule.other);
        if (option == nullptr || other == nullptr || !is_given(*option, rule.option)) continue;
        const bool required = rule.relation == OptionRule::requires_other;
        if (is_given(*other, rule.other) != required)
            throw InputError(fmt::format("{} {} {}; {}", as_typed(rule.option),
                                         required ? "requires" : "cannot be combined with",
                                         as_typed(rule.other), rule.reason));
    }
    refuse_idle_threads(command);
}

} // namespace tandem
