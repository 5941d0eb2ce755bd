// SPDX-License-Identifier: MIT
// report and view: pages for a browser, made by the package python/tandem/report.
#include "harness/commands/options/external_options.h"

#include <CLI/CLI.hpp>

namespace tandem {

namespace {

/// Which frames of a scene, and whether contacts.
void add_scene_options(CLI::App& app, CLI::Option* scene) {
    const auto with = [&](CLI::Option* option) {
        if (scene) option->needs(scene);
        return option;
    };
    with(add_external_option(app, "--frames", "FIRST:LAST, both inclusive; all when left out"));
    with(add_external_option(app, "--every", "every so many of these frames only"))
        ->check(CLI::Range(1, 1000000));
    auto* contacts = with(add_external_flag(app, "--contacts", "contacts of every frame, with normals"));
    add_external_option(app, "--device", "the device that finds them; host when left out")->needs(contacts);
}

} // namespace

Action add_report(CLI::App& app) {
    add_external_option(app, "files",
                        "records of cells, profiles, simulations or ceilings (.jsonl, .jsonl.xz)")
        ->expected(CLI::detail::expected_max_vector_size)
        ->required();
    add_external_option(app, "-o,--output", "the page; report.html when left out");
    add_external_option(
        app, "--against",
        "OLD.jsonl or OLD.jsonl@COMMIT: show by how much the one FILE differs, as 'tandem compare' does");
    add_scene_options(app, add_external_option(app, "--scene", "show this scene or recording as well"));
    return run_external_action(app);
}

Action add_view(CLI::App& app) {
    add_external_option(app, "scene",
                        "NAME, NAME:par=value,..., a scene description (.json) or a recording (.frames)");
    add_external_option(app, "--mesh", "a scene of mesh files instead")->take_all();
    add_external_option(app, "--pose", "\"tx ty tz qw qx qy qz\", one per --mesh, in order")->take_all();
    add_external_option(app, "-o,--output", "the page; named after the scene when left out");
    add_scene_options(app, nullptr);
    return run_external_action(app);
}

} // namespace tandem
