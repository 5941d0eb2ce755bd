// SPDX-License-Identifier: MIT
// simulate and export, and the listings of devices, scenes and algorithms.
#include "algorithms/parameters/table.h"
#include "harness/plans/device_groups.h"
#include "harness/commands/options/actions.h"
#include "harness/commands/options/option_groups.h"
#include "harness/commands/options/reading.h"
#include "harness/commands/options/sets.h"
#include "harness/commands/export.h"
#include "harness/commands/listings.h"
#include "harness/simulate/command.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <memory>

namespace tandem {

namespace {

/// The scene to simulate, the number of steps and the outputs.
void add_motion_options(CLI::App& app, SimulateOptions& options) {
    app.add_option("scene", options.scene,
                   "NAME, NAME:par=value,... or a scene description with dynamics (.json)");
    app.option_defaults()->group(option_groups::motion);
    app.add_option("--steps", options.steps, "total number of steps (default: the scene's own number)")
        ->check(CLI::Range(std::size_t{1}, std::size_t{100000000}))
        ->option_text("N");
    app.add_option("--dynamics", options.dynamics,
                   "a setting of the motion (see 'tandem scenes'), or a preset of them (paper); may be "
                   "repeated")
        ->expected(1)
        ->take_all()
        ->option_text("NAME=VALUE");
    add_reading_options(app, options.reading);
    app.option_defaults()->group(option_groups::output);
    app.add_option("-o,--output", options.recording, "record the frames in this file, FILE.frames")
        ->option_text("FILE");
    app.add_option("--record", options.record,
                   "append one line with times for each step, and one for the run, to this JSON-lines file; "
                   "--resume repeats no line")
        ->option_text("FILE");
    app.add_flag("--resume", options.resume, "continue the recording from its last checkpoint");
    app.add_option("--checkpoint", options.every, "number of steps between checkpoints (default: 10)")
        ->check(CLI::Range(std::size_t{1}, std::size_t{100000000}))
        ->option_text("N");
    app.add_option("--pictures", options.pictures,
                   "draw the first, middle and last recorded frame as OUT-0.png, OUT-1.png, OUT-2.png")
        ->option_text("OUT");
    app.add_flag("--quiet", options.quiet, "print no progress");
}

} // namespace

Action add_simulate(CLI::App& app) {
    auto given = std::make_shared<SimulateOptions>();
    auto& options = *given;
    add_motion_options(app, options);
    app.option_defaults()->group(option_groups::motion);
    app.add_option("--algorithm", options.request.algorithms,
                   "the algorithm that finds contacts (default: tiled)")
        ->option_text("NAME");
    app.add_option("--preset", options.request.presets,
                   "a preset of the algorithm (see 'tandem algorithms'; default: its first)")
        ->option_text("NAME");
    add_set_option(app, options.request,
                   "a setting of the algorithm (see 'tandem help settings'; default: contact_rule=sat, "
                   "decision=recheck)");
    app.get_option("--set")->option_text("NAME=VALUE");
    app.option_defaults()->group(option_groups::machine);
    app.add_option("--device", options.request.devices,
                   fmt::format("the device that finds contacts (default: {})", default_device_help))
        ->option_text("DEVICE");
    app.add_option("--require", options.require, "devices or backends whose absence is an error")
        ->delimiter(',')
        ->option_text("DEVICE,...");
    app.footer("tandem simulate arch -o arch.frames\n"
               "tandem simulate arch -o arch.frames --steps 400 --resume");
    return [given] { return simulate_command(*given); };
}

namespace {

/// The choices of a setting for help and completion: "morton|sah".
std::string choices_of(const Parameter& parameter) {
    std::string text;
    for (const auto& word : parameter.choices()) text.append(text.empty() ? "" : "|").append(word.text);
    return text;
}

/// The output file for chunks, and the settings that build them.
void add_chunk_options(CLI::App& app, ExportOptions& options) {
    app.add_option("--chunks", options.chunks,
                   "write the chunks of every mesh to this CSV file, one line for each tetrahedron")
        ->option_text("FILE");
    app.add_option("--builder", options.builder,
                   "order of the tetrahedra that is cut into chunks (default: morton)")
        ->option_text(choices_of(parameters::builder));
    app.add_option("--chunk-bytes", options.chunk_bytes,
                   "bytes of memory for a pair of chunks in the paper's equation (1) (default: 8000)")
        ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 30))
        ->option_text("N");
    app.add_option("--k", options.k, "number of k-DOP planes in that equation (default: 8)")
        ->option_text(choices_of(parameters::k));
}

/// The scene, its frames, and what to find in them.
void add_exported(CLI::App& app, ExportOptions& options) {
    app.option_defaults()->group(option_groups::exported);
    add_mesh_options(app, options.meshes, options.poses);
    app.add_option("--frames", options.frames, "FIRST:LAST, both inclusive (default: all)")
        ->option_text("FIRST:LAST");
    app.add_option("--every", options.every, "export every Nth of these frames only (default: 1)")
        ->check(CLI::Range(1, 1000000))
        ->option_text("N");
    app.add_flag("--contacts", options.contacts,
                 "also write the contacts of every frame, with --vtu or --geometry");
    app.add_flag("--surfaces", options.surfaces,
                 "also write the contact surfaces of every frame, coloured by pressure; bodies need pressure "
                 "fields (--pressure)");
    add_reading_options(app, options.reading);
}

} // namespace

Action add_export(CLI::App& app) {
    auto given = std::make_shared<ExportOptions>();
    auto& options = *given;
    app.add_option(
        "scene", options.scene,
        "NAME, NAME:par=value,..., a scene description or a recording; with --csv a file of records");
    add_exported(app, options);
    app.option_defaults()->group(option_groups::output);
    app.add_option("--vtu", options.vtu, "write the tetrahedra of every frame to this folder, for ParaView")
        ->option_text("FOLDER");
    app.add_option("--glb", options.glb, "write animated surfaces to this file, for 3D viewers")
        ->option_text("FILE");
    app.add_option("--geometry", options.geometry,
                   "write surfaces, poses and deformed vertices to this JSON file, for HTML pages; about 4 "
                   "MB at most")
        ->option_text("FILE");
    const auto* csv =
        app.add_option("--csv", options.csv,
                       "write records as a CSV table to this file, or to standard output without a file; "
                       "texts like formulas get an apostrophe")
            ->expected(0, 1)
            ->option_text("FILE");
    add_chunk_options(app, options);
    app.option_defaults()->group(option_groups::machine);
    app.add_option(
           "--device", options.device,
           fmt::format("the device that finds contacts and surfaces (default: {})", default_device_help))
        ->option_text("DEVICE");
    app.footer("tandem export pile --frames 0:29 --vtu pile --contacts\n"
               "tandem export records.jsonl --csv records.csv");
    return [given, csv] {
        given->to_csv = csv->count() > 0;
        return export_command(*given);
    };
}

Action add_devices(CLI::App& app) {
    auto given = std::make_shared<DevicesOptions>();
    auto& options = *given;
    app.add_option("--require", options.require, "devices or backends whose absence is an error")
        ->delimiter(',')
        ->option_text("DEVICE,...");
    auto* measure = app.add_flag("--measure", options.measure,
                                 "measure the ceilings of each device: bandwidths, launches, overlap tests");
    app.add_option("--device", options.devices, "measure only these devices (default: all)")
        ->delimiter(',')
        ->needs(measure)
        ->option_text("DEVICE,...");
    app.add_option("--out", options.out, "append the measurements to this JSON-lines file")
        ->needs(measure)
        ->option_text("FILE");
    app.add_flag("--json", options.json, "print JSON");
    app.footer("tandem devices --measure --device host");
    return [given] { return devices_command(*given); };
}

Action add_scenes(CLI::App& app) {
    auto json = std::make_shared<bool>(false);
    app.add_flag("--json", *json, "print JSON");
    app.footer("tandem scenes --json");
    return [json] { return scenes_command(*json); };
}

Action add_algorithms(CLI::App& app) {
    auto given = std::make_shared<AlgorithmsOptions>();
    app.add_option("names", given->names, "explain these algorithms at length (default: list all in short)")
        ->option_text("NAME...");
    app.add_flag("--json", given->json, "print JSON");
    app.footer("tandem algorithms tiled");
    return [given] { return algorithms_command(*given); };
}

} // namespace tandem
