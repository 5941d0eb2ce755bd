// SPDX-License-Identifier: MIT
#include "scenes/builtin.h"
#include "base/error.h"
#include "scenes/body_memory.h"
#include "scenes/motion.h"
#include "scenes/parameters.h"
#include "base/random.h"
#include "scenes/refine.h"

#include <algorithm>
#include <cmath>

namespace tandem {

namespace {

constexpr double spin_per_frame = 0.03;  ///< radians
constexpr double drift_per_frame = 0.01; ///< times the mesh's radius

/// A body that rotates and translates in every frame.
struct Mover {
    Eigen::Vector3d centre, drift, axis;
    Eigen::Quaterniond rotation;
};

Mesh mesh_named(const std::string& name) {
    const auto names = built_in_names();
    if (std::find(names.begin(), names.end(), name) != names.end()) return built_in_mesh(name);
    if (name.find('.') == std::string::npos && name.find('/') == std::string::npos)
        throw InputError(unknown("mesh", name, names));
    return read_mesh(name);
}

/// Centre of the mesh's box and radius of the mesh about it.
std::pair<Eigen::Vector3d, double> bounding_sphere(const Mesh& mesh) {
    Eigen::Vector3d lower = mesh.vertices.front();
    Eigen::Vector3d upper = lower;
    for (const auto& v : mesh.vertices) {
        lower = lower.cwiseMin(v);
        upper = upper.cwiseMax(v);
    }
    double radius = 0;
    for (const auto& v : mesh.vertices) radius = std::max(radius, (v - 0.5 * (lower + upper)).norm());
    return {0.5 * (lower + upper), radius};
}

/// Newton's iteration with IEEE operations, since the library's cube root may differ between machines.
double cube_root(double x) {
    int exponent = 0;
    std::frexp(x, &exponent);
    double root = std::ldexp(1.0, exponent / 3);
    for (int i = 0; i < 60; ++i) root = (2 * root + x / (root * root)) / 3;
    return root;
}

Frame moved(const std::vector<Mover>& movers, const Eigen::Vector3d& middle, double offset,
            std::size_t step) {
    Frame frame;
    frame.deformed.resize(movers.size());
    for (const auto& m : movers) {
        Pose pose;
        pose.rotation = unit(product(turn(m.axis, spin_per_frame * static_cast<double>(step)), m.rotation));
        const Eigen::Vector3d centre = m.centre + static_cast<double>(step) * m.drift;
        pose.translation = (centre - rotated(pose.rotation, middle)) + Eigen::Vector3d::Constant(offset);
        frame.poses.push_back(pose);
    }
    return frame;
}

Scene make_pile(std::span<const SceneParameter> parameters) {
    Scene scene;
    const auto world = integer_parameter(parameters, "bodies", 1, 10000000);
    const auto worlds = integer_parameter(parameters, "worlds", 1, 10000000 / world);
    const auto bodies = world * worlds;
    const double density = real_parameter(parameters, "density", 1e-6, 1e3);
    const double offset = real_parameter(parameters, "far", -1e9, 1e9);
    scene.frame_count = integer_parameter(parameters, "frames", 1, 1000000);
    scene.meshes.push_back(mesh_named(text_parameter(parameters, "mesh")));
    const auto levels = refine_value(parameters);
    refuse_bodies_beyond_memory(bodies, scene.meshes.front(), levels);
    scene.bodies.assign(bodies, Body{});
    if (worlds > 1) scene.world_size = static_cast<std::uint32_t>(world);
    const auto [middle, radius] = bounding_sphere(scene.meshes.front());
    const double side = cube_root(static_cast<double>(world) * volume(scene.meshes.front()) / density);
    scene.meshes.front() = refined(scene.meshes.front(), levels);
    Random random(integer_parameter(parameters, "seed", 0, ~std::uint64_t{0}));
    std::vector<Mover> movers(bodies);
    for (auto& m : movers) {
        for (auto& x : m.centre) x = random.uniform(-0.5, 0.5) * side;
        m.rotation = random.rotation();
        m.axis = random.direction();
        m.drift = drift_per_frame * radius * random.direction();
    }
    scene.frame = [movers = std::move(movers), centre = middle, offset](std::size_t step) {
        return moved(movers, centre, offset, step);
    };
    return scene;
}

} // namespace

SceneKind pile_kind() {
    return {"pile",
            "rigid bodies of one mesh at random poses in a box, drifting and spinning slowly; no forces, "
            "bodies overlap",
            {{"bodies", "64", "number of bodies, of each world"},
             {"worlds", "1", "worlds in the same box, whose bodies never meet", "1"},
             {"mesh", "jack", "a built-in mesh or a mesh file"},
             {"density", "0.2", "sum of the bodies' volumes over the volume of the box"},
             {"seed", "1", "seed of the poses"},
             {"frames", "8", "time steps"},
             {"far", "0", "offset added to all coordinates"},
             refine_parameter()},
            make_pile};
}

} // namespace tandem
