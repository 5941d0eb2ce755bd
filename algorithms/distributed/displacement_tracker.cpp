// SPDX-License-Identifier: MIT
#include "algorithms/distributed/displacement_tracker.h"

#include "algorithms/bodies/arc.h"
#include "algorithms/bodies/drift.h"
#include "algorithms/bodies/shift.h"
#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace tandem {

DisplacementTracker::DisplacementTracker(const Scene& scene) : scene_(scene), balls_(scene.bodies.size()) {
    for (std::size_t mesh = 0; mesh < scene.meshes.size(); ++mesh) {
        const auto& vertices = scene.meshes[mesh].vertices;
        mesh_balls_.push_back(ball_around(vertices));
        mesh_reach_.push_back(reach_of(vertices, shift_in(scene, mesh)));
    }
    reference_.poses.resize(scene.bodies.size());
    reference_.deformed.resize(scene.bodies.size());
}

void DisplacementTracker::set_reference(const Frame& frame, std::span<const std::uint32_t> bodies) {
    for (const auto body : bodies) {
        if (scene_.bodies[body].deformable) {
            reference_.deformed[body] = frame.deformed[body];
            balls_[body] = ball_around(frame.deformed[body]);
            continue;
        }
        const auto& ball = mesh_balls_[scene_.bodies[body].mesh];
        const auto& pose = frame.poses[body];
        reference_.poses[body] = {pose.rotation.normalized(), pose.translation};
        balls_[body] = {reference_.poses[body].rotation * ball.centre + pose.translation, ball.radius};
    }
}

/// For a rigid body: the displacement of its centre, plus the radius times the norm of the difference of the
/// rotations. That norm is twice the sine of half the angle between them.
double DisplacementTracker::displacement(const Frame& frame, std::uint32_t body) const {
    if (scene_.bodies[body].deformable) {
        double largest = 0;
        const auto& current = frame.deformed[body];
        const auto& reference = reference_.deformed[body];
        for (std::size_t i = 0; i < current.size(); ++i) {
            const double squared = (current[i] - reference[i]).squaredNorm();
            if (!(squared <= largest)) largest = squared; // also NaN
        }
        return std::sqrt(largest);
    }
    const auto& ball = mesh_balls_[scene_.bodies[body].mesh];
    const auto& pose = frame.poses[body];
    const auto current = pose.rotation.normalized();
    const double cosine = current.dot(reference_.poses[body].rotation);
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const Eigen::Vector3d centre = current * ball.centre + pose.translation;
    // The factors exceed the rounding errors of these operations. The error of the sine is the square root of
    // the cosine's.
    return (centre - balls_[body].centre).norm() * (1 + 1e-12) + (2 * sine + 1e-7) * ball.radius;
}

/// The same on the path to the frame's successor. Straight paths are nowhere displaced more than at one of
/// their ends; the arc of a rotation leaves them by a bounded distance. NaN as displacement().
double DisplacementTracker::displacement_on_path(const FrameInput& input, std::uint32_t body) const {
    const double first = displacement(input.frame, body);
    if (input.next == nullptr) return first;
    const double last = displacement(*input.next, body);
    const double larger = first + last - std::min(first, last); // NaN if one of them is NaN
    if (scene_.bodies[body].deformable) return larger;
    const double arc = arc_between(input.frame.poses[body], input.next->poses[body]);
    return larger + arc * mesh_reach_[scene_.bodies[body].mesh] * (1 + 1e-12);
}

bool DisplacementTracker::all_within(const FrameInput& input, std::span<const std::uint32_t> bodies,
                                     double skin) const {
    constexpr std::size_t part = 2048; // 0.1 ms of work, several times the start-up of a thread
    const auto parts = (bodies.size() + part - 1) / part;
    std::atomic<bool> within = true;
    parallel_for(parts, [&](std::size_t i) {
        for (auto j = i * part; within && j < std::min(bodies.size(), (i + 1) * part); ++j) {
            const auto body = bodies[j];
            // The negation makes NaN count as beyond the skin.
            if (!scene_.bodies[body].fixed
                && !(displacement_on_path(input, body) <= skin * balls_[body].radius))
                within = false;
        }
    });
    return within;
}

std::vector<double> DisplacementTracker::skins(double fraction) const {
    std::vector<double> skins;
    skins.reserve(balls_.size());
    for (const auto& ball : balls_) skins.push_back(fraction * ball.radius);
    return skins;
}

} // namespace tandem
