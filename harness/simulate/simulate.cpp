// SPDX-License-Identifier: MIT
#include "harness/simulate/simulate.h"

#include "base/counted.h"
#include "harness/simulate/command.h"
#include "harness/plans/inputs.h"
#include "harness/program/environment.h"
#include "harness/record/journal.h"
#include "harness/program/interrupt.h"
#include "base/memory_reserve.h"
#include "harness/simulate/pictures.h"
#include "base/progress.h"
#include "harness/simulate/session.h"
#include "base/standard_streams.h"
#include "scenes/dynamics_settings.h"
#include "base/error.h"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

namespace tandem {

namespace {

using Clock = std::chrono::steady_clock;

/// The first replay compiles kernels, uploads static data and grows buffers. The second runs the command
/// sequence of all later frames. The third captures it as a graph, on devices with graphs.
constexpr int warming_replays = 3;

/// Opens a scene with dynamics and applies the settings of --dynamics.
Scene open_scene(const SimulateOptions& options) {
    if (options.scene.empty()) throw InputError("no scene; name one, see 'tandem scenes'");
    auto scene = make_scene(options.scene, options.reading);
    if (!scene.dynamics)
        throw InputError(fmt::format("scene {} has no dynamics, its motion is scripted; measure it with "
                                     "'tandem run'",
                                     scene.key));
    auto dynamics = *scene.dynamics;
    for (const auto& assignment : options.dynamics) set_dynamics(dynamics, assignment);
    scene.dynamics = std::make_shared<const Dynamics>(std::move(dynamics));
    return scene;
}

/// Chooses contact settings for a simulation, unless the user set them: the least translation (sat), for
/// pairs that certainly overlap. The default of measurements is the paper's rule, which pushes touching
/// bodies metres sideways.
void prefer_certain_contacts(Request& request, std::span<const DeviceGroup> devices) {
    const auto prefer = [&](const char* name, const char* value) {
        const auto given = std::any_of(request.sets.begin(), request.sets.end(),
                                       [&](const auto& set) { return set.first == name; });
        if (!given) request.sets.push_back({name, {value}});
    };
    prefer("contact_rule", "sat");
    const auto have_double = [](const DeviceGroup& group) {
        return std::all_of(group.begin(), group.end(),
                           [](const auto* device) { return device->info().has_double; });
    };
    if (std::all_of(devices.begin(), devices.end(), have_double)) prefer("decision", "recheck");
}

Request contacts_request(const SimulateOptions& options) {
    auto request = options.request;
    if (request.algorithms.empty()) request.algorithms = {std::string(algorithms().front()->name())};
    if (request.devices.empty()) request.devices = {default_device};
    return request;
}

/// The one cell that finds contacts. Throws InputError when the request has several cells, or a cell without
/// contacts.
Cell only_cell(Request request, const std::vector<BackendReport>& backends) {
    const auto devices = choose_devices(backends, request.devices);
    prefer_certain_contacts(request, devices);
    const auto cells = plan(request, devices);
    if (cells.size() != 1)
        throw InputError(fmt::format("a simulation needs one algorithm, preset, device and value of each "
                                     "setting; this asks for {}",
                                     counted(cells.size(), "cell")));
    if (!makes_contacts(cells.front().settings))
        throw InputError("a simulation needs contacts; leave out output and contact_rule");
    return cells.front();
}

/// Adds host work of the simulation itself to its stage.
void add_host_time(ContactSearch& search, Stage stage, std::int64_t host_ns) {
    search.stages[static_cast<std::size_t>(stage)].host_ns += host_ns;
}

/// Outputs of the steps of a simulation.
struct StepOutputs {
    SimulationSession& session; ///< recording and checkpoints
    RecordFile& file;
    RunTotals& totals;
};

/// Runs steps until `last` are done, or a signal asks for the end. Adds each to the totals and the records,
/// except steps that an earlier process recorded after the checkpoint.
void run_steps(const SimulateOptions& options, std::size_t last, Simulation& simulation,
               ContactFinder& finder, const StepOutputs& outputs) {
    auto& [session, file, totals] = outputs;
    const Progress progress(options.quiet);
    const auto first = simulation.steps_done();
    const auto recorded = options.resume ? steps_recorded(file, totals.session) : std::set<std::size_t>{};
    const auto detect = [&](const Frame& frame, std::vector<ContactPoint>& contacts) {
        finder.find(frame, contacts);
    };
    for (bool stops = Interrupt::asked(); !stops && simulation.steps_done() < last;) {
        MemoryReserve::refill();
        const auto begin = Clock::now();
        const auto report = simulation.step(detect);
        const auto wall = since(begin);
        auto search = finder.take();
        // The traces of devices do not contain the host's work between searches.
        add_host_time(search, Stage::reduce, report.reduce_ns);
        add_host_time(search, Stage::solve, report.solve_ns);
        totals.add(report, search, wall);
        if (!report.converged && totals.not_converged == 1) {
            progress.clear();
            warn_not_converged(report);
        }
        session.append(report, simulation.midway());
        if (!recorded.contains(report.step)) file.append(step_record(report, search, wall, totals.session));
        const auto done = simulation.steps_done();
        stops = Interrupt::asked();
        if (done % options.every == 0 || done == last || stops) session.save(simulation);
        progress.show(fmt::format("step {} of {}: {} contacts, {} kept, {:.1f} ms", done, last, report.found,
                                  report.kept, static_cast<double>(wall) * 1e-6),
                      progress.left(static_cast<double>(done - first) / static_cast<double>(last - first)));
    }
}

/// A simulation without outputs would only take time.
void refuse_no_output(const SimulateOptions& options) {
    if (options.recording.empty() && options.record.empty())
        throw InputError(
            "no output; give -o FILE.frames to record the motion, or --record FILE.jsonl for the "
            "times of its steps");
}

/// The last line of a run that a signal ended. Returns the exit code.
int end_interrupted(const SimulateOptions& options, std::size_t done, std::size_t last) {
    const auto line = options.recording.empty()
                          ? std::string()
                          : "; to continue: " + command_line() + (options.resume ? "" : " --resume");
    print_message("tandem: interrupted after step {} of {}{}\n", done, last, line);
    return Interrupt::exit_code();
}

/// Runs the steps and records the run. A run that fails also leaves a line, with its number of steps and the
/// reason.
void run_and_record(const SimulateOptions& options, std::size_t last, const Cell& cell, const Scene& scene,
                    Simulation& simulation, const StepOutputs& outputs) {
    auto& [session, file, totals] = outputs;
    try {
        ContactFinder finder(cell, scene, simulation.frame(), !options.record.empty());
        totals.warm_up_ns = finder.warm_up_ns();
        run_steps(options, last, simulation, finder, outputs);
    } catch (const std::exception& error) {
        if (file.failed())
            put_text(run_table(totals, true));
        else
            file.append_or_report(run_record(cell, scene, totals, error.what()));
        throw;
    }
    put_text(run_table(totals, !options.record.empty()));
    warn_not_converged(totals);
    if (!options.recording.empty())
        put("{}: {}; measure them with 'tandem run {}'{}\n", options.recording,
            counted(session.frames(), "frame"), options.recording,
            options.reading == MeshReading() ? "" : " and the same options of meshes");
    const bool interrupted = simulation.steps_done() < last;
    file.append(run_record(cell, scene, totals, interrupted ? "interrupted by a signal" : ""));
}

/// Throws InputError for settings that a simulation has no use for.
void refuse_settings(const Settings& settings) {
    if (settings[parameters::self] != SelfPairs::off)
        throw InputError(
            "setting self does not go with tandem simulate, whose bodies are rigid; leave it out");
    if (settings[parameters::motion] != Motion::none)
        throw InputError("setting motion=linear needs the next frame, which tandem simulate has not computed "
                         "yet; leave it out");
    const auto rule = settings[parameters::contact_rule];
    if (has_near_pairs(rule) || needs_pressures(rule))
        throw InputError(
            fmt::format("setting contact_rule={} makes no contacts, which tandem simulate resolves; "
                        "leave it out",
                        settings.text("contact_rule")));
}

} // namespace

ContactFinder::ContactFinder(const Cell& cell, const Scene& scene, const Frame& start, bool timed)
    : host_broad_(cell.settings[parameters::broad] != Broad::device) {
    const auto begin = Clock::now();
    session_ = cell.algorithm->prepare(cell.devices, scene, cell.settings);
    for (auto* device : session_->devices()) device->set_clocks(timed ? Clocks::on : Clocks::off);
    std::vector<ContactPoint> contacts;
    for (int replay = 0; replay < warming_replays; ++replay) find(start, contacts);
    session_->reset();
    take();
    warm_up_ns_ = since(begin);
}

void ContactFinder::find(const Frame& frame, std::vector<ContactPoint>& contacts) {
    const auto begin = Clock::now();
    const auto result = session_->run(frame);
    contacts = result.download_contacts();
    search_.narrow_ns += since(begin);
    search_.body_pairs += result.body_pairs;
    search_.candidate_pairs += result.count;
    for (auto* device : session_->devices()) {
        const auto stages = by_stage(device->finish());
        for (std::size_t i = 0; i < stages.size(); ++i) search_.stages[i] += stages[i];
        // The host finds body pairs inside run(). Their time is moved from the narrow to the broad phase, as
        // in the paper.
        if (!host_broad_) continue;
        const auto broad = stages[static_cast<std::size_t>(Stage::broad)].host_ns;
        search_.broad_ns += broad;
        search_.narrow_ns -= broad;
    }
}

ContactSearch ContactFinder::take() { return std::exchange(search_, {}); }

int simulate_command(const SimulateOptions& options) {
    const auto scene = open_scene(options);
    report_findings(scene);
    // The tools for pictures are checked first, before hours of simulation.
    std::optional<Pictures> pictures;
    if (!options.pictures.empty()) pictures.emplace(options.pictures);
    const auto request = contacts_request(options);
    const auto backends = open_named(request.devices, options.require);
    const auto cell = only_cell(request, backends);
    refuse_settings(cell.settings);
    check_coordinates(cell, scene, scene.frame(0));
    refuse_no_output(options); // last, so that a wrong scene or setting is named first
    std::optional<Interrupt> interrupt(std::in_place, Interrupt::stopping);
    Simulation simulation(scene);
    // Opened before the recording is made: if this fails, no recording remains to block a second try.
    RecordFile file(options.record);
    SimulationSession session(options, scene, cell);
    session.restore(simulation);
    const auto last = options.steps > 0 ? options.steps : scene.dynamics->steps;
    put("scene {}: {}, {} vertices, {} tetrahedra; {}\n", scene.key,
        counted(scene.bodies.size(), "body", "bodies"), vertex_count(scene), tetrahedron_count(scene),
        describe(cell));
    if (simulation.steps_done() > 0)
        put("continues after step {}{}\n", simulation.steps_done(),
            simulation.steps_done() >= last ? ": all steps are done, none is simulated" : "");
    if (simulation.steps_done() < last) {
        RunTotals totals;
        totals.session = session.number();
        run_and_record(options, last, cell, scene, simulation, {session, file, totals});
    }
    if (simulation.steps_done() < last) return end_interrupted(options, simulation.steps_done(), last);
    interrupt.reset(); // nothing that is drawn needs to be kept
    if (pictures) pictures->draw(options.recording, options.reading);
    return 0;
}

} // namespace tandem
