// SPDX-License-Identifier: MIT
// report, view and convert, which are written in Python.
#include "harness/commands/options/external_options.h"
#include "harness/commands/options/reading.h"

#include <CLI/CLI.hpp>

namespace tandem {

namespace {

/// The frames of a scene to show, and whether to show contacts.
void add_scene_options(CLI::App& app, CLI::Option* scene) {
    const auto with = [&](CLI::Option* option) {
        if (scene) option->needs(scene);
        return option;
    };
    with(add_external_option(app, "--frames", "FIRST:LAST, both inclusive (default: all)"));
    with(add_external_option(app, "--every", "show every Nth of these frames only (default: 1)"))
        ->check(CLI::Range(1, 1000000));
    for (auto* option : add_external_reading_options(app)) with(option);
    auto* contacts = with(add_external_flag(app, "--contacts", "show contacts and normals in every frame"));
    add_external_option(app, "--device", "the device that finds contacts (default: host)")->needs(contacts);
}

} // namespace

Action add_report(CLI::App& app) {
    add_external_option(app, "files",
                        "records of cells, profiles, simulations or ceilings (.jsonl, .jsonl.xz)")
        ->expected(CLI::detail::expected_max_vector_size)
        ->required();
    add_external_option(app, "-o,--output", "the HTML file to write (default: report.html)");
    add_external_option(
        app, "--against",
        "OLD.jsonl or OLD.jsonl@COMMIT: compare the one FILE with it, as 'tandem compare' does");
    add_external_flag(app, "--sentences",
                      "also print the page's sentences: the fastest cell of each comparison");
    add_scene_options(app, add_external_option(app, "--scene", "also show this scene or recording"));
    return run_external_action(app);
}

Action add_view(CLI::App& app) {
    add_external_option(app, "scene",
                        "NAME, NAME:par=value,..., a scene description (.json) or a recording (.frames)");
    add_external_option(app, "--mesh", "a mesh file of the scene, instead of SCENE; may be repeated")
        ->take_all();
    add_external_option(app, "--pose",
                        "\"tx ty tz qw qx qy qz\", one per --mesh, in order (default: identity)")
        ->take_all();
    add_external_option(app, "-o,--output", "the HTML file to write (default: named after the scene)");
    add_scene_options(app, nullptr);
    return run_external_action(app);
}

Action add_convert(CLI::App& app) {
    add_external_option(app, "file", "a mesh file that meshio reads, or a .tet file")->required();
    add_external_option(app, "-o,--output", "the .vtu file to write")->required();
    return run_external_action(app);
}

} // namespace tandem
