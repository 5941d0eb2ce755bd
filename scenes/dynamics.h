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

/// What two materials do where they touch.
struct Surface {
    double friction = 0;    ///< Coulomb's coefficient
    double restitution = 0; ///< Newton's coefficient, 0..1
};

/// Two materials in either order.
struct MaterialPair {
    MaterialPair(std::uint32_t one, std::uint32_t other)
        : first(std::min(one, other)), second(std::max(one, other)) {}
    auto operator<=>(const MaterialPair&) const = default;

    std::uint32_t first, second;
};

/// Densities by material, surfaces by pair of those materials that can meet: of thousands of materials few
/// do.
struct Materials {
    std::vector<std::string> names;
    std::vector<double> densities; ///< kg/m^3
    std::map<MaterialPair, Surface> surfaces;

    /// Of two materials that have one.
    const Surface& surface(std::uint32_t a, std::uint32_t b) const { return surfaces.at({a, b}); }
};

/// How a deformable body resists.
struct Elastic {
    enum class Law { corotational, saint_venant_kirchhoff };

    Law law = Law::corotational;
    double young = 0;   ///< Pa
    double poisson = 0; ///< below 0.5
    /// Damping force per unit of velocity and volume (kg/(s m^3)), of an element's consistent matrix.
    double damping = 0;
    std::vector<std::uint32_t> pinned; ///< vertices that do not move
};

/// How one body starts and what it is made of.
struct BodyDynamics {
    std::uint32_t material = 0;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero(); ///< m/s, of the centre of mass
    Eigen::Vector3d spin = Eigen::Vector3d::Zero();     ///< rad/s, in world axes
    std::int32_t elastic = -1; ///< index into Dynamics::elastics of a deformable body
};

struct Body;

/// Two materials without a surface whose bodies can meet, since they are not both fixed; none where all have
/// one. One of `moves` a body, with a material that there is.
std::optional<MaterialPair> missing_surface(const Materials& materials, std::span<const Body> bodies,
                                            std::span<const BodyDynamics> moves);

/// The proximal contact solver (Erleben 2017). The defaults bring single bodies and short stacks within 2 %
/// of closed forms (tests/unit/simulate_defaults.cpp), whatever they weigh.
struct SolverSettings {
    enum class Method { gauss_seidel, jacobi };

    Method method = Method::gauss_seidel;
    std::size_t iterations = 1000;
    double absolute_tolerance = 0; ///< N s; 0: 1e-5 of what holds the lightest body for a step
    double relative_tolerance = 0; ///< 0: the absolute one alone
    bool warm_start = true;        ///< from the last step's forces at the same features
};

/// What a step does beside solving for contact forces.
struct StepSettings {
    double step = 0.01;         ///< s
    bool pre_stabilize = false; ///< velocities that lessen penetration
    bool post_stabilize = true; ///< positions corrected after the step
    bool bounce = true;         ///< Newton's restitution
    bool bound_energy = true;   ///< a step whose bounces would add energy is taken without them
    /// Normals that no surface near the contact has are replaced by the nearest that one has (rigid bodies).
    bool surface_normals = true;
    /// How deep bodies that rest lie in each other, times the smaller one's size, so that rounding does not
    /// part them; 0: not at all.
    double contact_layer = 2e-5;
    double linear_damping = 0;  ///< 1/s
    double angular_damping = 0; ///< 1/s
    /// Deformables: the step is halved until the difference to two half steps is below this (m), and doubled
    /// after ten steps that passed at once; 0 keeps `step`.
    double adaptive_tolerance = 0;
    double least_step = 1e-5; ///< s
    bool couple_contacts =
        true; ///< deformables: contacts push; false only counts them, as the paper's code did
};

/// Which of the contacts found reach the solver.
struct ReductionSettings {
    /// Contacts of a body pair closer than this times the smaller body's size are one.
    double distance = 1e-6;
    /// At most so many of a body pair, chosen to span the contact region; 0 keeps all.
    std::size_t per_pair = 0;
};

/// What moves the bodies of a scene; its frame 0 is where they start.
struct Dynamics {
    Materials materials;
    std::vector<Elastic> elastics;
    std::vector<BodyDynamics> bodies; ///< one a body of the scene
    Eigen::Vector3d gravity = {0, -9.82, 0};
    StepSettings stepping;
    SolverSettings solver;
    ReductionSettings reduction;
    std::size_t steps = 500; ///< of a whole run
};

} // namespace tandem
