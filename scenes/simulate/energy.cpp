// SPDX-License-Identifier: MIT
#include "base/error.h"
#include "scenes/simulate/algebra.h"
#include "scenes/simulate/motion_state.h"
#include "scenes/simulate/stabilize.h"

#include <cmath>
#include <fmt/format.h>

namespace tandem::simulate {

namespace {

/// Kinetic energy 0.5 m v.v + 0.5 L.w with the momentum L and the spin w = I^-1 L.
Energies rigid_energies(const Model& model, const RigidState& state, const BodyModel& body) {
    return {.kinetic = 0.5 * body.mass.mass * dot(state.velocity, state.velocity)
                       + 0.5 * dot(state.angular, spin(body, state)),
            .potential = -body.mass.mass * dot(model.dynamics->gravity, state.centre)};
}

Energies soft_energies(const Model& model, const SoftState& state, const ElasticMesh& mesh) {
    const auto deformed = strain(mesh, state.positions);
    Energies result{.elastic = deformed.energy, .inverted = deformed.inverted};
    for (std::size_t i = 0; i < mesh.masses.size(); ++i) {
        result.kinetic += 0.5 * mesh.masses[i] * dot(state.velocities[i], state.velocities[i]);
        result.potential -= mesh.masses[i] * dot(model.dynamics->gravity, state.positions[i]);
    }
    return result;
}

void add(Energies& sum, const Energies& part) {
    sum.kinetic += part.kinetic;
    sum.potential += part.potential;
    sum.elastic += part.elastic;
    sum.inverted += part.inverted;
}

[[noreturn]] void diverged(const Model& model, std::size_t step, std::size_t body, const Energies& part,
                           const std::string& what) {
    throw InputError(
        fmt::format("scene '{}': the motion diverges in step {}: body {} has a kinetic energy of "
                    "{:.3g} J, an elastic one of {:.3g} J and a potential one of {:.3g} J, {}; "
                    "take a shorter step",
                    model.scene->name, step, body, part.kinetic, part.elastic, part.potential, what));
}

/// Diagonal (m) of the box around all moving bodies.
double extent(const Model& model, const MotionState& motion) {
    Eigen::AlignedBox3d box;
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
        for (const auto& p : motion.soft[i].positions) box.extend(p);
        const Eigen::Vector3d half = Eigen::Vector3d::Constant(model.bodies[i].size);
        if (model.bodies[i].kind != BodyKind::rigid) continue;
        box.extend(motion.rigid[i].centre - half);
        box.extend(motion.rigid[i].centre + half);
    }
    return box.isEmpty() ? 0 : length(box.diagonal());
}

/// Mass in kg. One of the two terms is zero.
double mass_of(const BodyModel& body) {
    double mass = body.mass.mass;
    for (const double part : body.elastic.masses) mass += part;
    return mass;
}

} // namespace

Energies energies_of(const Model& model, const MotionState& motion, std::size_t body) {
    const auto& kind = model.bodies[body];
    if (kind.kind == BodyKind::rigid) return rigid_energies(model, motion.rigid[body], kind);
    if (kind.kind == BodyKind::soft) return soft_energies(model, motion.soft[body], kind.elastic);
    return {};
}

double total_energy(const Model& model, const MotionState& motion) {
    Energies sum;
    for (std::size_t i = 0; i < model.bodies.size(); ++i) add(sum, energies_of(model, motion, i));
    return sum.total();
}

Energies checked_energies(const Model& model, const MotionState& motion, std::size_t step) {
    Energies sum;
    Energies most;
    std::size_t fastest = 0;
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
        const auto part = energies_of(model, motion, i);
        if (!std::isfinite(part.total())) diverged(model, step, i, part, "which is not finite");
        if (part.kinetic + part.elastic > most.kinetic + most.elastic) {
            most = part;
            fastest = i;
        }
        add(sum, part);
    }
    if (sum.total() > model.highest_energy)
        diverged(model, step, fastest, most,
                 fmt::format(
                     "and all bodies together {:.3g} J, above the limit of {:.3g} J from the initial state",
                     sum.total(), model.highest_energy));
    return sum;
}

double highest_energy(const Model& model, const MotionState& start) {
    const auto& dynamics = *model.dynamics;
    const double fall = length(dynamics.gravity) * extent(model, start);
    double total = 0;
    double reach = 0;
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
        const auto& body = model.bodies[i];
        if (body.kind == BodyKind::fixed) continue;
        const auto part = energies_of(model, start, i);
        // Velocity of the largest correction of a penetration in one step.
        const double correction = greatest_correction * body.size / dynamics.stepping.step;
        total += part.total();
        reach += part.kinetic + part.elastic + mass_of(body) * (fall + correction * correction);
    }
    return total + 10 * reach;
}

} // namespace tandem::simulate
