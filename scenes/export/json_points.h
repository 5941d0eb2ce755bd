// SPDX-License-Identifier: MIT
// Numbers and points in the JSON of geometry (README.md).
#pragma once

#include "scenes/export/quantised.h"
#include "base/base64.h"

#include <nlohmann/json.hpp>
#include <span>

namespace tandem::exporting {

using OrderedJson = nlohmann::ordered_json;
using Points = std::vector<Eigen::Vector3d>;

template<class Number>
std::string base64_of(const std::vector<Number>& numbers) {
    const auto bytes = std::as_bytes(std::span(numbers));
    return base64::encode({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

inline OrderedJson json_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// Points quantised in a box, with the box.
inline OrderedJson points_json(const Points& points, const Quantised& box) {
    std::vector<std::uint16_t> coordinates;
    for (const auto& point : points) box.add(point, coordinates);
    return {
        {"lower", json_of(box.lower())}, {"size", json_of(box.size())}, {"points", base64_of(coordinates)}};
}

inline Eigen::AlignedBox3d box_of(const Points& points) {
    Eigen::AlignedBox3d box;
    for (const auto& point : points) box.extend(point);
    return box;
}

} // namespace tandem::exporting
