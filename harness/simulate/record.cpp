// SPDX-License-Identifier: MIT
#include "base/counted.h"
#include "harness/record/record.h"
#include "harness/simulate/simulate.h"
#include "harness/simulate/session.h"
#include "base/statistics.h"
#include "scenes/dynamics_settings.h"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace tandem {

namespace {

using Json = nlohmann::ordered_json;

std::int64_t device_ns(const ContactSearch& search, Stage stage) {
    return search.stages[static_cast<std::size_t>(stage)].device_ns;
}

/// The initialization of the paper's Table 3: transform and refit.
std::int64_t initialize_ns(const ContactSearch& search) {
    return device_ns(search, Stage::transform) + device_ns(search, Stage::refit);
}

/// Leaves out unused stages to keep the lines short, because there is one line for each step.
Json stages_json(const StageSamples& stages) {
    auto json = Json::object();
    for (std::size_t i = 0; i < stages.size(); ++i) {
        const auto& s = stages[i];
        if (s.host_ns == 0 && s.device_ns == 0 && s.launches == 0) continue;
        json[std::string(stage_names[i])] = {{"device_ns", s.device_ns},
                                             {"host_ns", s.host_ns},
                                             {"launches", s.launches},
                                             {"waits", s.waits},
                                             {"bytes", s.bytes}};
    }
    return json;
}

Json energies_json(const StepReport& report) {
    return {{"kinetic", report.kinetic}, {"potential", report.potential}, {"elastic", report.elastic}};
}

double median_or_0(const std::vector<std::size_t>& values) { return values.empty() ? 0 : median(values); }

/// The settings of a simulation by name.
Json dynamics_json(const Dynamics& dynamics) {
    auto json = Json::object();
    for (const auto& setting : dynamics_settings()) json[std::string(setting.name)] = setting.value(dynamics);
    return json;
}

} // namespace

void RunTotals::add(const StepReport& report, const ContactSearch& search, std::int64_t wall) {
    if (steps++ == 0) first = report.step;
    wall_ns += wall;
    initialize_ns += tandem::initialize_ns(search);
    broad_ns += search.broad_ns;
    narrow_ns += search.narrow_ns;
    reduce_ns += report.reduce_ns;
    assemble_ns += report.assemble_ns;
    solve_ns += report.solve_ns;
    move_ns += report.move_ns;
    found.push_back(report.found);
    kept.push_back(report.kept);
    deepest = std::max(deepest, report.deepest);
    if (!report.converged && (not_converged++ == 0 || report.residual > worst.residual)) worst = report;
    last = report;
}

Json step_record(const StepReport& report, const ContactSearch& search, std::int64_t wall_ns,
                 std::uint64_t session) {
    return {{"schema", 3},
            {"kind", "step"},
            {"session", session_name(session)},
            {"step", report.step},
            {"time_s", report.time},
            {"length_s", report.length},
            {"body_pairs", search.body_pairs},
            {"candidate_pairs", search.candidate_pairs},
            {"contacts_found", report.found},
            {"contacts_kept", report.kept},
            {"deepest_m", report.deepest},
            {"energy_j", energies_json(report)},
            {"energy_change_j", report.energy_change},
            {"lifted_j", report.lifted},
            {"iterations", report.iterations},
            {"residual", report.residual},
            {"tolerance", report.tolerance},
            {"converged", report.converged},
            {"inverted", report.inverted},
            {"host_ns",
             {{"step", wall_ns},
              {"broad", search.broad_ns},
              {"narrow", search.narrow_ns},
              {"reduce", report.reduce_ns},
              {"assemble", report.assemble_ns},
              {"solve", report.solve_ns},
              {"move", report.move_ns}}},
            {"stages", stages_json(search.stages)}};
}

Json run_record(const Cell& cell, const Scene& scene, const RunTotals& t, const std::string& failure) {
    Json json{{"schema", 3},
              {"kind", "run"},
              {"session", session_name(t.session)},
              {"status", failure.empty() ? "ok" : "failed"},
              {"failure", failure.empty() ? Json(nullptr) : Json(failure)},
              {"scene", record_scene(scene)},
              {"dynamics", dynamics_json(*scene.dynamics)},
              {"algorithm", cell.algorithm->name()},
              {"preset", cell.preset},
              {"settings", cell.settings.texts()},
              {"devices", record_devices(cell.devices)},
              {"first_step", t.first},
              {"steps", t.steps}};
    json["contacts_found_median"] = median_or_0(t.found);
    json["contacts_kept_median"] = median_or_0(t.kept);
    json["deepest_m"] = t.deepest;
    json["energy_j"] = energies_json(t.last);
    json["steps_not_converged"] = t.not_converged;
    json["worst_residual"] = t.not_converged == 0 ? Json(nullptr) : Json(t.worst.residual);
    json["host_ns"] = {{"total", t.wall_ns},    {"broad", t.broad_ns},       {"narrow", t.narrow_ns},
                       {"reduce", t.reduce_ns}, {"assemble", t.assemble_ns}, {"solve", t.solve_ns},
                       {"move", t.move_ns}};
    json["initialize_device_ns"] = t.initialize_ns;
    json["warm_up_ns"] = t.warm_up_ns;
    json["environment"] = record_environment();
    return json;
}

/// Without device times, initialization is part of the row of the narrow phase and has no row of its own.
std::string run_table(const RunTotals& t, bool timed) {
    const auto other =
        t.wall_ns - t.broad_ns - t.narrow_ns - t.reduce_ns - t.assemble_ns - t.solve_ns - t.move_ns;
    const std::pair<const char*, std::int64_t> rows[] = {
        {"initialization (transform, refit)", t.initialize_ns},
        {"broad phase", t.broad_ns},
        {timed ? "narrow phase without initialization" : "initialization and narrow phase",
         t.narrow_ns - t.initialize_ns},
        {"contact reduction", t.reduce_ns},
        {"assembly", t.assemble_ns},
        {"solver", t.solve_ns},
        {"motion", t.move_ns},
        {"other", other}};
    auto text = fmt::format("{} in {:.3f} s, after {:.3f} s of warm-up\n", counted(t.steps, "step"),
                            static_cast<double>(t.wall_ns) * 1e-9, static_cast<double>(t.warm_up_ns) * 1e-9);
    for (const auto& [name, ns] : std::span(rows).subspan(timed ? 0 : 1))
        text += fmt::format("  {:<36} {:>10.3f} s {:>6.2f} %\n", name, static_cast<double>(ns) * 1e-9,
                            t.wall_ns == 0 ? 0.0
                                           : 100 * static_cast<double>(ns) / static_cast<double>(t.wall_ns));
    text += fmt::format("contacts a step, median: {:.0f} found, {:.0f} kept; deepest penetration {:.3g} m\n",
                        median_or_0(t.found), median_or_0(t.kept), t.deepest);
    return text
           + fmt::format("energy at the end: kinetic {:.6g} J, potential {:.6g} J, elastic {:.6g} J\n",
                         t.last.kinetic, t.last.potential, t.last.elastic);
}

} // namespace tandem
