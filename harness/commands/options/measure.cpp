// SPDX-License-Identifier: MIT
// run, check and accuracy: cells of a scene, measured and compared.
#include "harness/plans/device_groups.h"
#include "harness/commands/options/actions.h"
#include "harness/commands/options/contradictions.h"
#include "harness/commands/options/reading.h"
#include "harness/commands/options/sets.h"
#include "harness/commands/accuracy.h"
#include "harness/commands/check.h"
#include "harness/commands/run.h"
#include "harness/profile/command.h"
#include "harness/record/table/throughput.h"
#include "harness/sampling/isolation/isolated_sampler.h"
#include "base/error.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>

namespace tandem {

namespace {

TruthAmount parse_truth(const std::string& text) {
    if (text == "none") return TruthAmount::none;
    if (text == "pairs") return TruthAmount::pairs;
    if (text == "contacts") return TruthAmount::contacts;
    throw InputError(fmt::format("--truth {}: give none, pairs or contacts", text));
}

constexpr auto trace_help =
    "write a timeline of the middle frame of the first finished cell to this JSON file "
    "(for ui.perfetto.dev or chrome://tracing)";
constexpr auto scene_help = "NAME, NAME:par=value,..., a scene description (.json) or a recording (.frames)";

/// The options that define the cells: meshes, frames, algorithms, devices and settings.
void add_cell_options(CLI::App& app, RunOptions& options) {
    app.add_option("--mesh", options.meshes, "a mesh file of the scene, instead of SCENE; may be repeated")
        ->expected(1)
        ->take_all();
    app.add_option("--pose", options.poses,
                   "\"tx ty tz qw qx qy qz\", one per --mesh, in order (default: identity)")
        ->expected(1)
        ->take_all();
    add_reading_options(app, options.reading);
    app.add_option("--algorithm", options.request.algorithms,
                   "A,B or all (see 'tandem algorithms'; default: all)")
        ->delimiter(',');
    app.add_option("--preset", options.request.presets,
                   "P,Q or all (see 'tandem algorithms'; default: each algorithm's first, for check all)")
        ->delimiter(',');
    app.add_option(
           "--device", options.request.devices,
           fmt::format(
               "D,E or all, D+E for one cell on both (see 'tandem devices'; default: {}; for check all)",
               default_device_help))
        ->delimiter(',');
    app.add_option("--frames", options.frames, "FIRST:LAST, both inclusive, or one number (default: all)");
    app.add_option_function<std::size_t>(
           "--threads",
           [&options](std::size_t threads) {
               options.request.sets.push_back({"threads", {std::to_string(threads)}});
           },
           "number of threads of device host, as --set threads=N (default: one for each core)")
        ->check(CLI::Range(0, 4096));
    app.add_option("--filter", options.filter,
                   "only cells whose name contains a match of this regular expression, as of grep -E; tables "
                   "and --dry-run show the names")
        ->option_text("REGEX");
    add_set_option(
        app, options.request,
        "NAME=V1,V2, NAME=A..B:STEP or NAME=A..B*FACTOR: each value makes a cell; may be repeated");
}

/// The options that `run`, `check`, `accuracy` and `profile` have in common.
void add_run_options(CLI::App& app, RunOptions& options) {
    add_cell_options(app, options);
    app.add_option("--out", options.out,
                   "append records to this JSON-lines file; an incomplete last line is moved to FILE.torn");
    app.add_option("--require", options.require, "devices or backends whose absence is an error")
        ->delimiter(',');
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
        ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 40));
    app.add_option_function<std::string>(
           "--degenerate",
           [&options](const std::string& text) { options.degenerate = degenerate_named(text); },
           "tetrahedra of zero volume: flat (keep them), skip (leave them out) or reject (refuse them); "
           "files "
           "with coordinates that are not finite are always refused (default: flat)")
        ->option_text("flat|skip|reject");
    app.add_option(
           "--memory", options.memory,
           "limit of device memory in bytes (4096, 512MB, 2GiB); frames that need more run in batches "
           "(default: no limit)")
        ->transform(CLI::AsSizeValue(false))
        ->option_text("BYTES");
    app.add_flag("--quiet", options.quiet, "print no progress line");
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

void add_check_afresh(CLI::App& app, RunOptions& options) {
    app.add_flag("--check-afresh", options.check_afresh,
                 "compute references and truths again instead of reading stored ones "
                 "($TANDEM_KERNEL_CACHE, or $XDG_CACHE_HOME/tandem)");
}

/// Options of `run` only: --algorithm auto and how it chooses.
void add_choosing(CLI::App& app, RunOptions& options) {
    app.get_option("--algorithm")
        ->description("A,B (see 'tandem algorithms'; default: all, without auto); auto: the algorithm and "
                      "settings that are fastest on the first frames");
    app.add_option("--choose-seconds", options.choose_seconds,
                   "auto: limit of the replays that choose for a cell, in seconds; preparing candidates may "
                   "take six times as long (default: 10)")
        ->check(CLI::Range(0.001, 86400.0))
        ->option_text("S");
    app.add_flag("--choose-afresh", options.choose_afresh,
                 "auto: choose again instead of reading a stored choice ($TANDEM_KERNEL_CACHE, or "
                 "$XDG_CACHE_HOME/tandem)");
}

/// The stopping criterion and the order of cells.
void add_sampling(CLI::App& app, RunOptions& options) {
    app.add_option("--noise", options.noise,
                   "stop sampling when the 95 % interval of a cell's median is narrower than this fraction "
                   "(0.01 or 1%), ten rounds at least (default: 1 % on GPUs, 3 % on processors)")
        ->transform(fraction)
        ->option_text("P");
    app.add_option(
           "--seconds", options.seconds,
           "or stop when a cell's rounds have taken so many seconds, ten rounds at least (default: 10)")
        ->check(CLI::Range(0.001, 1e6))
        ->option_text("S");
    app.add_option("--repeat", options.repeat,
                   "take exactly N samples of each cell, instead of --noise and --seconds")
        ->check(CLI::Range(1, 1000));
    app.add_option("--seed", options.seed, "seed of the order of cells in each round (default: random)")
        ->option_text("N");
}

/// What tables show, and how.
void add_table(CLI::App& app, RunOptions& options) {
    app.add_option("--columns", options.columns,
                   "further columns of the table: pairs/s (candidate pairs a second), GB/s (bytes a second "
                   "that the kernels need at least: inputs read once, outputs written once)")
        ->delimiter(',')
        ->check(CLI::IsMember(std::vector<std::string>(throughput_names.begin(), throughput_names.end())))
        ->option_text(fmt::to_string(fmt::join(throughput_names, "|")));
    app.add_option_function<std::string>(
           "--format",
           [&options](const std::string& text) {
               options.format = text == "markdown" ? TableFormat::markdown : TableFormat::text;
           },
           "format of the tables (default: text)")
        ->check(CLI::IsMember({"text", "markdown"}))
        ->option_text("text|markdown");
}

/// add_run_options() with other defaults for `accuracy`, which always compares with the truth.
void add_accuracy_run_options(CLI::App& app, RunOptions& options) {
    options.truth_contacts = 1000;
    add_run_options(app, options);
    app.remove_option(app.get_option("--truth"));
    app.get_option("--algorithm")->description("A,B (see 'tandem algorithms'; default: chunked)");
    app.get_option("--frames")->description("FIRST:LAST, both inclusive (default: ten in the middle)");
    app.get_option("--set")->description(
        "NAME=V1,V2: values of a setting, each makes a cell (default: sweeps of k, precision and rounding, "
        "then of precision, decision and contact_rule)");
    app.get_option("--truth-contacts")
        ->description("maximum number of pairs per frame whose exact contacts are computed (default: 1000)");
}

/// The options of the plan that the line neither gives nor excludes. The options of the stopping criterion
/// count as one: a given one overrides them all.
auto remaining_measure(const CLI::App& app, const PlanFile& plan) {
    const auto is_given = [&](const std::string& name) { return app.count("--" + name) > 0; };
    const auto is_stopping_option = [](const std::string& name) {
        return name == "repeat" || name == "noise" || name == "seconds";
    };
    const bool stopping_is_given = is_given("repeat") || is_given("noise") || is_given("seconds");
    auto remaining = plan.measure;
    std::erase_if(remaining, [&](const auto& one) {
        const auto& [name, value] = one;
        return is_given(name) || (is_stopping_option(name) && stopping_is_given)
               || conflicts_with_line(app, "--" + name + (value.empty() ? "" : "=" + value));
    });
    return remaining;
}

void apply_measure(CLI::App& app, const PlanFile& plan) {
    for (const auto& [name, value] : remaining_measure(app, plan)) {
        auto* option = app.get_option("--" + name);
        option->add_result(value.empty() ? option->get_flag_value(name, "") : value);
        option->run_callback();
    }
}

/// Adds the plan's algorithms and devices to the line, for the check of contradictions only. The cells take
/// them from the plan itself.
void add_request_of_plan(CLI::App& app, const PlanFile& plan) {
    const bool gives_algorithms = app.count("--algorithm") > 0, gives_devices = app.count("--device") > 0;
    for (const auto& product : plan.products) {
        if (!gives_algorithms)
            for (const auto& name : product.request.algorithms)
                app.get_option("--algorithm")->add_result(name);
        if (!gives_devices)
            for (const auto& name : product.request.devices) app.get_option("--device")->add_result(name);
    }
}

/// Reads a plan, which must be the only scene, and applies its options. Contradictions on the line are
/// reported before contradictions within the plan, or between both.
void apply_plan(CLI::App& app, RunOptions& options) {
    const auto found = std::ranges::find_if(options.scenes, is_plan);
    if (found == options.scenes.end()) return;
    const auto path = *found;
    if (options.scenes.size() > 1 || !options.meshes.empty())
        throw InputError(
            fmt::format("{}: a plan names its own scenes; give no other scene or mesh with it", path));
    options.plan = read_plan(path);
    options.scenes.clear();
    add_request_of_plan(app, *options.plan);
    refuse_contradictions(app);
    try {
        apply_measure(app, *options.plan);
        refuse_contradictions(app);
    } catch (const CLI::ParseError& error) {
        throw InputError(fmt::format("{}: /measure: {}", path, error.what()));
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}: /measure: {}", path, error.what()));
    }
}

void add_dumps(CLI::App& app, RunOptions& options) {
    app.add_option("--dump-pairs", options.dump_pairs,
                   "write the candidate pairs of the first finished cell to this CSV file");
    app.add_option("--dump-contacts", options.dump_contacts,
                   "write the contacts of the first finished cell to this CSV file");
    app.add_option(
        "--dump-distances", options.dump_distances,
        "write the distances of the first finished cell (contact_rule=distance), with both points, to "
        "this CSV file");
    app.add_option(
        "--dump-surfaces", options.dump_surfaces,
        "write the contact surfaces of the first finished cell (contact_rule=pressure), with their "
        "corners, to this VTK file (.vtp)");
    app.add_option("--trace", options.trace, trace_help);
}

} // namespace

Action add_run(CLI::App& app) {
    auto given = std::make_shared<RunOptions>();
    auto& options = *given;
    app.add_option("scenes", options.scenes,
                   fmt::format("{}, or a plan of cells (.json, see results/plan.schema.json)", scene_help));
    add_run_options(app, options);
    add_choosing(app, options);
    app.add_flag("--dry-run", options.dry_run,
                 "list the cells with their keys and the estimated time; measure none");
    app.add_flag("--resume", options.resume,
                 "skip the cells that --out already has from a program of the same sources")
        ->needs("--out");
    add_sampling(app, options);
    add_table(app, options);
    auto* isolate = app.add_flag(
        "--isolate", options.isolate,
        "run each check and each round of a cell in a process of its own: a crash or hang costs that cell "
        "only, and differences between processes are part of the noise");
    auto* timeout = app.add_option("--timeout", options.timeout,
                                   "--isolate: seconds after which a process is ended (default: no limit)");
    timeout->needs(isolate)->check(CLI::Range(0.001, 1e7))->option_text("S");
    app.add_option_function<std::string>(
           "--shard", [&options](const std::string& text) { options.shard = parse_shard(text); },
           "I/N: only the groups of a plan (a scene with its frames) whose number from 0 modulo N is I; "
           "slurm: I and N of this task in its job array")
        ->option_text("I/N|slurm");
    app.add_option("--profile", options.profile,
                   "replay the frames N times and measure nothing, for an external profiler")
        ->check(CLI::Range(1, 1000000));
    add_dumps(app, options);
    app.add_flag("!--no-count", options.count, "skip the replay that counts work");
    app.add_flag("!--no-check", options.check, "do not compare with the reference");
    add_check_afresh(app, options);
    app.callback([given, line = &app] { apply_plan(*line, *given); });
    return [given] { return run_command(*given); };
}

Action add_isolated(CLI::App& app) {
    app.group(""); // hidden in the help
    return isolated_command;
}

Action add_check(CLI::App& app) {
    auto given = std::make_shared<RunOptions>();
    app.add_option("scene", given->scene, scene_help);
    add_run_options(app, *given);
    return [given] { return check_command(*given); };
}

Action add_accuracy(CLI::App& app) {
    auto given = std::make_shared<AccuracyOptions>();
    auto& options = *given;
    app.add_option("scenes", options.scenes, scene_help);
    add_accuracy_run_options(app, options.run);
    app.add_option("--repeat", options.run.repeat, "number of samples of each cell (default: 3)")
        ->check(CLI::Range(1, 1000));
    app.add_flag("!--no-check", options.run.check, "do not compare with the reference, only with the truth");
    add_check_afresh(app, options.run);
    app.add_option("--figures", options.figures,
                   "draw the records of --out, or of FOLDER/accuracy.jsonl without --out, into this folder")
        ->option_text("FOLDER");
    return [given] { return accuracy_command(*given); };
}

/// A profile does not compare with the truth, so it has no options for it.
Action add_profile(CLI::App& app) {
    auto given = std::make_shared<ProfileOptions>();
    auto& options = *given;
    auto& run = options.run;
    run.truth = TruthAmount::none;
    app.add_option("scene", run.scene, scene_help);
    add_run_options(app, run);
    for (const auto* name : {"--truth", "--truth-contacts"}) app.remove_option(app.get_option(name));
    add_sampling(app, run);
    app.add_option("--ceilings", options.ceilings,
                   "read the device's ceilings from this file of 'tandem devices --measure --out' (default: "
                   "measure them)");
    app.add_option("--trace", run.trace, trace_help);
    app.add_flag("--all", options.all,
                 "print one row for every kernel (default: one row for all kernels below 1 %)");
    app.add_flag("!--no-check", run.check, "do not compare with the reference");
    return [given] { return profile_command(*given); };
}

} // namespace tandem
