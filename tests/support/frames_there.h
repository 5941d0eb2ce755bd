// SPDX-License-Identifier: MIT
// Frames of a scene as rows of numbers, in the host's memory and brought to a device's.
#pragma once

#include "algorithms/bodies/bodies.h"
#include "algorithms/device_frame.h"
#include "backends/upload.h"

namespace tandem::testing_support {

/// A frame's rows, tx ty tz qw qx qy qz, with quaternions of a length that is not 1, and the frame that they
/// are. Where `floats`, numbers are those of float.
struct Rows {
    Rows(const Frame& frame, bool as_floats) : floats(as_floats), here(frame) {
        const auto number = [&](double x) { return floats ? static_cast<double>(static_cast<float>(x)) : x; };
        for (std::size_t body = 0; body < frame.poses.size(); ++body) {
            const auto& [q, t] = frame.poses[body];
            const double length = 0.3 + 0.7 * static_cast<double>(body);
            for (const double x :
                 {t.x(), t.y(), t.z(), q.w() * length, q.x() * length, q.y() * length, q.z() * length})
                poses.push_back(number(x));
            if (frame.deformed[body].empty()) here.poses[body] = pose_of_row(&poses[7 * body], body);
            for (auto& vertex : here.deformed[body]) vertex = vertex.unaryExpr(number);
        }
    }

    std::vector<double> vertices(std::size_t body) const {
        std::vector<double> all;
        for (const auto& vertex : here.deformed[body]) all.insert(all.end(), vertex.begin(), vertex.end());
        return all;
    }

    DeviceRows there(Device& device, const std::vector<double>& numbers) const {
        if (!floats) return {uploaded(device, bytes_of(numbers), "rows"), Precision::fp64};
        const std::vector<float> rounded(numbers.begin(), numbers.end());
        return {uploaded(device, bytes_of(rounded), "rows"), Precision::fp32};
    }

    /// In memory of the device.
    DeviceFrame there(Device& device) const {
        DeviceFrame frame{there(device, poses), std::vector<DeviceRows>(here.poses.size()), here.skipped};
        for (std::size_t body = 0; body < here.deformed.size(); ++body)
            if (!here.deformed[body].empty()) frame.deformed[body] = there(device, vertices(body));
        return frame;
    }

    bool floats;
    std::vector<double> poses;
    Frame here;
};

} // namespace tandem::testing_support
