// SPDX-License-Identifier: MIT
#include "scenes/dynamics_settings.h"

#include "base/error.h"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <limits>

namespace tandem {

namespace {

/// Parses the whole text independently of the locale; NaN is outside every range.
template<class Number>
Number number(std::string_view name, std::string_view text, Number least, Number most) {
    Number value{};
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec != std::errc{} || result.ptr != text.data() + text.size()
        || !(value >= least && value <= most))
        throw InputError(fmt::format("dynamics {}={} is impossible; give a number from {} to {}", name, text,
                                     least, most));
    return value;
}

bool flag(std::string_view name, std::string_view text) {
    if (text != "0" && text != "1")
        throw InputError(fmt::format("dynamics {}={} is impossible; give 0 or 1", name, text));
    return text == "1";
}

// `field` is a function that returns a reference to the setting's member in (const) dynamics.

template<class Field>
DynamicsSetting real(std::string_view name, Field field, double least, double most, std::string_view help) {
    return {name,
            help,
            DynamicsSetting::Kind::real,
            least,
            most,
            {},
            [=](const Dynamics& d) { return fmt::format("{}", field(d)); },
            [=](Dynamics& d, std::string_view text) { field(d) = number(name, text, least, most); }};
}

template<class Field>
DynamicsSetting whole(std::string_view name, Field field, std::size_t least, std::string_view help) {
    constexpr std::size_t most = 1000000000;
    return {name,
            help,
            DynamicsSetting::Kind::whole,
            static_cast<double>(least),
            static_cast<double>(most),
            {},
            [=](const Dynamics& d) { return fmt::format("{}", field(d)); },
            [=](Dynamics& d, std::string_view text) { field(d) = number(name, text, least, most); }};
}

template<class Field>
DynamicsSetting toggle(std::string_view name, Field field, std::string_view help) {
    return {name,
            help,
            DynamicsSetting::Kind::toggle,
            0,
            1,
            {},
            [=](const Dynamics& d) { return std::string(field(d) ? "1" : "0"); },
            [=](Dynamics& d, std::string_view text) { field(d) = flag(name, text); }};
}

DynamicsSetting method() {
    using Method = SolverSettings::Method;
    const auto value = [](const Dynamics& d) {
        return std::string(d.solver.method == Method::jacobi ? "jacobi" : "gauss_seidel");
    };
    const auto set = [](Dynamics& d, std::string_view text) {
        if (text != "jacobi" && text != "gauss_seidel")
            throw InputError(
                fmt::format("dynamics method={} is impossible; give gauss_seidel or jacobi", text));
        d.solver.method = text == "jacobi" ? Method::jacobi : Method::gauss_seidel;
    };
    return {"method",
            "contact solver: gauss_seidel, or jacobi on all cores",
            DynamicsSetting::Kind::word,
            0,
            0,
            {"gauss_seidel", "jacobi"},
            value,
            set};
}

/// Returns a function to a member of a member of (const) dynamics.
template<class Part, class Value>
auto at(Part Dynamics::*part, Value Part::*value) {
    return [=](auto& dynamics) -> auto& { return dynamics.*part.*value; };
}

std::vector<DynamicsSetting> make_settings() {
    return {
        real("step", at(&Dynamics::stepping, &StepSettings::step), 1e-9, 10, "time step, s"),
        method(),
        whole("iterations", at(&Dynamics::solver, &SolverSettings::iterations), 1,
              "maximum iterations of the contact solver"),
        real("absolute_tolerance", at(&Dynamics::solver, &SolverSettings::absolute_tolerance), 0, 1e9,
             "where the solver stops, N s; 0: 1e-5 of the lightest body's weight times the step"),
        real("relative_tolerance", at(&Dynamics::solver, &SolverSettings::relative_tolerance), 0, 1,
             "where the solver stops, relative change; 0: never"),
        toggle("warm_start", at(&Dynamics::solver, &SolverSettings::warm_start),
               "start from the last step's forces at equal features"),
        toggle("pre_stabilize", at(&Dynamics::stepping, &StepSettings::pre_stabilize),
               "add velocities that reduce penetration"),
        toggle("post_stabilize", at(&Dynamics::stepping, &StepSettings::post_stabilize),
               "correct positions after the step"),
        toggle("bounce", at(&Dynamics::stepping, &StepSettings::bounce), "Newton's restitution"),
        toggle("bound_energy", at(&Dynamics::stepping, &StepSettings::bound_energy),
               "repeat a step without bounces when they would add energy"),
        toggle("surface_normals", at(&Dynamics::stepping, &StepSettings::surface_normals),
               "replace contact normals that no nearby surface has"),
        real("contact_layer", at(&Dynamics::stepping, &StepSettings::contact_layer), 0, 0.1,
             "depth to which resting bodies penetrate, times the smaller body's size"),
        real("linear_damping", at(&Dynamics::stepping, &StepSettings::linear_damping), 0, 1e6,
             "linear damping of rigid bodies, 1/s"),
        real("angular_damping", at(&Dynamics::stepping, &StepSettings::angular_damping), 0, 1e6,
             "angular damping of rigid bodies, 1/s"),
        real("adaptive_tolerance", at(&Dynamics::stepping, &StepSettings::adaptive_tolerance), 0, 1e6,
             "error limit of deformables' steps, m; 0 keeps the step"),
        real("least_step", at(&Dynamics::stepping, &StepSettings::least_step), 1e-12, 10,
             "shortest adaptive step, s"),
        toggle("couple_contacts", at(&Dynamics::stepping, &StepSettings::couple_contacts),
               "contacts exert forces on deformables"),
        real("merge_distance", at(&Dynamics::reduction, &ReductionSettings::distance), 0, 1,
             "contacts of a body pair closer than this times the smaller body's size are merged"),
        whole("per_pair", at(&Dynamics::reduction, &ReductionSettings::per_pair), 0,
              "maximum contacts kept of a body pair; 0: all"),
    };
}

} // namespace

std::span<const DynamicsSetting> dynamics_settings() {
    static const auto settings = make_settings();
    return settings;
}

/// The values of the configurations in the paper's release, for all scenes that it has.
std::span<const DynamicsPreset> dynamics_presets() {
    static const std::vector<DynamicsPreset> presets{
        {"paper",
         "the paper's solver: at most 150 iterations, tolerances of 0.01, no warm start, no corrections, "
         "only equal contacts merged",
         {"step=0.01", "method=gauss_seidel", "iterations=150", "absolute_tolerance=0.01",
          "relative_tolerance=0.01", "warm_start=0", "pre_stabilize=0", "post_stabilize=0", "bounce=1",
          "bound_energy=0", "surface_normals=0", "contact_layer=0", "linear_damping=0.01",
          "angular_damping=0.01", "merge_distance=1e-6", "per_pair=0"}}};
    return presets;
}

void set_dynamics(Dynamics& dynamics, std::string_view assignment) {
    const auto equals = assignment.find('=');
    const auto name = assignment.substr(0, equals);
    std::vector<std::string> names;
    if (equals == std::string_view::npos)
        for (const auto& preset : dynamics_presets()) {
            names.emplace_back(preset.name);
            if (preset.name != name) continue;
            for (const auto& each : preset.assignments) set_dynamics(dynamics, each);
            return;
        }
    for (const auto& setting : dynamics_settings()) {
        names.emplace_back(setting.name);
        if (setting.name != name) continue;
        if (equals == std::string_view::npos)
            throw InputError(fmt::format("dynamics {} has no value; write {}=VALUE", name, name));
        setting.set(dynamics, assignment.substr(equals + 1));
        return;
    }
    throw InputError(unknown("setting of dynamics", name, names));
}

std::string describe(const Dynamics& dynamics) {
    std::string text;
    for (const auto& setting : dynamics_settings())
        text += fmt::format("{}{}={}", text.empty() ? "" : ",", setting.name, setting.value(dynamics));
    return text;
}

} // namespace tandem
