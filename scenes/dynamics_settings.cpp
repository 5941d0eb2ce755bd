// SPDX-License-Identifier: MIT
#include "scenes/dynamics_settings.h"

#include "scenes/error.h"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <limits>

namespace tandem {

namespace {

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

/// What a setting of type T reads and writes of the member that `Get` returns.
template<auto Get, int least_exponent, int most_exponent>
DynamicsSetting real(std::string_view name, std::string_view help) {
    static constexpr auto power = [](int exponent) {
        double value = exponent < -300 ? 0.0 : 1.0;
        for (int i = 0; i < exponent; ++i) value *= 10;
        for (int i = 0; i > exponent && value > 0; --i) value /= 10;
        return value;
    };
    return {name, help, [](const Dynamics& d) { return fmt::format("{}", Get(const_cast<Dynamics&>(d))); },
            [](Dynamics& d, std::string_view own, std::string_view text) {
                Get(d) = number(own, text, power(least_exponent), power(most_exponent));
            }};
}

template<auto Get>
DynamicsSetting whole(std::string_view name, std::string_view help) {
    return {name, help, [](const Dynamics& d) { return fmt::format("{}", Get(const_cast<Dynamics&>(d))); },
            [](Dynamics& d, std::string_view own, std::string_view text) {
                Get(d) = number<std::size_t>(own, text, 0, 1000000);
            }};
}

template<auto Get>
DynamicsSetting toggle(std::string_view name, std::string_view help) {
    return {name, help,
            [](const Dynamics& d) { return std::string(Get(const_cast<Dynamics&>(d)) ? "1" : "0"); },
            [](Dynamics& d, std::string_view own, std::string_view text) { Get(d) = flag(own, text); }};
}

DynamicsSetting method() {
    return {"method", "of the contact solver: gauss_seidel, or jacobi on all cores",
            [](const Dynamics& d) {
                return std::string(d.solver.method == SolverSettings::Method::jacobi ? "jacobi"
                                                                                     : "gauss_seidel");
            },
            [](Dynamics& d, std::string_view, std::string_view text) {
                if (text != "jacobi" && text != "gauss_seidel")
                    throw InputError(
                        fmt::format("dynamics method={} is impossible; give gauss_seidel or jacobi", text));
                d.solver.method =
                    text == "jacobi" ? SolverSettings::Method::jacobi : SolverSettings::Method::gauss_seidel;
            }};
}

#define FIELD(path)                                                                                          \
    [](Dynamics & d) -> auto& { return d.path; }
constexpr int zero = -999;

} // namespace

std::span<const DynamicsSetting> dynamics_settings() {
    static const std::vector<DynamicsSetting> settings{
        real<FIELD(stepping.step), -9, 1>("step", "time step, s"),
        method(),
        whole<FIELD(solver.iterations)>("iterations", "of the contact solver, at most"),
        real<FIELD(solver.absolute_tolerance), zero, 9>("absolute_tolerance", "where it stops, N s"),
        real<FIELD(solver.relative_tolerance), zero, 0>("relative_tolerance",
                                                        "where it stops, relative change"),
        toggle<FIELD(solver.warm_start)>("warm_start",
                                         "start from the last step's forces at the same features"),
        toggle<FIELD(stepping.pre_stabilize)>("pre_stabilize", "velocities that lessen penetration"),
        toggle<FIELD(stepping.post_stabilize)>("post_stabilize", "positions corrected after the step"),
        toggle<FIELD(stepping.bounce)>("bounce", "Newton's restitution"),
        real<FIELD(stepping.linear_damping), zero, 6>("linear_damping", "1/s"),
        real<FIELD(stepping.angular_damping), zero, 6>("angular_damping", "1/s"),
        real<FIELD(stepping.adaptive_tolerance), zero, 6>("adaptive_tolerance",
                                                          "of deformables' steps, m; 0 keeps the step"),
        real<FIELD(stepping.least_step), -12, 1>("least_step", "of adaptive steps, s"),
        toggle<FIELD(stepping.couple_contacts)>("couple_contacts", "contacts push deformables"),
        real<FIELD(reduction.distance), zero, 0>("merge_distance", "contacts of a body pair closer than this "
                                                                   "times the smaller body's size are one"),
        whole<FIELD(reduction.per_pair)>("per_pair", "contacts of a body pair kept at most; 0: all"),
    };
    return settings;
}

void set_dynamics(Dynamics& dynamics, std::string_view assignment) {
    const auto equals = assignment.find('=');
    const auto name = assignment.substr(0, equals);
    std::vector<std::string> names;
    for (const auto& setting : dynamics_settings()) {
        names.emplace_back(setting.name);
        if (setting.name != name) continue;
        if (equals == std::string_view::npos)
            throw InputError(fmt::format("dynamics {} has no value; write {}=VALUE", name, name));
        setting.set(dynamics, name, assignment.substr(equals + 1));
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
