// SPDX-License-Identifier: MIT
#include "harness/commands.h"
#include "scenes/error.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace {

using tandem::InputError;
using tandem::RunOptions;
using tandem::SimulateOptions;

/// --set NAME=V1,V2 pairs, in order.
std::vector<std::pair<std::string, std::vector<std::string>>>
parse_sets(const std::vector<std::string>& texts) {
    std::vector<std::pair<std::string, std::vector<std::string>>> sets;
    for (const auto& text : texts) {
        const auto equals = text.find('=');
        if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
            throw InputError(fmt::format("--set {}: give NAME=VALUE or NAME=VALUE,VALUE", text));
        if (text.starts_with("degenerate="))
            throw InputError(
                fmt::format("--set {0}: it is said of frames, for all cells; give --degenerate {1}", text,
                            text.substr(equals + 1)));
        sets.emplace_back(text.substr(0, equals), CLI::detail::split(text.substr(equals + 1), ','));
    }
    return sets;
}

tandem::TruthAmount parse_truth(const std::string& text) {
    if (text == "none") return tandem::TruthAmount::none;
    if (text == "pairs") return tandem::TruthAmount::pairs;
    if (text == "contacts") return tandem::TruthAmount::contacts;
    throw InputError(fmt::format("--truth {}: give none, pairs or contacts", text));
}

void add_run_options(CLI::App& app, RunOptions& options, std::vector<std::string>& sets) {
    app.add_option("--mesh", options.meshes, "a scene of mesh files instead")->expected(1)->take_all();
    app.add_option("--pose", options.poses, "\"tx ty tz qw qx qy qz\", one per --mesh, in order")
        ->expected(1)
        ->take_all();
    app.add_option("--algorithm", options.request.algorithms,
                   "A,B (see 'tandem algorithms'); all when left out")
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
    app.add_option("--set", sets, "NAME=V1,V2: several values make several cells")->expected(1)->take_all();
    app.add_option("--out", options.out, "append records to this JSON-lines file");
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
           [&options](const std::string& text) { options.degenerate = tandem::degenerate_named(text); },
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

constexpr auto scene_help = "NAME, NAME:par=value,..., a scene description (.json) or a recording (.frames)";

void add_accuracy_options(CLI::App& app, tandem::AccuracyOptions& options, std::vector<std::string>& sets) {
    app.add_option("scenes", options.scenes, scene_help);
    options.run.truth_contacts = 1000;
    add_run_options(app, options.run, sets);
    app.remove_option(app.get_option("--truth"));
    app.get_option("--algorithm")->description("A,B (see 'tandem algorithms'); chunked when left out");
    app.get_option("--frames")->description("FIRST:LAST, both inclusive; ten in the middle when left out");
    app.get_option("--set")->description(
        "NAME=V1,V2: these cells; when left out k, precision and rounding, then "
        "precision, decision and contact rule");
    app.get_option("--truth-contacts")
        ->description("exact contacts of at most so many pairs a frame; 1000 when left out");
    app.add_option("--repeat", options.run.repeat, "samples per cell")->check(CLI::Range(1, 1000));
    app.add_flag("!--no-check", options.run.check, "do not compare with the reference; the truth stays");
    app.add_option("--figures", options.figures,
                   "draw the records of --out, or of FOLDER/accuracy.jsonl without it, into this folder")
        ->option_text("FOLDER");
}

void add_export_options(CLI::App& app, tandem::ExportOptions& options) {
    app.add_option("scene", options.scene, "NAME, NAME:par=value,..., a scene description or a recording");
    app.add_option("--mesh", options.meshes, "a scene of mesh files instead")->expected(1)->take_all();
    app.add_option("--pose", options.poses, "\"tx ty tz qw qx qy qz\", one per --mesh, in order")
        ->expected(1)
        ->take_all();
    app.add_option("--frames", options.frames, "FIRST:LAST, both inclusive; all when left out");
    app.add_option("--every", options.every, "every so many of these frames only")
        ->check(CLI::Range(1, 1000000));
    app.add_option("--vtu", options.vtu, "into this folder for ParaView: tetrahedra of every frame");
    app.add_option("--glb", options.glb, "into this file for viewers: surfaces, moved by an animation");
    auto* contacts = app.add_flag("--contacts", options.contacts, "contacts of every frame beside the .vtu");
    app.add_option("--device", options.device, "the device that finds them; host when left out")
        ->needs(contacts);
}

void add_simulate_options(CLI::App& app, SimulateOptions& options, std::vector<std::string>& sets) {
    app.add_option("scene", options.scene,
                   "NAME, NAME:par=value,... or a scene description with dynamics (.json)");
    app.add_option("-o,--output", options.recording, "record frames in this file, FILE.frames");
    app.add_option("--steps", options.steps, "steps in all; those of the scene when left out")
        ->check(CLI::Range(std::size_t{1}, std::size_t{100000000}));
    app.add_option("--record", options.record,
                   "append a line a step with its times and one for the run to this JSON-lines file");
    app.add_flag("--resume", options.resume, "go on with the recording from its last checkpoint");
    app.add_option("--checkpoint", options.every, "steps from one checkpoint to the next")
        ->check(CLI::Range(std::size_t{1}, std::size_t{100000000}));
    app.add_option("--dynamics", options.dynamics,
                   "NAME=VALUE: a setting of the motion (see 'tandem scenes')")
        ->expected(1)
        ->take_all();
    app.add_option("--algorithm", options.request.algorithms, "that finds contacts; chunked when left out");
    app.add_option("--preset", options.request.presets, "of it (see 'tandem algorithms')");
    app.add_option("--device", options.request.devices, "where contacts are found; opencl:0 when left out");
    app.add_option(
           "--set", sets,
           "NAME=VALUE: a setting of the algorithm; contact_rule=sat and decision=recheck when left out")
        ->expected(1)
        ->take_all();
    app.add_option("--require", options.require, "devices or backends whose absence is a failure")
        ->delimiter(',');
    app.add_flag("--quiet", options.quiet, "no progress line");
}

int dispatch(int argc, char** argv) {
    CLI::App app{"tandem: ways of walking bounding-volume hierarchies in tandem, measured and checked"};
    app.require_subcommand(1);
    RunOptions run;
    RunOptions check;
    std::vector<std::string> run_sets;
    std::vector<std::string> check_sets;
    tandem::DevicesOptions devices;
    bool json = false;
    auto* run_app = app.add_subcommand("run", "measure; print a table, append records");
    run_app->add_option("scene", run.scene, scene_help);
    add_run_options(*run_app, run, run_sets);
    run_app->add_option("--repeat", run.repeat, "samples per cell")->check(CLI::Range(1, 1000));
    run_app->add_option("--profile", run.profile, "only replay the frames N times, for a profiler")
        ->check(CLI::Range(1, 1000000));
    run_app->add_option("--dump-pairs", run.dump_pairs,
                        "write the first finished cell's candidate pairs as CSV");
    run_app->add_option("--dump-contacts", run.dump_contacts,
                        "write the first finished cell's contacts as CSV");
    run_app->add_flag("!--no-count", run.count, "leave out the replay that counts work");
    run_app->add_flag("!--no-check", run.check, "do not compare with the reference");
    auto* check_app =
        app.add_subcommand("check", "device x algorithm agreement matrix; exit 1 on any difference");
    check_app->add_option("scene", check.scene, scene_help);
    add_run_options(*check_app, check, check_sets);
    tandem::AccuracyOptions accuracy;
    std::vector<std::string> accuracy_sets;
    auto* accuracy_app =
        app.add_subcommand("accuracy", "error beside speed over settings, for several scenes");
    add_accuracy_options(*accuracy_app, accuracy, accuracy_sets);
    SimulateOptions simulate;
    std::vector<std::string> simulate_sets;
    auto* simulate_app = app.add_subcommand("simulate", "move a scene with dynamics; record its frames");
    add_simulate_options(*simulate_app, simulate, simulate_sets);
    tandem::ExportOptions exported;
    auto* export_app = app.add_subcommand("export", "frames as files for ParaView and other viewers");
    add_export_options(*export_app, exported);
    auto* devices_app = app.add_subcommand("devices", "what there is, or why there is not");
    devices_app->add_option("--require", devices.require, "devices or backends whose absence is a failure")
        ->delimiter(',');
    auto* measure = devices_app->add_flag("--measure", devices.measure,
                                          "measure what each can do: bandwidths, launches, overlap tests");
    devices_app->add_option("--device", devices.devices, "measure D,E only")->delimiter(',')->needs(measure);
    devices_app->add_option("--out", devices.out, "append the measurements to this JSON-lines file")
        ->needs(measure);
    auto* scenes_app = app.add_subcommand("scenes", "scenes the program makes, with their parameters");
    auto* algorithms_app = app.add_subcommand("algorithms", "algorithms with their presets and settings");
    for (auto* listing : {devices_app, scenes_app, algorithms_app})
        listing->add_flag("--json", json, "as JSON");
    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp& help) {
        return app.exit(help);
    } catch (const CLI::ParseError& error) {
        throw InputError(fmt::format("{}; see 'tandem --help'", error.what()));
    }
    run.request.sets = parse_sets(run_sets);
    check.request.sets = parse_sets(check_sets);
    if (*run_app) return tandem::run_command(run);
    if (*check_app) return tandem::check_command(check);
    accuracy.run.request.sets = parse_sets(accuracy_sets);
    if (*accuracy_app) return tandem::accuracy_command(accuracy);
    simulate.request.sets = parse_sets(simulate_sets);
    if (*simulate_app) return tandem::simulate_command(simulate);
    if (*export_app) return tandem::export_command(exported);
    if (*devices_app) {
        devices.json = json;
        return tandem::devices_command(devices);
    }
    if (*scenes_app) return tandem::scenes_command(json);
    return tandem::algorithms_command(json);
}

} // namespace

int main(int argc, char** argv) {
    try {
        return dispatch(argc, argv);
    } catch (const InputError& error) {
        fmt::print(stderr, "tandem: {}\n", error.what());
        return 2;
    } catch (const tandem::DeviceError& error) {
        fmt::print(stderr, "tandem: {}\n", error.what());
        return 3;
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "tandem: out of memory; use fewer bodies or frames\n");
        return 3;
    } catch (const std::exception& error) {
        fmt::print(stderr, "tandem: {}\n", error.what());
        return 3;
    }
}
