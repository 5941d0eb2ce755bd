// SPDX-License-Identifier: MIT
#include "scenes/builtin.h"
#include "scenes/body_memory.h"
#include "scenes/parameters.h"
#include "base/random.h"
#include "scenes/refine.h"

namespace tandem {

namespace {

constexpr double one_degree = 0x1.1df46a2529d39p-6; ///< pi / 180
constexpr double plate_half_depth = 2;
constexpr double plate_pitch = 0.5; ///< thickness of a plate, so that neighbours touch at rest
constexpr std::size_t period = 200; ///< steps of 0.01 s between two reversals of the twist

/// Twist of a plate's ends in degrees. It changes by one degree a step, up and down.
double twist_at(std::size_t step) {
    const auto phase = step % (2 * period);
    return static_cast<double>(phase < period ? phase : 2 * period - phase);
}

Eigen::Vector3d about_z(const Eigen::Vector3d& p, const SineCosine& turn) {
    return {turn.cosine * p.x() - turn.sine * p.y(), turn.sine * p.x() + turn.cosine * p.y(), p.z()};
}

Eigen::Vector3d about_y(const Eigen::Vector3d& p, const SineCosine& turn) {
    return {turn.cosine * p.x() + turn.sine * p.z(), p.y(), turn.cosine * p.z() - turn.sine * p.x()};
}

/// World vertices of all plates. The rest shape is twisted about the plate's z-axis in proportion to z,
/// rotated by the plate's index in the stack, and lifted.
Frame twisted(const std::vector<Eigen::Vector3d>& rest, std::size_t plates, double angle, std::size_t step) {
    Frame frame;
    frame.poses.resize(plates);
    for (std::size_t plate = 0; plate < plates; ++plate) {
        const auto turn = sine_cosine(angle * static_cast<double>(plate));
        auto& vertices = frame.deformed.emplace_back();
        for (const auto& p : rest) {
            const auto twist = sine_cosine(twist_at(step) * one_degree * (p.z() / plate_half_depth));
            const auto world = about_y(about_z(p, twist), turn);
            vertices.emplace_back(world.x(), world.y() + plate_pitch * static_cast<double>(plate), world.z());
        }
    }
    return frame;
}

Scene make_plates(std::span<const SceneParameter> parameters) {
    Scene scene;
    const auto count = integer_parameter(parameters, "count", 1, 100000);
    const double angle = real_parameter(parameters, "angle", -4, 4);
    scene.frame_count = integer_parameter(parameters, "frames", 1, 1000000);
    const auto levels = refine_value(parameters);
    refuse_bodies_beyond_memory(count, built_in_mesh("plate"), levels);
    scene.meshes.push_back(refined(built_in_mesh("plate"), levels));
    scene.bodies.assign(count, Body{.mesh = 0, .fixed = false, .deformable = true});
    scene.frame = [rest = scene.meshes.front().vertices, count, angle](std::size_t step) {
        return twisted(rest, count, angle, step);
    };
    return scene;
}

} // namespace

SceneKind plates_kind() {
    return {"plates",
            "a stack of deformable 4 x 0.5 x 4 plates under the paper's scripted twist; no forces, plates "
            "pass through "
            "each other",
            {{"count", "3", "plates"},
             {"angle", "0.3", "rotation of each plate relative to the plate below, radians"},
             {"frames", "500", "steps of 0.01 s"},
             refine_parameter()},
            make_plates};
}

} // namespace tandem
