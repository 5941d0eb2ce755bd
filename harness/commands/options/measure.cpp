// SPDX-License-Identifier: MIT
// run, check and accuracy: cells of a scene, measured and compared.
#include "harness/commands/options/actions.h"
#include "harness/commands/options/contradictions.h"
#include "harness/commands/options/sets.h"
#include "harness/commands/commands.h"
#include "harness/sampling/isolation/isolated_sampler.h"
#include "base/error.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>
#include <memory>

namespace tandem {

namespace {

TruthAmount parse_truth(const std::string& text) {
    if (text == "none") return TruthAmount::none;
    if (text == "pairs") return TruthAmount::pairs;
    if (text == "contacts") return TruthAmount::contacts;
    throw InputError(fmt::format("--truth {}: give none, pairs or contacts", text));
}

/// The texts of --set, and what else sets a setting.
auto sets_of(const std::vector<std::string>& texts, const RunOptions& options) {
    auto sets = parse_sets(texts);
    if (options.threads) sets.push_back({"threads", {std::to_string(*options.threads)}});
    return sets;
}

constexpr auto trace_help = "write the timeline of a frame, the middle one, of the first finished cell: JSON "
                            "for ui.perfetto.dev or chrome://tracing";
constexpr auto scene_help = "NAME, NAME:par=value,..., a scene description (.json) or a recording (.frames)";

/// What is measured: the scene's meshes and frames, and the cells.
void add_cell_options(CLI::App& app, RunOptions& options, std::vector<std::string>& sets) {
    app.add_option("--mesh", options.meshes, "a scene of mesh files instead")->expected(1)->take_all();
    app.add_option("--pose", options.poses, "\"tx ty tz qw qx qy qz\", one per --mesh, in order")
        ->expected(1)
        ->take_all();
    app.add_option("--algorithm", options.request.algorithms,
                   "A,B or all (see 'tandem algorithms'); all when left out")
        ->delimiter(',');
    app.add_option(
           "--preset", options.request.presets,
           "P,Q or all (see 'tandem algorithms'); when left out each algorithm's first, for check all")
        ->delimiter(',');
    app.add_option("--device", options.request.devices,
                   "D,E or all (see 'tandem devices'), D+E for one cell on both; when left out opencl:0, for "
                   "check all")
        ->delimiter(',');
    app.add_option("--frames", options.frames, "FIRST:LAST, both inclusive; all when left out");
    app.add_option(
           "--threads", options.threads,
           "threads that run work-groups of device host, as --set threads=N; when left out one for each core")
        ->check(CLI::Range(0, 4096));
    app.add_option("--set", sets, "NAME=V1,V2, A..B:STEP or A..B*FACTOR: several values make several cells")
        ->expected(1)
        ->take_all();
}

/// add_cell_options and how they are run: what `run`, `check` and `accuracy` have in common.
void add_run_options(CLI::App& app, RunOptions& options, std::vector<std::string>& sets) {
    add_cell_options(app, options, sets);
    app.add_option("--out", options.out,
                   "append records to this JSON-lines file, a torn last line of which goes to FILE.torn");
    app.add_option("--require", options.require, "devices or backends whose absence is a failure")
        ->delimiter(',');
    app.add_option_function<std::string>(
           "--truth", [&options](const std::string& text) { options.truth = parse_truth(text); },
           "compare with the exact truth: none, pairs (every pair of every frame; the default) or contacts "
           "(depths, "
           "normals and points too)")
        ->option_text("none|pairs|contacts");
    app.add_option("--truth-contacts", options.truth_contacts,
                   "exact contacts of at most so many pairs a frame; all when left out")
        ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 40));
    app.add_option_function<std::string>(
           "--degenerate",
           [&options](const std::string& text) { options.degenerate = degenerate_named(text); },
           "tetrahedra of zero volume and with coordinates that are not finite: flat (the first take part, "
           "the "
           "second are refused; the default), skip (neither takes part) or reject (both are refused)")
        ->option_text("flat|skip|reject");
    app.add_option("--memory", options.memory,
                   "take at most so many bytes of a device's memory; frames that need more run in batches "
                   "(4096, 512MB, 2GiB)")
        ->transform(CLI::AsSizeValue(false))
        ->option_text("BYTES");
    app.add_flag("--quiet", options.quiet, "no progress line");
}

/// "1%" as "0.01".
const CLI::Validator share(
    [](std::string& text) -> std::string {
        const bool percent = text.ends_with('%');
        double value = 0;
        if (!CLI::detail::lexical_cast(percent ? text.substr(0, text.size() - 1) : text, value)
            || !(value > 0 && value <= (percent ? 100 : 1)))
            return "give a share such as 0.01 or 1%";
        if (percent) text = CLI::detail::to_string(value / 100);
        return {};
    },
    "SHARE");

void add_check_afresh(CLI::App& app, RunOptions& options) {
    app.add_flag("--check-afresh", options.check_afresh,
                 "compute references and truths where what they say of the same frames was kept "
                 "($TANDEM_KERNEL_CACHE, or $XDG_CACHE_HOME/tandem)");
}

/// What `run` alone has: --algorithm auto and how it chooses.
void add_choosing(CLI::App& app, RunOptions& options) {
    app.get_option("--algorithm")
        ->description(
            "A,B (see 'tandem algorithms'); auto: the one that is fastest on the first frames, with "
            "the settings that are; all, without auto, when left out");
    app.add_option(
           "--choose-seconds", options.choose_seconds,
           "auto: seconds of replays, at most, to choose for a cell, and six times as many to prepare "
           "candidates; 10 when left out")
        ->check(CLI::Range(0.001, 86400.0))
        ->option_text("S");
    app.add_flag("--choose-afresh", options.choose_afresh,
                 "auto: measure again where a choice was kept ($TANDEM_KERNEL_CACHE, or "
                 "$XDG_CACHE_HOME/tandem)");
}

/// When a cell has been sampled enough.
void add_sampling(CLI::App& app, RunOptions& options) {
    app.add_option(
           "--noise", options.noise,
           "sample a cell, ten rounds at least, until the 95 % interval of its median is narrower than "
           "this share of it (0.01 or 1%); 1 % on GPUs and 3 % on processors when left out")
        ->transform(share)
        ->option_text("P");
    app.add_option("--seconds", options.seconds, "or until its rounds have taken so long; 10 when left out")
        ->check(CLI::Range(0.001, 1e6))
        ->option_text("S");
    app.add_option("--repeat", options.repeat, "instead: so many samples of each cell")
        ->check(CLI::Range(1, 1000));
    app.add_option("--seed", options.seed,
                   "of the order in which cells take turns in a round; by chance when left out")
        ->option_text("N");
}

/// add_run_options with the other defaults of `accuracy`, which is about the truth and cannot leave it out.
void add_accuracy_run_options(CLI::App& app, RunOptions& options, std::vector<std::string>& sets) {
    options.truth_contacts = 1000;
    add_run_options(app, options, sets);
    app.remove_option(app.get_option("--truth"));
    app.get_option("--algorithm")->description("A,B (see 'tandem algorithms'); chunked when left out");
    app.get_option("--frames")->description("FIRST:LAST, both inclusive; ten in the middle when left out");
    app.get_option("--set")->description(
        "NAME=V1,V2: these cells; when left out k, precision and rounding, then "
        "precision, decision and contact rule");
    app.get_option("--truth-contacts")
        ->description("exact contacts of at most so many pairs a frame; 1000 when left out");
}

/// The options of the plan that the line neither gives nor speaks against: what says when a cell has enough
/// as a whole.
auto measure_left(const CLI::App& app, const PlanFile& plan) {
    const auto is_given = [&](const std::string& name) { return app.count("--" + name) > 0; };
    const auto says_enough = [](const std::string& name) {
        return name == "repeat" || name == "noise" || name == "seconds";
    };
    const bool enough_is_given = is_given("repeat") || is_given("noise") || is_given("seconds");
    auto left = plan.measure;
    std::erase_if(left, [&](const auto& one) {
        const auto& [name, value] = one;
        return is_given(name) || (says_enough(name) && enough_is_given)
               || line_speaks_against(app, "--" + name + (value.empty() ? "" : "=" + value));
    });
    return left;
}

void take_measure(CLI::App& app, const PlanFile& plan) {
    for (const auto& [name, value] : measure_left(app, plan)) {
        auto* option = app.get_option("--" + name);
        option->add_result(value.empty() ? option->get_flag_value(name, "") : value);
        option->run_callback();
    }
}

/// Lets options that go with others find those that the plan gives; the cells have them from the plan itself.
void show_request(CLI::App& app, const PlanFile& plan) {
    const bool gives_algorithms = app.count("--algorithm") > 0, gives_devices = app.count("--device") > 0;
    for (const auto& product : plan.products) {
        if (!gives_algorithms)
            for (const auto& name : product.request.algorithms)
                app.get_option("--algorithm")->add_result(name);
        if (!gives_devices)
            for (const auto& name : product.request.devices) app.get_option("--device")->add_result(name);
    }
}

/// A plan among the scenes, which stands by itself. Contradictions on the line are told before those within
/// the plan, or between both.
void take_plan(CLI::App& app, RunOptions& options) {
    const auto found = std::ranges::find_if(options.scenes, is_plan);
    if (found == options.scenes.end()) return;
    const auto path = *found;
    if (options.scenes.size() > 1 || !options.meshes.empty())
        throw InputError(fmt::format("{}: is a plan and names its scenes; give no others beside it", path));
    options.plan = read_plan(path);
    options.scenes.clear();
    show_request(app, *options.plan);
    refuse_contradictions(app);
    try {
        take_measure(app, *options.plan);
        refuse_contradictions(app);
    } catch (const CLI::ParseError& error) {
        throw InputError(fmt::format("{}: /measure: {}", path, error.what()));
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}: /measure: {}", path, error.what()));
    }
}

} // namespace

Action add_run(CLI::App& app) {
    auto given = std::make_shared<Given<RunOptions>>();
    auto& options = given->options;
    app.add_option("scenes", options.scenes,
                   fmt::format("{}; or a plan of cells (.json, see results/plan.schema.json)", scene_help));
    add_run_options(app, options, given->sets);
    add_choosing(app, options);
    app.add_flag("--dry-run", options.dry_run,
                 "list the cells with their keys and a guess of the time; measure none");
    app.add_flag("--resume", options.resume,
                 "leave out the cells that --out has of a program of the same sources")
        ->needs("--out");
    add_sampling(app, options);
    auto* isolate = app.add_flag(
        "--isolate", options.isolate,
        "check a cell, and take each of its rounds, in a process of its own: a crash or a hang costs "
        "that cell only, and the luck of a process is part of the noise");
    auto* timeout = app.add_option("--timeout", options.timeout,
                                   "seconds after which such a process is ended; no limit when left out");
    timeout->needs(isolate)->check(CLI::Range(0.001, 1e7))->option_text("S");
    app.add_option_function<std::string>(
           "--shard", [&options](const std::string& text) { options.shard = parse_shard(text); },
           "I/N: of a plan's groups, a scene with its frames each, those whose number from 0 modulo N is I; "
           "slurm: as the task of a job array that this is")
        ->option_text("I/N|slurm");
    app.add_option("--profile", options.profile, "only replay the frames N times, for a profiler")
        ->check(CLI::Range(1, 1000000));
    app.add_option("--dump-pairs", options.dump_pairs,
                   "write the first finished cell's candidate pairs as CSV");
    app.add_option("--dump-contacts", options.dump_contacts,
                   "write the first finished cell's contacts as CSV");
    app.add_option("--trace", options.trace, trace_help);
    app.add_flag("!--no-count", options.count, "leave out the replay that counts work");
    app.add_flag("!--no-check", options.check, "do not compare with the reference");
    add_check_afresh(app, options);
    app.callback([given, line = &app] {
        take_plan(*line, given->options);
        given->options.request.sets = sets_of(given->sets, given->options);
    });
    return [given] { return run_command(given->options); };
}

Action add_isolated(CLI::App& app) {
    app.group(""); // not in the help
    return isolated_command;
}

Action add_check(CLI::App& app) {
    auto given = std::make_shared<Given<RunOptions>>();
    app.add_option("scene", given->options.scene, scene_help);
    add_run_options(app, given->options, given->sets);
    return [given] {
        given->options.request.sets = sets_of(given->sets, given->options);
        return check_command(given->options);
    };
}

Action add_accuracy(CLI::App& app) {
    auto given = std::make_shared<Given<AccuracyOptions>>();
    auto& options = given->options;
    app.add_option("scenes", options.scenes, scene_help);
    add_accuracy_run_options(app, options.run, given->sets);
    app.add_option("--repeat", options.run.repeat, "samples per cell; 3 when left out")
        ->check(CLI::Range(1, 1000));
    app.add_flag("!--no-check", options.run.check, "do not compare with the reference; the truth stays");
    add_check_afresh(app, options.run);
    app.add_option("--figures", options.figures,
                   "draw the records of --out, or of FOLDER/accuracy.jsonl without it, into this folder")
        ->option_text("FOLDER");
    return [given] {
        given->options.run.request.sets = sets_of(given->sets, given->options.run);
        return accuracy_command(given->options);
    };
}

/// The truth has nothing to do with it.
Action add_profile(CLI::App& app) {
    auto given = std::make_shared<Given<ProfileOptions>>();
    auto& options = given->options;
    auto& run = options.run;
    run.truth = TruthAmount::none;
    app.add_option("scene", run.scene, scene_help);
    add_run_options(app, run, given->sets);
    for (const auto* name : {"--truth", "--truth-contacts"}) app.remove_option(app.get_option(name));
    add_sampling(app, run);
    app.add_option("--ceilings", options.ceilings,
                   "take the device's ceilings from this file of 'tandem devices --measure --out'; measured "
                   "when left out");
    app.add_option("--trace", run.trace, trace_help);
    app.add_flag("--all", options.all, "a row for every kernel; those below 1 % are one when left out");
    app.add_flag("!--no-check", run.check, "do not compare with the reference");
    return [given] {
        given->options.run.request.sets = sets_of(given->sets, given->options.run);
        return profile_command(given->options);
    };
}

} // namespace tandem
