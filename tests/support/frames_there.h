// SPDX-License-Identifier: MIT
// Frames of a scene as rows of numbers, in host memory and in device memory.
#pragma once

#include "algorithms/bodies/bodies.h"
#include "algorithms/bodies/device_frame.h"
#include "backends/upload.h"

namespace tandem::support {

/// A frame as rows tx ty tz qw qx qy qz, with quaternions that are not normalized, and the equivalent host
/// frame. With `floats`, all numbers are representable as float.
struct Rows {
    Rows(const Frame& frame, bool as_floats) : floats(as_floats), host(frame) {
        const auto number = [&](double x) { return floats ? static_cast<double>(static_cast<float>(x)) : x; };
        for (std::size_t body = 0; body < frame.poses.size(); ++body) {
            const auto& [q, t] = frame.poses[body];
            const double length = 0.3 + 0.7 * static_cast<double>(body);
            for (const double x :
                 {t.x(), t.y(), t.z(), q.w() * length, q.x() * length, q.y() * length, q.z() * length})
                poses.push_back(number(x));
            if (frame.deformed[body].empty()) host.poses[body] = pose_of_row(&poses[7 * body], body);
            for (auto& vertex : host.deformed[body]) vertex = vertex.unaryExpr(number);
        }
    }

    std::vector<double> vertices(std::size_t body) const {
        std::vector<double> all;
        for (const auto& vertex : host.deformed[body]) all.insert(all.end(), vertex.begin(), vertex.end());
        return all;
    }

    DeviceRows uploaded_to(Device& device, const std::vector<double>& numbers) const {
        if (!floats) return {uploaded(device, bytes_of(numbers), "rows"), Precision::fp64};
        const std::vector<float> rounded(numbers.begin(), numbers.end());
        return {uploaded(device, bytes_of(rounded), "rows"), Precision::fp32};
    }

    /// Uploads the whole frame to the device.
    DeviceFrame uploaded_to(Device& device) const {
        DeviceFrame frame{uploaded_to(device, poses), std::vector<DeviceRows>(host.poses.size()),
                          host.skipped};
        for (std::size_t body = 0; body < host.deformed.size(); ++body)
            if (!host.deformed[body].empty()) frame.deformed[body] = uploaded_to(device, vertices(body));
        return frame;
    }

    bool floats;
    std::vector<double> poses;
    Frame host;
};

} // namespace tandem::support
