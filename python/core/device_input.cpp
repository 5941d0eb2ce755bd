// SPDX-License-Identifier: MIT
#include "python/core/device_input.h"

#include "python/core/host_input.h"

#include <algorithm>

namespace tandem::python {

namespace {

constexpr std::size_t pose_numbers = 7, coordinates = 3;

} // namespace

DeviceRows DeviceInput::uploaded(const void* data, std::size_t bytes, Precision precision, Upload& upload) {
    if (upload.buffer.bytes() < bytes) upload.buffer = device_.allocate(bytes, "rows of the host");
    const StageScope scope(device_, Stage::write);
    device_.upload(upload.buffer, {static_cast<const std::byte*>(data), bytes});
    upload.at_rest = false;
    return {upload.buffer, precision};
}

DeviceRows DeviceInput::rows_of(const GivenRows& given, std::size_t columns, Upload& upload) {
    const auto bytes = given.rows * columns * (given.precision == Precision::fp64 ? 8 : 4);
    if (!given.on_device && device_.is_captured())
        throw InputError("enqueue() in a capture got an array in host memory, which the graph would not read "
                         "again; give arrays of the device");
    if (!given.on_device) return uploaded(given.data, bytes, given.precision, upload);
    if (given.queue && given.queue != followed_) device_.follow(*given.queue);
    if (given.queue) followed_ = given.queue;
    return {device_.adopt(given.data, bytes, "rows of an application"), given.precision};
}

DeviceRows DeviceInput::at_rest(std::size_t body, Upload& upload) {
    const auto& vertices = scene_.meshes[scene_.bodies[body].mesh].vertices;
    const auto bytes = vertices.size() * sizeof(vertices.front());
    if (!upload.at_rest) uploaded(vertices.data(), bytes, Precision::fp64, upload);
    upload.at_rest = true;
    return {upload.buffer, Precision::fp64};
}

void DeviceInput::read(const FrameArrays& arrays, Rows& rows) {
    const auto bodies = scene_.bodies.size();
    rows.uploads.resize(bodies + 1);
    rows.frame.deformed.resize(bodies);
    rows.frame.poses =
        arrays.poses ? rows_of(*arrays.poses, pose_numbers, rows.uploads.back()) : DeviceRows{};
    for (std::size_t body = 0; body < bodies; ++body) {
        if (!scene_.bodies[body].deformable) continue;
        const auto* const given = arrays.vertices_of(body);
        auto& upload = rows.uploads[body];
        rows.frame.deformed[body] =
            given != nullptr ? rows_of(*given, coordinates, upload) : at_rest(body, upload);
    }
}

DeviceFrameInput DeviceInput::frames(const Input& input) {
    followed_.reset();
    has_next_ = input.next.has_value();
    read(input.frame, frame_);
    if (!has_next_) return frame_.frame;
    read(*input.next, next_);
    return {frame_.frame, &next_.frame};
}

std::vector<std::uintptr_t> DeviceInput::addresses() const {
    const auto address = [](const DeviceRows& rows) {
        return reinterpret_cast<std::uintptr_t>(rows.buffer.native());
    };
    std::vector<std::uintptr_t> all;
    const auto add = [&](const DeviceFrame& frame) {
        all.push_back(address(frame.poses));
        for (const auto& rows : frame.deformed)
            if (rows.buffer) all.push_back(address(rows));
    };
    add(frame_.frame);
    if (has_next_) add(next_.frame);
    return all;
}

} // namespace tandem::python
