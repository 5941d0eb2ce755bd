// SPDX-License-Identifier: MIT
// report and view: pages for a browser.
#include "harness/command_line/actions.h"
#include "harness/commands.h"

#include <CLI/CLI.hpp>
#include <memory>

namespace tandem {

namespace {

/// Which frames of a scene, and whether contacts.
void add_scene_options(CLI::App& app, ViewOptions& options, CLI::Option* scene) {
    const auto with = [&](CLI::Option* option) {
        if (scene) option->needs(scene);
        return option;
    };
    with(app.add_option("--frames", options.frames, "FIRST:LAST, both inclusive; all when left out"));
    with(app.add_option("--every", options.every, "every so many of these frames only"))
        ->check(CLI::Range(1, 1000000));
    auto* contacts =
        with(app.add_flag("--contacts", options.contacts, "contacts of every frame, with normals"));
    app.add_option("--device", options.device, "the device that finds them; host when left out")
        ->needs(contacts);
}

} // namespace

Action add_report(CLI::App& app) {
    auto given = std::make_shared<ReportOptions>();
    auto& options = *given;
    app.add_option("files", options.files, "records of cells, profiles, simulations or ceilings (.jsonl)")
        ->required();
    app.add_option("-o,--output", options.output, "the page; report.html when left out");
    app.add_option(
        "--against", options.against,
        "OLD.jsonl or OLD.jsonl@COMMIT: show by how much the one FILE differs, as 'tandem compare' does");
    auto* scene = app.add_option("--scene", options.scene.scene, "show this scene or recording as well");
    add_scene_options(app, options.scene, scene);
    return [given] { return report_command(*given); };
}

Action add_view(CLI::App& app) {
    auto given = std::make_shared<ViewOptions>();
    auto& options = *given;
    app.add_option("scene", options.scene,
                   "NAME, NAME:par=value,..., a scene description (.json) or a recording (.frames)");
    app.add_option("--mesh", options.meshes, "a scene of mesh files instead")->expected(1)->take_all();
    app.add_option("--pose", options.poses, "\"tx ty tz qw qx qy qz\", one per --mesh, in order")
        ->expected(1)
        ->take_all();
    app.add_option("-o,--output", options.output, "the page; named after the scene when left out");
    add_scene_options(app, options, nullptr);
    return [given] { return view_command(*given); };
}

} // namespace tandem
