// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/narrow_phase/contact_settings.h"
#include "scenes/simulate/simulation.h"

namespace tandem::unit_test {

/// Six faces and a centre: 9 vertices, 12 tetrahedra. `corners` in the order of binary x + 2 y + 4 z.
Mesh hexahedron(const std::array<Eigen::Vector3d, 8>& corners);
/// Axis-aligned, around `centre`.
Mesh box(const Eigen::Vector3d& size, const Eigen::Vector3d& centre = Eigen::Vector3d::Zero());
/// A regular grid of cells, each split into six tetrahedra; from the origin to `size`.
Mesh beam(const Eigen::Vector3d& size, std::array<int, 3> cells);
/// An icosahedron subdivided `times` and projected to the sphere, with a centre.
Mesh ball(double radius, int times);

/// A scene of bodies with one material.
struct World {
    Scene scene;
    Dynamics dynamics;
    Frame start;

    explicit World(Surface surface = {0.5, 0});
    /// Returns the index of the new body.
    std::size_t add(Mesh mesh, const Pose& pose, bool fixed = false, const BodyDynamics& moves = {});
    std::size_t add_soft(Mesh mesh, Elastic elastic, const BodyDynamics& moves = {});
    const Scene& finish();
};

Pose at(double x, double y, double z);

/// Default settings of `tandem simulate`.
constexpr ContactSettings least_translation{ContactRule::sat, DecisionPrecision::recheck};

/// Contacts by the reference, over all pairs of tetrahedra whose boxes overlap.
Detect detector(const Scene& scene, const ContactSettings& settings = {});
void no_contacts(const Frame&, std::vector<ContactPoint>& contacts);

/// A simulation of a world, with contacts by the reference.
class Running : public Simulation {
public:
    explicit Running(World& world, const ContactSettings& settings = {})
        : Simulation(world.finish()), detect_(detector(world.scene, settings)) {}
    StepReport step() { return Simulation::step(detect_); }

private:
    Detect detect_;
};

} // namespace tandem::unit_test
