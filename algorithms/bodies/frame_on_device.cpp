// SPDX-License-Identifier: MIT
#include "algorithms/bodies/frame_on_device.h"

#include "algorithms/bodies/range.h"
#include "base/error.h"
#include "base/quaternion.h"

#include <fmt/format.h>

namespace tandem {

namespace {

constexpr std::size_t pose_numbers = 7;

std::size_t bytes_of_number(const DeviceRows& rows) { return rows.precision == Precision::fp64 ? 8 : 4; }

std::vector<double> numbers_of(Device& device, const DeviceRows& rows, std::size_t count) {
    const StageScope scope(device, Stage::read);
    std::vector<double> numbers(count);
    if (rows.precision == Precision::fp64) {
        device.download(rows.buffer, std::as_writable_bytes(std::span(numbers)));
        return numbers;
    }
    std::vector<float> floats(count);
    device.download(rows.buffer, std::as_writable_bytes(std::span(floats)));
    numbers.assign(floats.begin(), floats.end());
    return numbers;
}

template<class Name>
void check_capacity(const DeviceRows& rows, std::size_t numbers, const Name& name) {
    const auto bytes = numbers * bytes_of_number(rows);
    if (rows.buffer.bytes() < bytes)
        throw InputError(fmt::format("{}: a buffer of {} bytes is too small for {} numbers of {} bytes",
                                     name(), rows.buffer.bytes(), numbers, bytes_of_number(rows)));
}

} // namespace

Pose pose_of_row(const double* row, std::size_t body) {
    const auto rotation = given_rotation(row[3], row[4], row[5], row[6]);
    if (!rotation)
        throw InputError(fmt::format("poses: row {} has no rotation; give tx ty tz qw qx qy qz with a "
                                     "quaternion that is finite and not 0",
                                     body));
    const Eigen::Vector3d translation(row[0], row[1], row[2]);
    if (!translation.allFinite())
        throw InputError(fmt::format("poses: row {} is not finite; give tx ty tz qw qx qy qz", body));
    return {*rotation, translation};
}

void check_fits(const Scene& scene, std::span<const std::uint32_t> deformable, const DeviceFrame& frame) {
    if (frame.poses.buffer)
        check_capacity(frame.poses, scene.bodies.size() * pose_numbers, [] { return "poses"; });
    if (frame.deformed.size() != scene.bodies.size() && !(frame.deformed.empty() && deformable.empty()))
        throw InputError(fmt::format("the frame has {} entries of vertices for {} bodies; give one per body",
                                     frame.deformed.size(), scene.bodies.size()));
    for (const auto body : deformable)
        check_capacity(frame.deformed[body], 3 * scene.meshes[scene.bodies[body].mesh].vertices.size(),
                       [body] { return fmt::format("vertices of body {}", body); });
}

Frame downloaded(Device& device, const Scene& scene, const DeviceFrame& frame) {
    const auto bodies = scene.bodies.size();
    Frame frame_on_host{std::vector<Pose>(bodies), std::vector<std::vector<Eigen::Vector3d>>(bodies),
                        frame.skipped};
    std::vector<double> rows;
    if (frame.poses.buffer) rows = numbers_of(device, frame.poses, bodies * pose_numbers);
    for (std::size_t body = 0; body < bodies; ++body) {
        if (!scene.bodies[body].deformable) {
            if (!rows.empty()) frame_on_host.poses[body] = pose_of_row(&rows[body * pose_numbers], body);
            continue;
        }
        const auto count = scene.meshes[scene.bodies[body].mesh].vertices.size();
        const auto numbers = numbers_of(device, frame.deformed[body], 3 * count);
        for (std::size_t v = 0; v < count; ++v) frame_on_host.deformed[body].emplace_back(&numbers[3 * v]);
    }
    return frame_on_host;
}

void refuse_flawed(Device& device, const Scene& scene, const DeviceFrameInput& input,
                   const Geometry& geometry, std::uint64_t flawed) {
    check_range(scene, downloaded(device, scene, input.frame), geometry);
    if (input.next != nullptr)
        of_successor([&] { check_range(scene, downloaded(device, scene, *input.next), geometry); });
    throw InputError(
        fmt::format("{} rows of the frame were out of range on {} and have changed since; do not "
                    "write them before run() returns",
                    flawed, device.info().id));
}

} // namespace tandem
