// SPDX-License-Identifier: MIT
#include "scenes/kinds/bars.h"
#include "scenes/parameters.h"
#include "base/random.h"

#include <numbers>
#include <algorithm>

namespace tandem {

namespace {

using std::numbers::pi;
constexpr double neck = 1.5 * bar_edge;  ///< radius of the arcs on both sides of a loop
constexpr double neck_angle = pi / 3;    ///< of these arcs; its cosine of 1/2 makes the distance exact
constexpr double sheet_overlap = 0.0625; ///< of the width, between neighbouring sheets
constexpr double added_gap = 1;          ///< of layers at the start, in thicknesses

/// A fold in the form of a drop: an arc of radius `neck`, a loop of radius `loop` in the other direction, an
/// arc. The parts that it connects are then parallel, loop - neck apart, which a single arc cannot do below a
/// thickness.
struct Fold {
    double loop;

    double neck_length() const { return neck * neck_angle; }
    double loop_length() const { return loop * (pi + 2 * neck_angle); }
    double length() const { return 2 * neck_length() + loop_length(); }
    /// Angle after the length s of the fold: 0 before it, pi behind it.
    double angle(double s) const {
        const double first = std::clamp(s, 0.0, neck_length());
        const double middle = std::clamp(s - neck_length(), 0.0, loop_length());
        const double last = std::clamp(s - neck_length() - loop_length(), 0.0, neck_length());
        return middle / loop - (first + last) / neck;
    }
};

/// A line with two folds of opposite directions. They turn first, and close when the layers are almost
/// parallel: layers meet beside the folds, and more of them in every frame.
std::vector<Section> folded(std::size_t sections, double spacing, double gap, double amount) {
    const Fold fold{neck + bar_edge * (gap + added_gap * (1 - amount))};
    const double layer = (spacing * static_cast<double>(sections - 1) - 2 * fold.length()) / 3;
    const double turned = amount * (2 - amount);
    return plane_line(sections, spacing, bar_drift, [=](double s) {
        return turned * (fold.angle(s - layer) - fold.angle(s - 2 * layer - fold.length()));
    });
}

Scene make_sheet(std::span<const SceneParameter> parameters) {
    const auto length = integer_parameter(parameters, "length", 60, 100000);
    const auto width = integer_parameter(parameters, "width", 1, 5000);
    const double gap = real_parameter(parameters, "gap", 0.5, 1.5);
    const double pitch = (1 - sheet_overlap) * bar_edge * static_cast<double>(width);
    const Bars bars{.count = integer_parameter(parameters, "count", 1, 100000),
                    .line = [=](std::size_t sections, double spacing, double amount,
                                std::size_t) { return folded(sections, spacing, gap, amount); },
                    .offset =
                        [=](std::size_t body) {
                            const auto number = static_cast<double>(body);
                            return Eigen::Vector3d(0, 1.5 * bar_edge * number, pitch * number);
                        }};
    return scene_of(bars, bar("sheet", {length, 1, width}), parameters);
}

} // namespace

SceneKind sheet_kind() {
    return {
        "sheet",
        "deformable sheets folded in three like a letter by script until the layers overlap, then unfolded; "
        "neighbours overlap at their edges",
        {{"count", "1", "sheets"},
         {"length", "120", "cubes of 0.25 m along a sheet, which is one cube thick"},
         {"width", "24", "cubes across it"},
         {"gap", "0.9", "distance of layers in the tightest frame, in thicknesses, 0.5..1.5"},
         {"frames", "200", "steps of 0.01 s"},
         refine_parameter()},
        make_sheet};
}

} // namespace tandem
