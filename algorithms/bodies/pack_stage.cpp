// SPDX-License-Identifier: MIT
#include "algorithms/bodies/pack_stage.h"

#include "algorithms/bodies/pack.h"
#include "algorithms/bodies/range.h"
#include "algorithms/kernels/sources.h"
#include "backends/upload.h"
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

constexpr std::string_view remedy = "give the frame in the host's memory";

/// ROWS_FLOAT, ROWS_DOUBLE or ROWS_NONE of pack_frame.cl.
std::uint32_t kind_of(const DeviceRows& rows) {
    if (!rows.buffer) return 2;
    return rows.precision == Precision::fp64 ? 1 : 0;
}

void check_device(const DeviceInfo& info, const Geometry& geometry) {
    if (!info.has_double)
        throw InputError(
            fmt::format("{} has no double, which packs a frame in its memory; {}", info.id, remedy));
    if (geometry.placement == Placement::exact)
        throw InputError(fmt::format("setting placement=exact bounds on the host how far vertices drift, and "
                                     "the frame is in the memory of {}; {}",
                                     info.id, remedy));
}

} // namespace

PackStage::PackStage(const Bodies& bodies, LaunchShape shape)
    : bodies_(bodies),
      shape_(shape),
      limit_(largest_coordinate(bodies.geometry())),
      deformable_(deformable_bodies(bodies.scene())) {
    auto& device = bodies.device();
    const auto& scene = bodies.scene();
    check_device(device.info(), bodies.geometry());
    const auto defines = row_defines(bodies.geometry(), shape.group_size);
    compile_kernel(device, poses_, defines);
    compile_kernel(device, vertices_, defines);
    if (bodies.geometry().motion == Motion::linear) compile_kernel(device, arcs_, defines);
    std::vector<std::uint32_t> indices;
    std::vector<double> pressures;
    for (std::uint32_t mesh = 0; mesh < scene.meshes.size(); ++mesh) {
        first_indices_.push_back(static_cast<std::uint32_t>(indices.size()));
        const auto deforms = [&](const Body& body) { return body.deformable && body.mesh == mesh; };
        if (std::ranges::none_of(scene.bodies, deforms)) continue;
        const auto& numbers = bodies.ordered_mesh(mesh).numbers;
        indices.insert(indices.end(), numbers.begin(), numbers.end());
        const auto own = bodies.pressures(mesh);
        pressures.insert(pressures.end(), own.begin(), own.end());
    }
    if (!pressures.empty()) {
        std::vector<std::byte> bytes;
        pack_reals(bytes, bodies.geometry(), pressures);
        pressures_ = uploaded(device, bytes, "pressures of vertices");
    }
    indices_ = uploaded(device, bytes_of(indices), "row indices of vertices");
    if (scene.shifts.empty()) return;
    std::vector<double> shifts;
    for (const auto& body : scene.bodies)
        for (const double number : scene.shifts[body.mesh]) shifts.push_back(number);
    shifts_ = uploaded(device, bytes_of(shifts), "shifts of meshes");
}

Grid PackStage::grid_over(std::uint64_t count) const {
    const auto groups = (count + shape_.group_size - 1) / shape_.group_size;
    return {std::clamp<std::uint64_t>(groups, 1, shape_.groups), shape_.group_size};
}

void PackStage::pack_poses(const DeviceRows& rows, const Buffer& poses, const Eigen::Vector3d& origin,
                           const Buffer& status) const {
    const bool has_shifts = static_cast<bool>(shifts_);
    const kernels::pack_frame::PackPoses arguments{.poses = poses,
                                                   .rows = rows.buffer ? rows.buffer : bodies_.row_table(),
                                                   .kind = kind_of(rows),
                                                   .bodies = bodies_.row_table(),
                                                   .count = bodies_.count(),
                                                   .limit = limit_,
                                                   .origin_x = origin.x(),
                                                   .origin_y = origin.y(),
                                                   .origin_z = origin.z(),
                                                   .shifts = has_shifts ? shifts_ : bodies_.row_table(),
                                                   .has_shifts = has_shifts ? 1u : 0u,
                                                   .status = status};
    bodies_.device().launch(poses_, grid_over(bodies_.count()), arguments);
}

void PackStage::pack_arcs(const DeviceRows& rows, const DeviceRows& next_rows) const {
    const auto buffer = [&](const DeviceRows& r) { return r.buffer ? r.buffer : bodies_.row_table(); };
    const kernels::pack_frame::PackArcs arguments{.poses = bodies_.poses(),
                                                  .next_poses = bodies_.next_poses(),
                                                  .rows = buffer(rows),
                                                  .kind = kind_of(rows),
                                                  .next_rows = buffer(next_rows),
                                                  .next_kind = kind_of(next_rows),
                                                  .bodies = bodies_.row_table(),
                                                  .count = bodies_.count()};
    bodies_.device().launch(arcs_, grid_over(bodies_.count()), arguments);
}

void PackStage::pack_vertices(std::size_t body, const DeviceRows& rows, const Buffer& vertices,
                              const Eigen::Vector3d& origin, const Buffer& status) const {
    const auto count = static_cast<std::uint32_t>(bodies_.mesh(body).numbers.size());
    const auto first_index = first_indices_[bodies_.scene().bodies[body].mesh];
    const kernels::pack_frame::PackVertices arguments{.vertices = vertices,
                                                      .first = bodies_.row(body).vertices,
                                                      .indices = indices_,
                                                      .indices_first = first_index,
                                                      .rows = rows.buffer,
                                                      .kind = kind_of(rows),
                                                      .count = count,
                                                      .limit = limit_,
                                                      .origin_x = origin.x(),
                                                      .origin_y = origin.y(),
                                                      .origin_z = origin.z(),
                                                      .pressures = pressures_ ? pressures_ : vertices,
                                                      .has_pressures = pressures_ ? 1u : 0u,
                                                      .status = status};
    bodies_.device().launch(vertices_, grid_over(count), arguments);
}

void PackStage::pack(const DeviceFrame& frame, const Buffer& poses, const Buffer& vertices,
                     const Eigen::Vector3d& origin, const Buffer& status) const {
    pack_poses(frame.poses, poses, origin, status);
    for (const auto body : deformable_) pack_vertices(body, frame.deformed[body], vertices, origin, status);
}

void PackStage::launch(const DeviceFrameInput& input, const Eigen::Vector3d& origin,
                       const Buffer& status) const {
    const StageScope scope(bodies_.device(), Stage::preprocess);
    pack(input.frame, bodies_.poses(), bodies_.vertices(), origin, status);
    if (input.next == nullptr) return;
    pack(*input.next, bodies_.next_poses(), bodies_.next_vertices(), origin, status);
    pack_arcs(input.frame.poses, input.next->poses);
}

} // namespace tandem
