// SPDX-License-Identifier: MIT
#include "scenes/simulate/step.h"

#include "base/error.h"
#include "scenes/simulate/algebra.h"
#include "scenes/simulate/reduce.h"
#include "scenes/simulate/solve.h"
#include "scenes/simulate/stabilize.h"
#include "scenes/simulate/surface_normals.h"

#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <thread>

namespace tandem::simulate {

namespace {

class Stopwatch {
public:
    /// Adds the nanoseconds since the last lap to `total`.
    void lap(std::int64_t& total) {
        const auto now = std::chrono::steady_clock::now();
        total += std::chrono::duration_cast<std::chrono::nanoseconds>(now - last_).count();
        last_ = now;
    }

private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Checks a contact from `detect`. The length of a normal may differ from 1 by rounding in single precision.
bool is_valid(const Model& model, const ContactPoint& contact) {
    const auto exists = [&](std::uint32_t body, std::uint32_t tet) {
        return body < model.bodies.size()
               && tet < model.scene->meshes[model.scene->bodies[body].mesh].tetrahedra.size();
    };
    double squared = 0;
    bool finite = std::isfinite(contact.depth);
    for (std::size_t i = 0; i < 3; ++i) {
        squared += contact.normal[i] * contact.normal[i];
        finite = finite && std::isfinite(contact.point[i]);
    }
    return finite && std::fabs(squared - 1) < 1e-3 && exists(contact.pair.body_a, contact.pair.tet_a)
           && exists(contact.pair.body_b, contact.pair.tet_b);
}

std::vector<ContactPoint> reduce(const Model& model, std::span<const ContactPoint> contacts) {
    std::vector<double> sizes;
    for (const auto& body : model.bodies) sizes.push_back(body.size);
    return reduce_contacts(contacts, sizes, model.dynamics->reduction);
}

/// Largest penetration in m, >= 0; depths are negative inside.
double deepest(std::span<const ContactPoint> contacts) {
    double depth = 0;
    for (const auto& contact : contacts) depth = std::max(depth, -contact.depth);
    return depth;
}

/// Lets contacts of rigid bodies close that are shallower than their layer. A faster bounce has precedence.
void allow_settling(const Model& model, std::span<const ContactPoint> kept, double length, Problem& problem) {
    for (std::size_t i = 0; i < problem.rows.size(); ++i) {
        auto& row = problem.rows[i];
        const auto& contact = kept[problem.sources[i]];
        if (row.a.attached || row.b.attached) continue;
        const double speed = settling(contact.depth, layer_of(model, contact.pair, length), length);
        if (speed <= -row.bounce || speed == 0) continue;
        row.bias += speed - row.bounce;
        row.bounce = 0;
    }
}

/// The complete input of the solver. Sets `motion` to the velocities without contacts.
Problem assemble(const Model& model, const MotionState& from, std::span<const ContactPoint> kept,
                 double length, MotionState& motion) {
    const auto before = motion;
    kick(model, motion, length);
    auto problem = make_problem(model, before, motion, kept);
    if (model.dynamics->stepping.pre_stabilize)
        for (std::size_t i = 0; i < problem.rows.size(); ++i) {
            const auto& contact = kept[problem.sources[i]];
            problem.rows[i].bias += separation_bias(contact.depth, pair_size(model, contact.pair), length);
        }
    allow_settling(model, kept, length, problem);
    if (model.dynamics->solver.warm_start && from.length > 0)
        reuse_impulses(from.impulses, length / from.length, kept, problem);
    return problem;
}

} // namespace

void check_contacts(const Model& model, std::span<const ContactPoint> contacts, std::size_t step) {
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const auto& c = contacts[i];
        if (!is_valid(model, c))
            throw InputError(fmt::format(
                "step {}: contact {} (body {} tetrahedron {}, body {} tetrahedron {}) is impossible: bodies "
                "and "
                "tetrahedra must exist, point and depth {:.3g} be finite, the normal be of length 1",
                step, i, c.pair.body_a, c.pair.tet_a, c.pair.body_b, c.pair.tet_b, c.depth));
        if (i > 0 && std::pair(c.pair, c.feature) < std::pair(contacts[i - 1].pair, contacts[i - 1].feature))
            throw InputError(
                fmt::format("step {}: contact {} is out of order: sort by pair and feature", step, i));
    }
}

StepOutcome advance(const Model& model, const MotionState& from, double length, std::size_t step,
                    const Detect& detect) {
    StepOutcome outcome{from, {}, {}};
    // Half a step of motion, then the contacts at midway.
    auto& [motion, midway, report] = outcome;
    report.length = length;
    Stopwatch watch;
    drift(model, motion, length / 2);
    midway = frame_of(model, motion);
    watch.lap(report.move_ns);

    std::vector<ContactPoint> found;
    detect(midway, found);
    check_contacts(model, found, step);
    watch.lap(report.detect_ns);
    if (model.dynamics->stepping.surface_normals) set_surface_normals(model, midway, found);
    const auto kept = reduce(model, found);
    report.found = found.size();
    report.kept = kept.size();
    report.deepest = deepest(kept);
    watch.lap(report.reduce_ns);

    // Velocities of the whole step: forces first, then the impulses of contacts.
    auto problem = assemble(model, from, kept, length, motion);
    watch.lap(report.assemble_ns);
    const auto settings = solver_of(model, length);
    const auto threads = std::max(1u, std::thread::hardware_concurrency());
    const auto solved = model.dynamics->stepping.bound_energy ? solve_bounded(problem, settings, threads)
                                                              : solve(problem, settings, threads);
    report.tolerance = settings.absolute_tolerance;
    report.iterations = solved.iterations;
    report.residual = solved.residual;
    report.converged = solved.converged;
    watch.lap(report.solve_ns);

    add_impulses(model, problem, motion);
    motion.length = length;
    if (model.dynamics->solver.warm_start) motion.impulses = keep_impulses(problem, kept);
    drift(model, motion, length / 2);
    if (model.dynamics->stepping.post_stabilize)
        report.lifted = correct_positions(model, std::move(problem), kept, length / 2, motion);
    watch.lap(report.move_ns);
    return outcome;
}

} // namespace tandem::simulate
