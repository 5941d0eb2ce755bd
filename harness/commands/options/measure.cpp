// SPDX-License-Identifier: MIT
// run, check, accuracy and profile: cells of a scene, measured and compared.
#include "harness/commands/options/actions.h"
#include "harness/commands/options/contradictions.h"
#include "harness/commands/options/option_groups.h"
#include "harness/commands/options/shared_options.h"
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

/// Options of `run` only: --algorithm auto and how it chooses.
void add_choosing(CLI::App& app, RunOptions& options) {
    app.option_defaults()->group(option_groups::how_long);
    app.get_option("--algorithm")
        ->description("algorithms, or all (see 'tandem algorithms'; default: all); auto: the algorithm and "
                      "settings that are fastest on the first frames");
    app.add_option("--choose-seconds", options.choose_seconds,
                   "auto: limit of the replays that choose for a cell, in seconds; preparing candidates may "
                   "take six times as long (default: 10)")
        ->check(seconds_up_to(86400))
        ->option_text("SECONDS");
    app.add_flag("--choose-afresh", options.choose_afresh,
                 "auto: choose again instead of reading a stored choice ($TANDEM_KERNEL_CACHE, or "
                 "$XDG_CACHE_HOME/tandem)");
}

/// What tables show, and how.
void add_table(CLI::App& app, RunOptions& options) {
    app.option_defaults()->group(option_groups::output);
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
    app.get_option("--algorithm")
        ->description("algorithms, or all (see 'tandem algorithms'; default: tiled)");
    app.get_option("--frames")->description("the first and the last frame (default: ten in the middle)");
    app.get_option("--set")->description(
        "values of a setting, each makes a cell (default: sweeps of k, precision and rounding, then of "
        "precision, decision and contact_rule)");
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
    app.option_defaults()->group(option_groups::output);
    app.add_option("--dump-pairs", options.dump_pairs,
                   "write the candidate pairs of the first finished cell to this CSV file")
        ->option_text("FILE");
    app.add_option("--dump-contacts", options.dump_contacts,
                   "write the contacts of the first finished cell to this CSV file")
        ->option_text("FILE");
    app.add_option("--dump-distances", options.dump_distances,
                   "write the distances of the first finished cell (contact_rule=distance), with both "
                   "points, to this CSV file")
        ->option_text("FILE");
    app.add_option("--dump-surfaces", options.dump_surfaces,
                   "write the contact surfaces of the first finished cell (contact_rule=pressure), with "
                   "their corners, to this VTK file (.vtp)")
        ->option_text("FILE");
    add_trace(app, options);
}

/// The processes that share the work, and those of a profiler.
void add_processes(CLI::App& app, RunOptions& options) {
    app.option_defaults()->group(option_groups::machine);
    auto* isolate = app.add_flag(
        "--isolate", options.isolate,
        "run each check and each round of a cell in a process of its own: a crash or hang costs that cell "
        "only, and differences between processes are part of the noise");
    auto* timeout = app.add_option("--timeout", options.timeout,
                                   "--isolate: seconds after which a process is ended (default: no limit)");
    timeout->needs(isolate)->check(seconds_up_to(1e7))->option_text("SECONDS");
    app.add_option_function<std::string>(
           "--shard", [&options](const std::string& text) { options.shard = parse_shard(text); },
           "I/N: only the groups of a plan (a scene with its frames) whose number from 0 modulo N is I; "
           "slurm: I and N of this task in its job array")
        ->option_text("I/N|slurm");
    app.add_option("--profile", options.profile,
                   "replay the frames N times and measure nothing, for an external profiler")
        ->check(CLI::Range(1, 1000000))
        ->option_text("N");
}

} // namespace

Action add_run(CLI::App& app) {
    auto given = std::make_shared<RunOptions>();
    auto& options = *given;
    app.add_option("scenes", options.scenes,
                   fmt::format("{}, or a plan of cells (.json, see results/plan.schema.json)", scene_help))
        ->option_text("SCENE...");
    add_run_options(app, options);
    add_sampling(app, options);
    add_choosing(app, options);
    app.option_defaults()->group(option_groups::output);
    app.add_flag("--dry-run", options.dry_run, "list the cells with their estimated seconds; measure none");
    app.add_flag("--keys", options.keys, "--dry-run: also list the keys of their records");
    app.add_flag("--resume", options.resume,
                 "skip the cells that --out already has from a program of the same sources")
        ->needs("--out");
    add_table(app, options);
    add_dumps(app, options);
    add_processes(app, options);
    add_no_check(app, options);
    add_check_afresh(app, options);
    app.add_flag("!--no-count", options.count, "skip the replay that counts work")
        ->group(option_groups::checks);
    app.callback([given, line = &app] { apply_plan(*line, *given); });
    app.footer("tandem run pile --out records.jsonl\n"
               "tandem run pile:bodies=64 --algorithm tiled,chunked --set k=8,18\n"
               "tandem run --mesh a.msh --mesh b.msh --pose \"0 0 0 1 0 0 0\" --repeat 10");
    return [given] { return run_command(*given); };
}

Action add_isolated(CLI::App&) { return isolated_command; }

Action add_check(CLI::App& app) {
    auto given = std::make_shared<RunOptions>();
    app.add_option("scene", given->scene, scene_help);
    add_run_options(app, *given);
    app.get_option("--preset")->description("presets (see 'tandem algorithms'; default: all)");
    app.get_option("--device")
        ->description("devices; D+E is one cell on both (see 'tandem devices'; default: all)");
    app.footer("tandem check pile --frames 20\n"
               "tandem check hard:all --device host");
    return [given] { return check_command(*given); };
}

Action add_accuracy(CLI::App& app) {
    auto given = std::make_shared<AccuracyOptions>();
    auto& options = *given;
    app.add_option("scenes", options.scenes, scene_help)->option_text("SCENE...");
    add_accuracy_run_options(app, options.run);
    app.option_defaults()->group(option_groups::how_long);
    app.add_option("--repeat", options.run.repeat, "number of samples of each cell (default: 3)")
        ->check(CLI::Range(1, 1000))
        ->option_text("N");
    add_no_check(app, options.run);
    app.get_option("--no-check")->description("do not compare with the reference, only with the truth");
    add_check_afresh(app, options.run);
    app.option_defaults()->group(option_groups::output);
    app.add_option("--figures", options.figures,
                   "draw the records of --out, or of FOLDER/accuracy.jsonl without --out, into this folder")
        ->option_text("FOLDER");
    app.footer("tandem accuracy pile:bodies=20 --set k=8,18 --figures out");
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
    add_no_check(app, run);
    app.option_defaults()->group(option_groups::output);
    app.add_flag("--all", options.all,
                 "print one row for every kernel (default: one row for all kernels below 1 %)");
    add_trace(app, run);
    app.add_option("--ceilings", options.ceilings,
                   "read the device's ceilings from this file of 'tandem devices --measure --out' (default: "
                   "measure them)")
        ->option_text("FILE")
        ->group(option_groups::machine);
    app.footer("tandem profile pile --algorithm tiled --trace timeline.json");
    return [given] { return profile_command(*given); };
}

} // namespace tandem
