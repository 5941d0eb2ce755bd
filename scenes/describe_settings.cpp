// SPDX-License-Identifier: MIT
#include "scenes/describe_settings.h"

namespace tandem::description {

namespace {

/// Reads a number over its default.
void read_over(double& value, const Json& json, const char* name, const Place& place, double least = 0) {
    if (json.contains(name)) value = number(json[name], place / name, least, largest);
}

void read_over(std::size_t& value, const Json& json, const char* name, const Place& place, double least) {
    if (json.contains(name))
        value = static_cast<std::size_t>(whole(json[name], place / name, least, largest));
}

void read_over(bool& value, const Json& json, const char* name, const Place& place) {
    if (json.contains(name)) value = flag(json, name, place);
}

void read_solver(const Json& json, const Place& place, SolverSettings& solver) {
    check_names(json, place,
                {"method", "iterations", "absolute_tolerance", "relative_tolerance", "warm_start"});
    if (json.contains("method"))
        solver.method = static_cast<SolverSettings::Method>(
            choice(json["method"], place / "method", "method", {"gauss_seidel", "jacobi"}));
    read_over(solver.iterations, json, "iterations", place, 1);
    read_over(solver.absolute_tolerance, json, "absolute_tolerance", place);
    read_over(solver.relative_tolerance, json, "relative_tolerance", place);
    read_over(solver.warm_start, json, "warm_start", place);
}

void read_stepping(const Json& json, const Place& place, StepSettings& stepping) {
    check_names(json, place,
                {"pre_stabilize", "post_stabilize", "bounce", "linear_damping", "angular_damping",
                 "adaptive_tolerance", "least_step", "couple_contacts"});
    read_over(stepping.pre_stabilize, json, "pre_stabilize", place);
    read_over(stepping.post_stabilize, json, "post_stabilize", place);
    read_over(stepping.bounce, json, "bounce", place);
    read_over(stepping.linear_damping, json, "linear_damping", place);
    read_over(stepping.angular_damping, json, "angular_damping", place);
    read_over(stepping.adaptive_tolerance, json, "adaptive_tolerance", place);
    if (json.contains("least_step")) stepping.least_step = positive(json["least_step"], place / "least_step");
    read_over(stepping.couple_contacts, json, "couple_contacts", place);
}

void read_reduction(const Json& json, const Place& place, ReductionSettings& reduction) {
    check_names(json, place, {"distance", "per_pair"});
    read_over(reduction.distance, json, "distance", place);
    read_over(reduction.per_pair, json, "per_pair", place, 0);
}

} // namespace

void read_settings(const Json& json, const Place& place, Dynamics& dynamics) {
    if (json.contains("gravity")) dynamics.gravity = vector(json["gravity"], place / "gravity");
    if (json.contains("stepping")) read_stepping(json["stepping"], place / "stepping", dynamics.stepping);
    if (json.contains("step")) dynamics.stepping.step = positive(json["step"], place / "step");
    read_over(dynamics.steps, json, "steps", place, 1);
    if (json.contains("solver")) read_solver(json["solver"], place / "solver", dynamics.solver);
    if (json.contains("reduction"))
        read_reduction(json["reduction"], place / "reduction", dynamics.reduction);
}

} // namespace tandem::description
