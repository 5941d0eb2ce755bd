// SPDX-License-Identifier: MIT
#include "algorithms/listed/body_motion.h"

#include "algorithms/bodies/ball.h"
#include "algorithms/bodies/drift.h"
#include "algorithms/listed/list_state.clh"
#include "algorithms/sources.h"
#include "backends/upload.h"

#include <algorithm>
#include <cmath>

namespace tandem {

namespace {

constexpr std::size_t shape_reals = 8; ///< SHAPE_ROWS rows
/// Covers the rounding of a row's numbers to a real.
constexpr double rounded_up = 1 + 1e-6;

std::vector<std::byte> packed(const std::vector<double>& numbers, Precision precision) {
    if (precision == Precision::fp64) {
        const auto bytes = bytes_of(numbers);
        return {bytes.begin(), bytes.end()};
    }
    const std::vector<float> rounded(numbers.begin(), numbers.end());
    const auto bytes = bytes_of(rounded);
    return {bytes.begin(), bytes.end()};
}

/// Sum of the longest sides of the bounding boxes of a mesh's tetrahedra.
double sum_of_lengths(const Mesh& mesh) {
    double sum = 0;
    for (const auto& tetrahedron : mesh.tetrahedra) {
        Eigen::Vector3d lower = mesh.vertices[tetrahedron[0]];
        Eigen::Vector3d upper = lower;
        for (const auto vertex : tetrahedron) {
            lower = lower.cwiseMin(mesh.vertices[vertex]);
            upper = upper.cwiseMax(mesh.vertices[vertex]);
        }
        sum += (upper - lower).maxCoeff();
    }
    return sum;
}

/// Mean over the tetrahedra of moving bodies, or of all bodies if none moves.
double mean_length(const Scene& scene) {
    std::vector<double> sums;
    for (const auto& mesh : scene.meshes) sums.push_back(sum_of_lengths(mesh));
    for (const bool fixed_too : {false, true}) {
        double sum = 0, count = 0;
        for (const auto& body : scene.bodies) {
            if (body.fixed && !fixed_too) continue;
            sum += sums[body.mesh];
            count += static_cast<double>(scene.meshes[body.mesh].tetrahedra.size());
        }
        if (count > 0) return sum / count;
    }
    return 0;
}

} // namespace

BodyMotion::BodyMotion(const TileTrees& trees, LaunchShape shape, std::int64_t pad)
    : trees_(trees), device_(trees.bodies().device()), shape_(shape) {
    const auto& bodies = trees.bodies();
    const auto real = real_bytes(bodies.geometry());
    const auto dop = static_cast<std::uint64_t>(bodies.geometry().k) * real;
    first_vertex_ = static_cast<std::uint32_t>(bodies.vertex_total());
    for (std::uint32_t body = 0; body < bodies.count(); ++body)
        if (bodies.scene().bodies[body].deformable)
            first_vertex_ = std::min(first_vertex_, bodies.row(body).vertices);
    upload_shapes();
    upload_pads(pad);
    state_ = device_.allocate(4 * STATE_WORDS, "state of a list");
    walked_ = device_.allocate(4 * STATUS_WORDS, "status of a list");
    saved_poses_ = device_.allocate(std::max(1u, pose_rows()) * 4 * real, "saved poses");
    saved_vertices_ = device_.allocate(std::max(1u, vertex_rows()) * 4 * real, "saved vertices");
    padded_volumes_ = device_.allocate(bodies.count() * dop, "padded volumes");
    padded_roots_ = device_.allocate(trees.tile_count() * dop, "padded roots of tiles");
    padded_uppers_ = device_.allocate(trees.uppers().bytes(), "padded upper tiles");
    const StageScope scope(device_, Stage::write);
    for (const auto* buffer : {&state_, &saved_poses_, &saved_vertices_})
        device_.clear(*buffer, buffer->bytes());
}

void BodyMotion::upload_shapes() {
    const auto& bodies = trees_.bodies();
    std::vector<std::array<double, shape_reals>> by_mesh;
    for (const auto& mesh : bodies.scene().meshes) {
        const auto ball = ball_around(mesh.vertices);
        const double reach = reach_of(mesh.vertices);
        const double radius = (ball.radius + 1e-6 * reach) * rounded_up;
        by_mesh.push_back({ball.centre.x(), ball.centre.y(), ball.centre.z(), radius, reach * rounded_up});
    }
    std::vector<double> rows;
    for (const auto& body : bodies.scene().bodies) {
        auto row = by_mesh[body.mesh];
        if (body.deformable) row[4] = -1;
        rows.insert(rows.end(), row.begin(), row.end());
    }
    shapes_ = uploaded(device_, packed(rows, bodies.geometry().precision), "balls of bodies");
}

void BodyMotion::upload_pads(std::int64_t pad) {
    const auto& bodies = trees_.bodies();
    const double largest = 1e-3 * static_cast<double>(pad) * mean_length(bodies.scene());
    std::vector<double> pads;
    for (int i = 0; i < PADS; ++i) pads.push_back(largest * std::exp2(-double(i) / PADS_PER_OCTAVE));
    pads_ = uploaded(device_, packed(pads, bodies.geometry().precision), "pads");
}

std::uint32_t BodyMotion::pose_rows() const {
    return static_cast<std::uint32_t>(pose_reals(trees_.bodies().geometry()) / 4) * trees_.bodies().count();
}

std::uint32_t BodyMotion::vertex_rows() const {
    return static_cast<std::uint32_t>(trees_.bodies().vertex_total()) - first_vertex_;
}

Grid BodyMotion::grid(std::uint64_t items) const {
    const auto wanted = (items + shape_.group_size - 1) / shape_.group_size;
    // On a processor a group of one work-item has more than one item, so that it is worth a task.
    const std::uint64_t each = device_.info().is_gpu ? 1 : 64;
    return {std::clamp<std::uint64_t>(wanted / each, 1, shape_.groups), shape_.group_size};
}

void BodyMotion::compile(Output output) {
    auto defines = geometry_defines(trees_.bodies().geometry(), shape_.group_size);
    define(defines, parameters::output, has_pairs(output) ? Output::pairs : output);
    const auto& source = kernel_source("algorithms/listed/motion.cl");
    measure_ = device_.compile(source, "measure_motion", defines);
    decide_ = device_.compile(source, "decide_list", defines);
    pad_ = device_.compile(source, "pad_bounds", defines);
}

void BodyMotion::decide(std::uint32_t request, bool given, const Buffer& status) const {
    const auto& bodies = trees_.bodies();
    const std::array<Argument, 10> measured{
        shapes_,         bodies.count(), bodies.poses(), saved_poses_, bodies.vertices(),
        saved_vertices_, first_vertex_,  vertex_rows(),  pads_,        state_};
    device_.launch(measure_, grid(bodies.count() + std::uint64_t{vertex_rows()}), measured);
    const std::array<Argument, 6> decided{pads_,  request, std::uint32_t{given ? 1u : 0u},
                                          state_, walked_, status};
    device_.launch(decide_, {1, shape_.group_size}, decided);
}

void BodyMotion::pad_bounds() const {
    const auto& bodies = trees_.bodies();
    const auto tiles = trees_.tile_count();
    const auto uppers = tiles - trees_.first_upper();
    const std::array<Argument, 11> arguments{trees_.volumes(), bodies.count(), trees_.roots(), tiles,
                                             trees_.uppers(),  uppers,         pads_,          state_,
                                             padded_volumes_,  padded_roots_,  padded_uppers_};
    const auto k = static_cast<std::uint64_t>(bodies.geometry().k);
    device_.launch(pad_, grid((bodies.count() + tiles + std::uint64_t{uppers} * TileShapes::lanes) * k),
                   arguments);
}

} // namespace tandem
