// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tandem {

/// Contact parameters of two materials.
struct Surface {
    double friction = 0;    ///< Coulomb's coefficient
    double restitution = 0; ///< Newton's coefficient, 0..1
};

/// An unordered pair of materials.
struct MaterialPair {
    /// The pair of two indices into Materials::names, in either order; they may be equal.
    MaterialPair(std::uint32_t one, std::uint32_t other)
        : first(std::min(one, other)), second(std::max(one, other)) {}
    /// Orders by first, then second.
    auto operator<=>(const MaterialPair&) const = default;

    std::uint32_t first, ///< the smaller index
        second;          ///< the larger index
};

/// Densities by material and surfaces by pair of materials. Only pairs whose bodies can touch need a surface,
/// which are few even with thousands of materials.
struct Materials {
    std::vector<std::string> names;           ///< one a material
    std::vector<double> densities;            ///< kg/m^3, one a material
    std::map<MaterialPair, Surface> surfaces; ///< by pair of indices into `names`

    /// The surface of two materials, which must have one.
    const Surface& surface(std::uint32_t a, std::uint32_t b) const { return surfaces.at({a, b}); }
};

/// Elasticity of a deformable body.
struct Elastic {
    /// Relation of strain and stress (scenes/simulate/elastic.h has the formulas).
    enum class Law { corotational, saint_venant_kirchhoff };

    Law law = Law::corotational; ///< of all elements
    double young = 0;            ///< Pa, above 0
    double poisson = 0;          ///< above -1 and below 0.5
    /// Damping force per unit of velocity and volume (kg/(s m^3)), in an element's consistent matrix.
    double damping = 0;
    std::vector<std::uint32_t> pinned; ///< vertices that do not move
};

/// Material and initial velocities of one body.
struct BodyDynamics {
    std::uint32_t material = 0;                         ///< index into Materials::names
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero(); ///< m/s, of the centre of mass
    Eigen::Vector3d spin = Eigen::Vector3d::Zero();     ///< rad/s, in world axes
    std::int32_t elastic = -1; ///< index into Dynamics::elastics of a deformable body
};

struct Body;

/// A pair of materials that needs a surface and has none; none when all are present. A pair needs one when
/// two bodies of these materials are not both fixed. `dynamics` has one entry a body, each with a valid
/// material.
std::optional<MaterialPair> missing_surface(const Materials& materials, std::span<const Body> bodies,
                                            std::span<const BodyDynamics> dynamics);

/// The proximal contact solver (Erleben 2017). With the defaults, single bodies and short stacks of any mass
/// are within 2 % of closed forms (tests/unit/simulate/defaults.cpp).
struct SolverSettings {
    /// Updates contact after contact in one thread, or all contacts at once on all cores.
    enum class Method { gauss_seidel, jacobi };

    Method method = Method::gauss_seidel; ///< serial by default
    std::size_t iterations = 1000;        ///< maximum number of one solution
    double absolute_tolerance = 0;        ///< N s; 0: 1e-5 of the lightest body's weight times the step
    double relative_tolerance = 0;        ///< 0: only the absolute tolerance
    bool warm_start = true;               ///< start from the last step's forces at the same features
};

/// Parts of a time step other than the solution for contact forces.
struct StepSettings {
    double step = 0.01;         ///< s
    bool pre_stabilize = false; ///< adds velocities that reduce penetration
    bool post_stabilize = true; ///< corrects positions after the step
    bool bounce = true;         ///< Newton's restitution
    bool bound_energy = true;   ///< repeats a step without bounces when they would add energy
    /// Rigid bodies: replaces a contact normal that no nearby surface has by the nearest surface normal.
    bool surface_normals = true;
    /// Depth to which resting bodies penetrate, times the smaller body's size, so that rounding does not
    /// separate them; 0: none.
    double contact_layer = 2e-5;
    double linear_damping = 0;  ///< 1/s
    double angular_damping = 0; ///< 1/s
    /// Deformables: the step is halved until the difference to two half steps is below this (m). It is
    /// doubled after ten steps without halving; 0 keeps `step`.
    double adaptive_tolerance = 0;
    double least_step = 1e-5; ///< s
    bool couple_contacts =
        true; ///< deformables: contacts exert forces; false only counts them, as in the paper's code
};

/// Selection of the contacts for the solver.
struct ReductionSettings {
    /// Contacts of a body pair closer than this times the smaller body's size are merged.
    double distance = 1e-6;
    /// Maximum number of contacts of a body pair, chosen to span the contact region; 0 keeps all.
    std::size_t per_pair = 0;
};

/// Physical model of a scene; frame 0 of the scene is the initial state.
struct Dynamics {
    Materials materials;                     ///< of all bodies
    std::vector<Elastic> elastics;           ///< of deformable bodies, by BodyDynamics::elastic
    std::vector<BodyDynamics> bodies;        ///< one a body of the scene
    Eigen::Vector3d gravity = {0, -9.82, 0}; ///< m/s^2, in world axes
    StepSettings stepping;                   ///< of time steps
    SolverSettings solver;                   ///< of contact forces
    ReductionSettings reduction;             ///< of contacts
    std::size_t steps = 500;                 ///< number of steps in a complete run
};

} // namespace tandem
