// SPDX-License-Identifier: MIT
#include "scenes/export/geometry_surfaces.h"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>

namespace tandem::exporting {

namespace {

constexpr std::size_t corner_bytes = 8;  ///< a point and a pressure, of 16 bits each number
constexpr std::size_t polygon_bytes = 1; ///< its number of corners

std::size_t first_corner(const ContactSurfaces& surfaces, std::size_t polygon) {
    return polygon == 0 ? 0 : surfaces.ends[polygon - 1];
}

/// Numbers of the largest polygons that fit, ascending.
std::vector<std::size_t> largest_polygons(const SurfaceFrames& found, std::size_t most_bytes) {
    std::vector<std::size_t> numbers(found.rows.size());
    std::iota(numbers.begin(), numbers.end(), std::size_t{0});
    if (surface_bytes(found) <= most_bytes) return numbers;
    std::ranges::stable_sort(numbers, std::ranges::greater(),
                             [&](std::size_t i) { return found.rows[i].depth; });
    std::size_t bytes = 0, shown = 0;
    for (; shown < numbers.size(); ++shown) {
        const auto corners =
            found.surfaces.ends[numbers[shown]] - first_corner(found.surfaces, numbers[shown]);
        bytes += polygon_bytes + corners * corner_bytes;
        if (bytes > most_bytes) break;
    }
    numbers.resize(shown);
    std::ranges::sort(numbers);
    return numbers;
}

std::vector<std::uint16_t> pressure_parts(const std::vector<double>& pressures, double most) {
    std::vector<std::uint16_t> parts;
    for (const double pressure : pressures)
        parts.push_back(static_cast<std::uint16_t>(
            most > 0 ? std::lround(std::clamp(pressure / most, 0.0, 1.0) * 65535) : 0));
    return parts;
}

} // namespace

std::size_t surface_bytes(const SurfaceFrames& frame) {
    return frame.rows.size() * polygon_bytes + frame.surfaces.corners.size() * corner_bytes;
}

void GeometrySurfaces::add(const SurfaceFrames& found, std::size_t most_bytes) {
    auto& shown = frames_.emplace_back();
    shown.found = found.rows.size();
    const auto& surfaces = found.surfaces;
    for (const auto i : largest_polygons(found, most_bytes)) {
        const auto first = first_corner(surfaces, i);
        shown.corners.push_back(static_cast<std::uint8_t>(surfaces.ends[i] - first));
        for (auto corner = first; corner < surfaces.ends[i]; ++corner) {
            shown.points.emplace_back(surfaces.corners[corner].data());
            shown.pressures.push_back(surfaces.pressures[corner]);
        }
    }
}

void GeometrySurfaces::write(OrderedJson& json, OrderedJson& notes) const {
    Eigen::AlignedBox3d box;
    double most = 0;
    std::size_t all = 0, shown = 0;
    for (const auto& frame : frames_) {
        box.extend(box_of(frame.points));
        for (const double pressure : frame.pressures) most = std::max(most, pressure);
        all += frame.found;
        shown += frame.corners.size();
    }
    json["most_pressure"] = most;
    const Quantised quantised(box);
    for (const auto& frame : frames_) {
        auto surfaces = points_json(frame.points, quantised);
        surfaces["found"] = frame.found;
        surfaces["corners"] = base64_of(frame.corners);
        surfaces["pressures"] = base64_of(pressure_parts(frame.pressures, most));
        json["surfaces"].push_back(std::move(surfaces));
    }
    if (shown < all)
        notes.push_back(
            fmt::format("the largest {} of {} polygons of contact surfaces are shown", shown, all));
}

} // namespace tandem::exporting
