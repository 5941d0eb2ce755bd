// SPDX-License-Identifier: MIT
#include "harness/commands/options/reading.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace tandem {

namespace {

constexpr auto duplicates_help =
    "tetrahedra with the four vertices of an earlier one: merge (they keep their numbers and take no part), "
    "keep (they take part) or reject (default: merge)";
constexpr auto weld_help =
    "vertices at most this far apart count as one for boundary faces, duplicates and setting self; "
    "coordinates stay (default: no welding)";
constexpr auto pressure_help = "give meshes without a pressure field one: MODULUS times the distance from "
                               "the boundary, over the largest "
                               "such distance (default: they have none)";
constexpr auto corners_help = "read tetrahedra of higher order by their corners (default: refuse them)";
constexpr auto only_help = "leave out volume cells that are not tetrahedra (default: refuse them)";

std::string duplicates_choices() { return fmt::format("{}", fmt::join(duplicates_names, "|")); }

} // namespace

void add_mesh_options(CLI::App& app, std::vector<std::string>& meshes, std::vector<std::string>& poses) {
    app.add_option("--mesh", meshes, "a mesh file of the scene, instead of SCENE; may be repeated")
        ->expected(1)
        ->take_all()
        ->option_text("FILE");
    app.add_option("--pose", poses,
                   "\"tx ty tz qw qx qy qz\", one for each --mesh, in order (default: identity)")
        ->expected(1)
        ->take_all()
        ->option_text("POSE");
}

void add_reading_options(CLI::App& app, MeshReading& reading) {
    app.add_option_function<std::string>(
           "--duplicates",
           [&reading](const std::string& text) {
               reading.duplicates = duplicates_named(text, "--duplicates");
           },
           duplicates_help)
        ->option_text(duplicates_choices());
    app.add_option_function<double>(
           "--weld", [&reading](double tolerance) { reading.weld = checked_weld(tolerance, "--weld"); },
           weld_help)
        ->option_text("TOLERANCE");
    app.add_option_function<double>(
           "--pressure",
           [&reading](double modulus) { reading.pressure = checked_pressure(modulus, "--pressure"); },
           pressure_help)
        ->option_text("MODULUS");
    app.add_flag("--corners", reading.corners, corners_help);
    app.add_flag("--only-tetrahedra", reading.only_tetrahedra, only_help);
}

} // namespace tandem
