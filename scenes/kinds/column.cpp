// SPDX-License-Identifier: MIT
#include "scenes/kinds/bars.h"
#include "scenes/parameters.h"
#include "base/random.h"

#include <numbers>
#include <algorithm>
#include <utility>

namespace tandem {

namespace {

using std::numbers::pi;
constexpr std::uint64_t fold_cubes = 24; ///< along the column from one fold to the next on the same side
constexpr std::uint64_t thick_cubes = 2;
constexpr double fold_length = bar_edge * fold_cubes;
constexpr double column_overlap = 0.125; ///< of neighbouring columns in the tightest frame, m

/// Range of the line's y.
std::pair<double, double> sides(const std::vector<Section>& line) {
    const auto [left, right] = std::minmax_element(
        line.begin(), line.end(), [](const auto& a, const auto& b) { return a.centre.y() < b.centre.y(); });
    return {left->centre.y(), right->centre.y()};
}

/// A line along x whose slope is a sine of its length (Langbein and Leopold 1966). Unlike straight parts
/// between corners it is smooth, and its folds narrow at their necks when the largest slope exceeds a right
/// angle.
std::vector<Section> zigzag(std::size_t sections, double spacing, double drift, double largest_slope) {
    return plane_line(sections, spacing, drift, [largest_slope](double s) {
        return largest_slope * sine_cosine(2 * pi / fold_length * s).sine;
    });
}

/// The line turned to the y-axis, its zigzag centred.
std::vector<Section> upright(std::vector<Section> line) {
    const auto [left, right] = sides(line);
    const auto turned = [](const Eigen::Vector3d& v) { return Eigen::Vector3d(-v.y(), v.x(), v.z()); };
    for (auto& section : line) {
        section.centre.y() -= 0.5 * (left + right);
        section = {turned(section.centre), turned(section.along_y), section.along_z};
    }
    return line;
}

Scene make_column(std::span<const SceneParameter> parameters) {
    const auto folds = integer_parameter(parameters, "folds", 1, 10000);
    const auto width = integer_parameter(parameters, "width", 1, 1000);
    const double slope = real_parameter(parameters, "slope", 1, 2.2);
    const auto [left, right] = sides(zigzag(fold_cubes + 1, bar_edge, bar_drift, slope));
    const double pitch = right - left + bar_edge * thick_cubes - column_overlap;
    // Neighbours have opposite slopes and drifts, so that their folds meet.
    const Bars bars{
        .count = integer_parameter(parameters, "count", 1, 100000),
        .line =
            [slope](std::size_t sections, double spacing, double amount, std::size_t body) {
                const double side = body % 2 == 0 ? 1 : -1;
                const double largest = 0.5 * (1 + amount) * slope;
                return upright(zigzag(sections, spacing, side * bar_drift, side * largest));
            },
        .offset =
            [pitch](std::size_t body) { return Eigen::Vector3d(pitch * static_cast<double>(body), 0, 0); }};
    return scene_of(bars, bar("column", {folds * fold_cubes, thick_cubes, width}), parameters);
}

} // namespace

SceneKind column_kind() {
    return {
        "column",
        "deformable zigzag columns compressed by script until their folds overlap, then released; folds of "
        "neighbours overlap a little",
        {{"count", "1", "columns"},
         {"folds", "6", "folds on each side, 24 cubes of 0.25 m each"},
         {"width", "6", "cubes across a column, which is two cubes thick"},
         {"slope", "2", "angle of the line against the axis in the tightest frame, radians, 1..2.2"},
         {"frames", "200", "steps of 0.01 s"},
         refine_parameter()},
        make_column};
}

} // namespace tandem
