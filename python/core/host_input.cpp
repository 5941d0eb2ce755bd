// SPDX-License-Identifier: MIT
#include "python/core/host_input.h"

#include "algorithms/bodies/range.h"
#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>

namespace tandem::python {

Frame rest_frame(const Scene& scene) {
    Frame frame{std::vector<Pose>(scene.bodies.size()),
                std::vector<std::vector<Eigen::Vector3d>>(scene.bodies.size())};
    for (std::size_t body = 0; body < scene.bodies.size(); ++body)
        if (scene.bodies[body].deformable)
            frame.deformed[body] = scene.meshes[scene.bodies[body].mesh].vertices;
    return frame;
}

HostInput::HostInput(const Scene& scene, const Geometry& geometry)
    : scene_(scene), geometry_(geometry), limit_(largest_coordinate(geometry)) {}

void HostInput::take_unused() {
    std::swap(frames_[0], frames_[1]); // in a loop, the answer of the last frame is still alive
    if (!frames_[0] || frames_[0].use_count() > 1) frames_[0] = std::make_shared<Frame>(rest_frame(scene_));
}

/// The copy counts coordinates that are out of range. Only then the library's slower check runs, which throws
/// the error message.
const Frame& HostInput::frame(const FrameArrays& arrays, const Frame* base) {
    out_of_range_ = 0;
    take_unused();
    try {
        fill(arrays, base);
        if (out_of_range_ > 0) check_range(scene_, *frames_.front(), geometry_);
    } catch (...) {
        std::swap(frames_[0], frames_[1]); // an update may follow, of the last frame that was usable
        throw;
    }
    return *frames_.front();
}

void HostInput::fill(const FrameArrays& arrays, const Frame* base) {
    auto& frame = *frames_.front();
    if (base != nullptr)
        frame = *base;
    else if (!arrays.poses)
        std::ranges::fill(frame.poses, Pose{});
    if (arrays.poses) set_poses(arrays);
    for (std::size_t body = 0; body < scene_.bodies.size(); ++body) {
        if (!scene_.bodies[body].deformable) continue;
        if (const auto* const given = arrays.vertices_of(body))
            set_vertices(body, *given);
        else if (base == nullptr)
            frame.deformed[body] = scene_.meshes[scene_.bodies[body].mesh].vertices;
    }
}

void HostInput::set_poses(const FrameArrays& arrays) {
    const auto* const rows = static_cast<const double*>(arrays.poses->data);
    for (std::size_t i = 0; i < arrays.posed.size(); ++i) set_pose(arrays.posed[i], rows + 7 * i);
    if (!arrays.posed.empty()) return;
    constexpr std::size_t part = 2048; // bodies whose conversion takes longer than to start a parallel loop
    const auto bodies = scene_.bodies.size();
    try {
        parallel_for((bodies + part - 1) / part, [&](std::size_t i) {
            for (auto body = i * part; body < std::min(bodies, (i + 1) * part); ++body)
                set_pose(body, rows + 7 * body);
        });
    } catch (const InputError&) { // of any row; the message names the first
        for (std::size_t body = 0; body < bodies; ++body) set_pose(body, rows + 7 * body);
    }
}

void HostInput::set_pose(std::size_t body, const double* row) {
    auto& pose = frames_.front()->poses[body];
    pose = {};
    if (scene_.bodies[body].deformable) return;
    pose = pose_of_row(row, body);
    for (const double x : pose.translation)
        if (!(std::abs(x) <= limit_)) ++out_of_range_;
}

void HostInput::set_vertices(std::size_t body, const GivenRows& vertices) {
    auto& points = frames_.front()->deformed[body];
    const auto count = vertices.rows;
    points.resize(count);
    static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double));
    const auto* const from = static_cast<const double*>(vertices.data);
    auto* const to = reinterpret_cast<double*>(points.data());
    std::size_t out_of_range = 0; // a local variable, so that the loop is vectorised
    for (std::size_t i = 0; i < 3 * count; ++i) {
        out_of_range += !(std::abs(from[i]) <= limit_);
        to[i] = from[i];
    }
    out_of_range_ += out_of_range;
}

} // namespace tandem::python
