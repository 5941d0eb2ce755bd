// SPDX-License-Identifier: MIT
// simulate and export, and what lists devices, scenes and algorithms.
#include "algorithms/parameters/table.h"
#include "harness/commands/options/actions.h"
#include "harness/commands/options/sets.h"
#include "harness/commands/commands.h"

#include <CLI/CLI.hpp>
#include <memory>

namespace tandem {

namespace {

/// What is simulated, how far, and what is written.
void add_motion_options(CLI::App& app, SimulateOptions& options) {
    app.add_option("scene", options.scene,
                   "NAME, NAME:par=value,... or a scene description with dynamics (.json)");
    app.add_option("-o,--output", options.recording, "record frames in this file, FILE.frames");
    app.add_option("--steps", options.steps, "steps in all; those of the scene when left out")
        ->check(CLI::Range(std::size_t{1}, std::size_t{100000000}));
    app.add_option("--record", options.record,
                   "append a line a step with its times and one for the run to this JSON-lines file; with "
                   "--resume none of a step that the run has recorded there");
    app.add_flag("--resume", options.resume, "go on with the recording from its last checkpoint");
    app.add_option("--checkpoint", options.every, "steps from one checkpoint to the next")
        ->check(CLI::Range(std::size_t{1}, std::size_t{100000000}));
    app.add_option("--pictures", options.pictures,
                   "OUT: draw the recording's begin, middle and end as OUT-0.png, OUT-1.png and OUT-2.png");
    app.add_option("--dynamics", options.dynamics,
                   "NAME=VALUE: a setting of the motion (see 'tandem scenes')")
        ->expected(1)
        ->take_all();
}

} // namespace

Action add_simulate(CLI::App& app) {
    auto given = std::make_shared<Given<SimulateOptions>>();
    auto& options = given->options;
    add_motion_options(app, options);
    app.add_option("--algorithm", options.request.algorithms, "that finds contacts; chunked when left out");
    app.add_option("--preset", options.request.presets, "of it (see 'tandem algorithms')");
    app.add_option("--device", options.request.devices, "where contacts are found; opencl:0 when left out");
    app.add_option(
           "--set", given->sets,
           "NAME=VALUE: a setting of the algorithm; contact_rule=sat and decision=recheck when left out")
        ->expected(1)
        ->take_all();
    app.add_option("--require", options.require, "devices or backends whose absence is a failure")
        ->delimiter(',');
    app.add_flag("--quiet", options.quiet, "no progress line");
    return [given] {
        given->options.request.sets = parse_sets(given->sets);
        return simulate_command(given->options);
    };
}

namespace {

/// Words of a setting as they stand in help and completion: "morton|sah".
std::string choices_of(const Parameter& parameter) {
    std::string text;
    for (const auto& word : parameter.choices()) text.append(text.empty() ? "" : "|").append(word.text);
    return text;
}

/// A file of the meshes' chunks, and what they are made by.
void add_chunk_options(CLI::App& app, ExportOptions& options) {
    app.add_option(
        "--chunks", options.chunks,
        "into this file as comma-separated values: the chunks of every mesh, a line a tetrahedron");
    app.add_option("--builder", options.builder, "order that chunks are cut of; morton when left out")
        ->option_text(choices_of(parameters::builder));
    app.add_option("--chunk-bytes", options.chunk_bytes,
                   "memory of a pair of chunks in the paper's equation (1); 8000 when left out")
        ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 30));
    app.add_option("--k", options.k, "planes of the k-DOPs in it; 8 when left out")
        ->option_text(choices_of(parameters::k));
}

} // namespace

Action add_export(CLI::App& app) {
    auto given = std::make_shared<ExportOptions>();
    auto& options = *given;
    app.add_option(
        "scene", options.scene,
        "NAME, NAME:par=value,..., a scene description or a recording; with --csv a file of records");
    app.add_option("--mesh", options.meshes, "a scene of mesh files instead")->expected(1)->take_all();
    app.add_option("--pose", options.poses, "\"tx ty tz qw qx qy qz\", one per --mesh, in order")
        ->expected(1)
        ->take_all();
    app.add_option("--frames", options.frames, "FIRST:LAST, both inclusive; all when left out");
    app.add_option("--every", options.every, "every so many of these frames only")
        ->check(CLI::Range(1, 1000000));
    app.add_option("--vtu", options.vtu, "into this folder for ParaView: tetrahedra of every frame");
    app.add_option("--glb", options.glb, "into this file for viewers: surfaces, moved by an animation");
    app.add_option(
        "--geometry", options.geometry,
        "into this file as JSON for pages: surfaces, poses, deformed vertices, about 4 MB at most");
    add_chunk_options(app, options);
    auto* contacts = app.add_flag("--contacts", options.contacts,
                                  "contacts of every frame, beside the .vtu or in the geometry");
    app.add_option("--device", options.device, "the device that finds them; host when left out")
        ->needs(contacts);
    const auto* csv =
        app.add_option("--csv", options.csv,
                       "records as comma-separated values: into this file, or printed when none is named")
            ->expected(0, 1);
    return [given, csv] {
        given->to_csv = csv->count() > 0;
        return export_command(*given);
    };
}

Action add_devices(CLI::App& app) {
    auto given = std::make_shared<DevicesOptions>();
    auto& options = *given;
    app.add_option("--require", options.require, "devices or backends whose absence is a failure")
        ->delimiter(',');
    auto* measure = app.add_flag("--measure", options.measure,
                                 "measure what each can do: bandwidths, launches, overlap tests");
    app.add_option("--device", options.devices, "measure D,E only")->delimiter(',')->needs(measure);
    app.add_option("--out", options.out, "append the measurements to this JSON-lines file")->needs(measure);
    app.add_flag("--json", options.json, "as JSON");
    return [given] { return devices_command(*given); };
}

Action add_scenes(CLI::App& app) {
    auto json = std::make_shared<bool>(false);
    app.add_flag("--json", *json, "as JSON");
    return [json] { return scenes_command(*json); };
}

Action add_algorithms(CLI::App& app) {
    auto given = std::make_shared<AlgorithmsOptions>();
    app.add_option("names", given->names, "explain these at length; list all in short when left out");
    app.add_flag("--json", given->json, "as JSON");
    return [given] { return algorithms_command(*given); };
}

} // namespace tandem
