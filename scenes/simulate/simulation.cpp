// SPDX-License-Identifier: MIT
#include "scenes/simulate/simulation.h"

#include "scenes/simulate/algebra.h"
#include "scenes/simulate/bytes.h"
#include "scenes/simulate/step.h"

#include <algorithm>

namespace tandem {

namespace {

using namespace simulate;

constexpr std::uint64_t passes_before_doubling = 10;

/// True when steps are adaptive. Only elastic forces, which are explicit, need shorter steps.
bool adapts(const Model& model) {
    return model.dynamics->stepping.adaptive_tolerance > 0
           && std::any_of(model.bodies.begin(), model.bodies.end(),
                          [](const BodyModel& body) { return body.kind == BodyKind::soft; });
}

/// Largest distance (m) between equal vertices of deformable bodies.
double largest_difference(const MotionState& a, const MotionState& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.soft.size(); ++i)
        for (std::size_t v = 0; v < a.soft[i].positions.size(); ++v)
            most = std::max(most, length(a.soft[i].positions[v] - b.soft[i].positions[v]));
    return most;
}

/// Adds energies to the report. `before` is the total energy (J) at the start of the step.
void add_energies(const Model& model, const MotionState& motion, double before, std::size_t step,
                  StepReport& report) {
    const auto energies = checked_energies(model, motion, step);
    report.kinetic = energies.kinetic;
    report.potential = energies.potential;
    report.elastic = energies.elastic;
    report.inverted = energies.inverted;
    report.energy_change = energies.total() - before;
}

void add_times(StepReport& report, const StepReport& other) {
    report.detect_ns += other.detect_ns;
    report.reduce_ns += other.reduce_ns;
    report.assemble_ns += other.assemble_ns;
    report.solve_ns += other.solve_ns;
    report.move_ns += other.move_ns;
}

} // namespace

struct Simulation::State {
    Model model;
    MotionState motion;
    Clock clock;
    Frame midway;

    explicit State(const Scene& scene)
        : model(make_model(scene)), motion(starting_motion(model)), midway(model.start) {
        model.highest_energy = highest_energy(model, motion);
        clock.length = model.dynamics->stepping.step;
    }

    /// Halves the step until its end differs from that of two half steps by at most the tolerance.
    StepOutcome adapted(const Detect& detect) {
        const auto& stepping = model.dynamics->stepping;
        auto full = advance(model, motion, clock.length, clock.steps, detect);
        bool first_try = true;
        while (true) {
            const double half = clock.length / 2;
            auto first = advance(model, motion, half, clock.steps, detect);
            const auto second = advance(model, first.end, half, clock.steps, detect);
            add_times(full.report, second.report);
            const bool passed = largest_difference(full.end, second.end) <= stepping.adaptive_tolerance;
            if (passed || half < stepping.least_step) {
                add_times(full.report, first.report);
                break;
            }
            // The first half step is the next full step to try.
            add_times(first.report, full.report);
            full = std::move(first);
            clock.length = half;
            first_try = false;
        }
        lengthen(first_try);
        return full;
    }

    /// Doubles the step after ten consecutive steps that passed at the first try, up to the setting `step`.
    void lengthen(bool first_try) {
        clock.passes = first_try ? clock.passes + 1 : 0;
        if (clock.passes < passes_before_doubling) return;
        clock.passes = 0;
        clock.length = std::min(2 * clock.length, model.dynamics->stepping.step);
    }
};

Simulation::Simulation(const Scene& scene) : state_(std::make_unique<State>(scene)) {}
Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

StepReport Simulation::step(const Detect& detect) {
    auto& s = *state_;
    auto outcome = adapts(s.model) ? s.adapted(detect)
                                   : advance(s.model, s.motion, s.clock.length, s.clock.steps, detect);
    // Energies are checked only for the accepted step; a longer step that was tried may diverge.
    add_energies(s.model, outcome.end, total_energy(s.model, s.motion), s.clock.steps, outcome.report);
    s.motion = std::move(outcome.end);
    s.midway = std::move(outcome.midway);
    s.clock.time += outcome.report.length;
    outcome.report.step = s.clock.steps++;
    outcome.report.time = s.clock.time;
    return outcome.report;
}

std::size_t Simulation::steps_done() const { return state_->clock.steps; }
const Frame& Simulation::midway() const { return state_->midway; }

Frame Simulation::frame() const {
    return state_->clock.steps == 0 ? state_->model.start : frame_of(state_->model, state_->motion);
}

std::vector<std::byte> Simulation::state() const {
    return to_bytes(state_->model, state_->motion, state_->clock);
}

void Simulation::restore(std::span<const std::byte> bytes) {
    auto& s = *state_;
    from_bytes(s.model, bytes, s.motion, s.clock);
    s.midway = frame();
}

} // namespace tandem
