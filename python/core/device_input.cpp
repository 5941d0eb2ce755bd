// SPDX-License-Identifier: MIT
#include "python/core/device_input.h"

#include "base/error.h"

#include <fmt/format.h>

namespace tandem::python {

namespace {

constexpr std::size_t pose_numbers = 7, coordinates = 3;
constexpr std::size_t max_adopted = 64;

} // namespace

/// One handle per array. At max_adopted all are released, for libraries that never reuse memory.
Buffer DeviceInput::adopted(void* data, std::size_t bytes) {
    const auto found = adopted_.find({data, bytes});
    if (found != adopted_.end()) return found->second;
    if (adopted_.size() >= max_adopted) adopted_.clear();
    return adopted_[{data, bytes}] = device_.adopt(data, bytes, "rows of an application");
}

DeviceRows DeviceInput::uploaded(const void* data, std::size_t bytes, Precision precision, Upload& upload) {
    if (upload.buffer.bytes() < bytes) upload.buffer = device_.allocate(bytes, "rows of the host");
    const StageScope scope(device_, Stage::write);
    device_.upload(upload.buffer, {static_cast<const std::byte*>(data), bytes});
    upload.at_rest = false;
    return {upload.buffer, precision};
}

DeviceRows DeviceInput::rows_of(const GivenRows& given, std::size_t columns, Upload& upload) {
    const auto bytes = given.rows * columns * (given.precision == Precision::fp64 ? 8 : 4);
    if (!given.on_device) return uploaded(given.data, bytes, given.precision, upload);
    if (given.queue && given.queue != followed_) device_.follow(*given.queue);
    if (given.queue) followed_ = given.queue;
    return {adopted(given.data, bytes), given.precision};
}

DeviceRows DeviceInput::at_rest(std::size_t body) {
    auto& upload = uploads_[body];
    const auto& vertices = scene_.meshes[scene_.bodies[body].mesh].vertices;
    const auto bytes = vertices.size() * sizeof(vertices.front());
    if (!upload.at_rest) uploaded(vertices.data(), bytes, Precision::fp64, upload);
    upload.at_rest = true;
    return {upload.buffer, Precision::fp64};
}

const DeviceFrame& DeviceInput::frame(const std::optional<GivenRows>& poses,
                                      const std::vector<std::optional<GivenRows>>& vertices) {
    const auto bodies = scene_.bodies.size();
    frame_.deformed.resize(bodies);
    followed_.reset();
    if (poses && poses->rows != bodies)
        throw InputError(
            fmt::format("poses: {} rows for {} bodies; give each body its row", poses->rows, bodies));
    frame_.poses = poses ? rows_of(*poses, pose_numbers, uploads_.back()) : DeviceRows{};
    for (std::size_t body = 0; body < bodies; ++body) {
        if (!scene_.bodies[body].deformable) continue;
        const auto count = scene_.meshes[scene_.bodies[body].mesh].vertices.size();
        const bool given = body < vertices.size() && vertices[body];
        if (given && vertices[body]->rows != count)
            throw InputError(fmt::format("vertices: {} rows for body {}, whose mesh has {} vertices",
                                         vertices[body]->rows, body, count));
        frame_.deformed[body] = given ? rows_of(*vertices[body], coordinates, uploads_[body]) : at_rest(body);
    }
    return frame_;
}

std::vector<std::uintptr_t> DeviceInput::addresses() const {
    const auto address = [](const DeviceRows& rows) {
        return reinterpret_cast<std::uintptr_t>(rows.buffer.native());
    };
    std::vector<std::uintptr_t> all{address(frame_.poses)};
    for (const auto& rows : frame_.deformed)
        if (rows.buffer) all.push_back(address(rows));
    return all;
}

} // namespace tandem::python
