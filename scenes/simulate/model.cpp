// SPDX-License-Identifier: MIT
#include "scenes/simulate/model.h"

#include "base/error.h"
#include "scenes/simulate/algebra.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace tandem::simulate {

namespace {

/// Throws InputError. Every message names the scene, since a run can have several.
[[noreturn]] void refuse(const Scene& scene, const std::string& what) {
    throw InputError(fmt::format("scene '{}': {}", scene.name, what));
}

bool finite(const Eigen::Vector3d& v) {
    return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z());
}

/// False for NaN, as every check in this file.
bool within(double value, double low, double high) { return value >= low && value <= high; }

/// Checks that each material has one density (kg/m^3) and that surfaces are valid.
void check_materials(const Scene& scene, const Materials& materials) {
    const auto count = materials.names.size();
    if (materials.densities.size() != count)
        refuse(scene, fmt::format("{} materials need {} densities, there are {}", count, count,
                                  materials.densities.size()));
    for (const auto& [pair, surface] : materials.surfaces) {
        if (pair.second >= count)
            refuse(scene, fmt::format("has a surface of material {}, there are {}", pair.second, count));
        if (!within(surface.friction, 0, 1e6) || !within(surface.restitution, 0, 1))
            refuse(scene, fmt::format("friction {} must be at least 0 and restitution {} within 0..1",
                                      surface.friction, surface.restitution));
    }
}

void check_stepping(const Scene& scene, const Dynamics& dynamics) {
    constexpr double most = 1e300;
    const auto& stepping = dynamics.stepping;
    if (!(stepping.step > 0) || !(stepping.step < most))
        refuse(scene, fmt::format("a time step of {} s is impossible: give one above 0", stepping.step));
    if (!within(stepping.linear_damping, 0, most) || !within(stepping.angular_damping, 0, most))
        refuse(scene, fmt::format("damping ({}, {}) must be at least 0", stepping.linear_damping,
                                  stepping.angular_damping));
    if (!within(stepping.adaptive_tolerance, 0, most) || !(stepping.least_step > 0))
        refuse(scene, fmt::format("adaptive_tolerance {} must be at least 0, least_step {} above 0",
                                  stepping.adaptive_tolerance, stepping.least_step));
    const auto& solver = dynamics.solver;
    if (!within(solver.absolute_tolerance, 0, most) || !within(solver.relative_tolerance, 0, most)
        || !within(dynamics.reduction.distance, 0, most))
        refuse(scene, "tolerances and the distance of contact reduction must be at least 0");
    if (!finite(dynamics.gravity)) refuse(scene, "gravity is not finite");
}

/// Limits of a stable isotropic material: Young's modulus above 0, Poisson's ratio within -1..0.5. Both
/// limits of the ratio are open, since Lame's lambda is infinite at 0.5.
void check_elastic(const Scene& scene, const Elastic& elastic) {
    if (!(elastic.young > 0) || !std::isfinite(elastic.young) || !(elastic.poisson > -1)
        || !(elastic.poisson < 0.5) || !within(elastic.damping, 0, 1e300))
        refuse(scene, fmt::format("Young's modulus {} must be above 0, Poisson's ratio {} within -1..0.5, "
                                  "damping {} at least 0",
                                  elastic.young, elastic.poisson, elastic.damping));
}

void check_sizes(const Scene& scene, const Dynamics& dynamics, const Frame& start) {
    const auto bodies = scene.bodies.size();
    if (dynamics.bodies.size() != bodies || start.poses.size() != bodies
        || (!start.deformed.empty() && start.deformed.size() != bodies))
        refuse(scene, fmt::format("{} bodies, but dynamics of {} and a start of {} poses and {} deformed",
                                  bodies, dynamics.bodies.size(), start.poses.size(), start.deformed.size()));
}

/// Checks indices before numbers, since later checks use the indices.
void check_body(const Model& model, std::size_t i) {
    const auto& body = model.scene->bodies[i];
    const auto& dynamics = model.dynamics->bodies[i];
    const auto refuse_body = [&](const std::string& what) {
        refuse(*model.scene, fmt::format("body {} {}", i, what));
    };
    if (body.mesh >= model.scene->meshes.size()) refuse_body("has a mesh that does not exist");
    if (dynamics.material >= model.dynamics->materials.names.size())
        refuse_body(fmt::format("has material {}, there are {}", dynamics.material,
                                model.dynamics->materials.names.size()));
    if (body.deformable != (dynamics.elastic >= 0)
        || dynamics.elastic >= static_cast<std::int64_t>(model.dynamics->elastics.size()))
        refuse_body(fmt::format("has elastic {}: deformable bodies need one that exists, others -1",
                                dynamics.elastic));
    if (!finite(dynamics.velocity) || !finite(dynamics.spin))
        refuse_body("has a velocity that is not finite");
    if (body.fixed
        && (dynamics.velocity != Eigen::Vector3d::Zero() || dynamics.spin != Eigen::Vector3d::Zero()))
        refuse_body("is fixed, but has a velocity: leave one out");
    const auto& q = model.start.poses[i].rotation;
    const double norm = (q.w() * q.w() + q.x() * q.x()) + (q.y() * q.y() + q.z() * q.z());
    if (!(std::fabs(norm - 1) < 1e-6) || !finite(model.start.poses[i].translation))
        refuse_body("has an initial pose that is not a rotation and a translation");
    const auto vertices = model.scene->meshes[body.mesh].vertices.size();
    if (body.deformable && (model.start.deformed.empty() || model.start.deformed[i].size() != vertices))
        refuse_body(
            fmt::format("is deformable, but its start does not have the {} vertices of its mesh", vertices));
}

/// Longest edge (m) of the mesh's box, which is the reference length of distances at the body.
double longest_edge(const Mesh& mesh) {
    if (mesh.vertices.empty()) return 0;
    Eigen::Vector3d low = mesh.vertices.front(), high = low;
    for (const auto& v : mesh.vertices) {
        low = low.cwiseMin(v);
        high = high.cwiseMax(v);
    }
    return (high - low).maxCoeff();
}

/// A fixed body has only a size and a material, since no impulse moves it.
BodyModel make_body(const Model& model, std::size_t i) {
    const auto& body = model.scene->bodies[i];
    const auto& mesh = model.scene->meshes[body.mesh];
    const auto& dynamics = model.dynamics->bodies[i];
    const double density = model.dynamics->materials.densities[dynamics.material];
    BodyModel result;
    result.material = dynamics.material;
    result.size = longest_edge(mesh);
    if (body.fixed) return result;
    if (body.deformable) {
        result.kind = BodyKind::soft;
        result.elastic = make_elastic_mesh(
            mesh, model.dynamics->elastics[static_cast<std::size_t>(dynamics.elastic)], density);
        return result;
    }
    result.kind = BodyKind::rigid;
    result.mass = mass_properties(mesh, density);
    result.inverse_inertia = adjugate(result.mass.inertia) / determinant(result.mass.inertia);
    return result;
}

/// Smallest mass in kg of the body or its vertices. Pinned vertices count too.
double least_mass(const BodyModel& body) {
    return body.kind == BodyKind::rigid
               ? body.mass.mass
               : *std::min_element(body.elastic.masses.begin(), body.elastic.masses.end());
}

/// Sets the scales that solver_of() uses.
void set_scales(Model& model) {
    constexpr double none = std::numeric_limits<double>::max();
    model.lightest = model.smallest = none;
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
        const auto& body = model.bodies[i];
        if (body.kind == BodyKind::fixed) continue;
        const auto& dynamics = model.dynamics->bodies[i];
        model.lightest = std::min(model.lightest, least_mass(body));
        model.smallest = std::min(model.smallest, body.size);
        model.fastest =
            std::max(model.fastest, length(dynamics.velocity) + 0.5 * body.size * length(dynamics.spin));
    }
    if (model.lightest == none) model.lightest = model.smallest = 0;
}

} // namespace

Model make_model(const Scene& scene) {
    if (!scene.dynamics)
        refuse(scene,
               "has no dynamics, its frames are scripted: simulate a scene whose bodies have materials");
    Model model{.scene = &scene,
                .dynamics = scene.dynamics.get(),
                .bodies = {},
                .boundaries = {},
                .start = scene.frame(0)};
    check_materials(scene, model.dynamics->materials);
    check_stepping(scene, *model.dynamics);
    for (const auto& elastic : model.dynamics->elastics) check_elastic(scene, elastic);
    check_sizes(scene, *model.dynamics, model.start);
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        check_body(model, i);
        model.bodies.push_back(make_body(model, i));
    }
    const auto& materials = model.dynamics->materials;
    if (const auto missing = missing_surface(materials, scene.bodies, model.dynamics->bodies))
        refuse(scene, fmt::format("has no surface for materials {} and {}, whose bodies can touch",
                                  materials.names[missing->first], materials.names[missing->second]));
    set_scales(model);
    if (model.dynamics->stepping.surface_normals)
        for (const auto& mesh : scene.meshes) model.boundaries.emplace_back(mesh);
    return model;
}

} // namespace tandem::simulate
