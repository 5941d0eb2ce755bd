// SPDX-License-Identifier: MIT
#include "harness/commands/options/shared_options.h"

#include "base/error.h"
#include "harness/commands/options/option_groups.h"
#include "harness/commands/options/reading.h"
#include "harness/commands/options/sets.h"
#include "harness/plans/device_groups.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>

namespace tandem {

namespace {

/// Turns "1.5GiB" into its number of bytes.
const CLI::Validator bytes(
    [](std::string& text) -> std::string {
        static constexpr std::string_view units = "KMGT";
        const auto digits = text.find_first_not_of("0123456789.");
        auto unit = text.substr(std::min(digits, text.size()));
        double value = 0;
        if (!unit.empty() && std::toupper(unit.back()) == 'B') unit.pop_back();
        if (unit.size() == 2 && unit.back() == 'i') unit.pop_back();
        const auto power = unit.empty() ? -1 : static_cast<int>(units.find(std::toupper(unit.front())));
        const bool known = unit.empty() || (unit.size() == 1 && power < 4 && power >= 0);
        if (!known || !CLI::detail::lexical_cast(text.substr(0, digits), value)) value = 0;
        value = std::ldexp(value, 10 * (power + 1));
        if (!(value >= 1 && value < 0x1p63)) return "give bytes such as 4096, 512MB or 1.5GiB";
        text = fmt::to_string(static_cast<std::uint64_t>(value));
        return {};
    },
    "BYTES");

TruthAmount parse_truth(const std::string& text) {
    if (text == "none") return TruthAmount::none;
    if (text == "pairs") return TruthAmount::pairs;
    if (text == "contacts") return TruthAmount::contacts;
    throw InputError(fmt::format("--truth {}: give none, pairs or contacts", text));
}

/// Meshes and frames.
void add_scene(CLI::App& app, RunOptions& options) {
    add_mesh_options(app, options.meshes, options.poses);
    app.add_option("--frames", options.frames, "the first and the last frame, or one number (default: all)")
        ->option_text("FIRST:LAST");
    app.add_option_function<std::string>(
           "--degenerate",
           [&options](const std::string& text) { options.degenerate = degenerate_named(text); },
           "tetrahedra of zero volume: flat (keep them), skip (leave them out) or reject (refuse them); "
           "files with coordinates that are not finite are always refused (default: flat)")
        ->option_text("flat|skip|reject");
    add_reading_options(app, options.reading);
}

/// Algorithms and settings.
void add_cells(CLI::App& app, RunOptions& options) {
    app.add_option("--algorithm", options.request.algorithms,
                   "algorithms, or all (see 'tandem algorithms'; default: all)")
        ->delimiter(',')
        ->option_text("NAME,...");
    app.add_option("--preset", options.request.presets,
                   "presets, or all (see 'tandem algorithms'; default: each algorithm's first)")
        ->delimiter(',')
        ->option_text("NAME,...");
    add_set_option(app, options.request,
                   "values of a setting, also A..B:STEP or A..B*FACTOR: each makes a cell; may be repeated "
                   "(see 'tandem help settings')");
    app.add_option("--filter", options.filter,
                   "only cells whose name contains a match of this regular expression, as of grep -E; tables "
                   "and --dry-run show the names")
        ->option_text("REGEX");
}

void add_truth(CLI::App& app, RunOptions& options) {
    app.add_option_function<std::string>(
           "--truth",
           [&options](const std::string& text) {
               options.truth = parse_truth(text);
               options.truth_is_given = true;
           },
           "compare with the exact truth: none, pairs (all pairs of all frames) or contacts (also depths, "
           "normals and points) (default: pairs; none with output=contacts)")
        ->option_text("none|pairs|contacts");
    app.add_option("--truth-contacts", options.truth_contacts,
                   "maximum number of pairs per frame whose exact contacts are computed (default: all)")
        ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 40))
        ->option_text("N");
}

void add_machine(CLI::App& app, RunOptions& options) {
    app.add_option("--device", options.request.devices,
                   fmt::format("devices, or all; D+E is one cell on both (see 'tandem devices'; default: {})",
                               default_device_help))
        ->delimiter(',')
        ->option_text("DEVICE,...");
    app.add_option("--require", options.require, "devices or backends whose absence is an error")
        ->delimiter(',')
        ->option_text("DEVICE,...");
    app.add_option_function<std::size_t>(
           "--threads",
           [&options](std::size_t threads) {
               options.request.sets.push_back({"threads", {std::to_string(threads)}});
           },
           "number of threads of device host, as --set threads=N (default: one for each core)")
        ->check(CLI::Range(0, 4096))
        ->option_text("N");
    app.add_option("--memory", options.memory,
                   "limit of device memory in bytes (4096, 512MB, 1.5GiB: powers of 1024); frames that need "
                   "more run in batches "
                   "(default: no limit)")
        ->transform(bytes)
        ->option_text("BYTES");
}

/// Accepts "0.01" and turns "1%" into "0.01".
const CLI::Validator fraction(
    [](std::string& text) -> std::string {
        const bool percent = text.ends_with('%');
        double value = 0;
        if (!CLI::detail::lexical_cast(percent ? text.substr(0, text.size() - 1) : text, value)
            || !(value > 0 && value <= (percent ? 100 : 1)))
            return "give a fraction such as 0.01 or 1%";
        if (percent) text = CLI::detail::to_string(value / 100);
        return {};
    },
    "FRACTION");

} // namespace

CLI::Validator seconds_up_to(double most) {
    return {[most](const std::string& text) -> std::string {
                double value = 0;
                if (CLI::detail::lexical_cast(text, value) && value >= 0.001 && value <= most) return {};
                return fmt::format("give seconds from 0.001 to {:g}", most);
            },
            "SECONDS"};
}

void add_run_options(CLI::App& app, RunOptions& options) {
    app.option_defaults()->group(option_groups::what);
    add_scene(app, options);
    add_cells(app, options);
    app.option_defaults()->group(option_groups::checks);
    add_truth(app, options);
    app.option_defaults()->group(option_groups::output);
    app.add_option("--out", options.out,
                   "append records to this JSON-lines file; an incomplete last line is moved to FILE.torn")
        ->option_text("FILE");
    app.add_flag("--quiet", options.quiet, "print no progress");
    app.option_defaults()->group(option_groups::machine);
    add_machine(app, options);
}

void add_sampling(CLI::App& app, RunOptions& options) {
    app.option_defaults()->group(option_groups::how_long);
    app.add_option("--noise", options.noise,
                   "stop sampling when the 95 % interval of a cell's median is narrower than this fraction "
                   "(0.01 or 1%), ten rounds at least (default: 1 % on GPUs, 3 % on processors)")
        ->transform(fraction)
        ->option_text("FRACTION");
    app.add_option(
           "--seconds", options.seconds,
           "or stop when a cell's rounds have taken so many seconds, ten rounds at least (default: 10)")
        ->check(seconds_up_to(1e6))
        ->option_text("SECONDS");
    app.add_option("--repeat", options.repeat,
                   "take exactly N samples of each cell, instead of --noise and --seconds")
        ->check(CLI::Range(1, 1000))
        ->option_text("N");
    app.add_option("--seed", options.seed, "seed of the order of cells in each round (default: random)")
        ->option_text("N");
}

void add_no_check(CLI::App& app, RunOptions& options) {
    app.add_flag("!--no-check", options.check, "do not compare with the reference")
        ->group(option_groups::checks);
}

void add_check_afresh(CLI::App& app, RunOptions& options) {
    app.add_flag("--check-afresh", options.check_afresh,
                 "compute references and truths again instead of reading stored ones "
                 "($TANDEM_KERNEL_CACHE, or $XDG_CACHE_HOME/tandem)")
        ->group(option_groups::checks);
}

void add_trace(CLI::App& app, RunOptions& options) {
    app.add_option("--trace", options.trace,
                   "write a timeline of the middle frame of the first finished cell to this JSON file "
                   "(for ui.perfetto.dev or chrome://tracing)")
        ->option_text("FILE")
        ->group(option_groups::output);
}

} // namespace tandem
