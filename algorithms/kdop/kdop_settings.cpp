// SPDX-License-Identifier: MIT
#include "algorithms/kdop/kdop_settings.h"

#include "scenes/error.h"

namespace tandem {

namespace {

using Direction = std::array<int, 3>;

constexpr Direction coordinates[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
constexpr Direction corners[] = {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {1, -1, -1}};
constexpr Direction edges[] = {{1, 1, 0}, {1, -1, 0}, {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}};

const std::vector<Parameter> parameters{
    {"k", "18", {"6", "8", "14", "18", "26"}, 0, 0, "planes of the k-DOPs (k/2 directions)"},
    {"axes",
     "standard",
     {"standard", "coordinate"},
     0,
     0,
     "k=8: standard = the paper's four cube diagonals, coordinate = x, y, z and one diagonal"},
    {"precision", "float", {"float", "double"}, 0, 0, "of vertices, slabs and contacts"},
    {"rounding",
     "safe",
     {"nearest", "safe"},
     0,
     0,
     "safe widens diagonal slabs by their rounding bound: nothing is missed"},
};

} // namespace

std::vector<Direction> directions(const Geometry& geometry) {
    std::vector<Direction> result;
    const auto add = [&](auto& set, std::size_t count) { result.insert(result.end(), set, set + count); };
    if (geometry.k != 8 || geometry.coordinate_axes) add(coordinates, 3);
    if (geometry.k == 14 || geometry.k == 26 || (geometry.k == 8 && !geometry.coordinate_axes))
        add(corners, 4);
    if (geometry.k == 8 && geometry.coordinate_axes) add(corners, 1);
    if (geometry.k == 18 || geometry.k == 26) add(edges, 6);
    return result;
}

std::span<const Parameter> geometry_parameters() { return parameters; }

Geometry geometry_of(const Settings& settings) {
    Geometry geometry;
    geometry.k = static_cast<int>(integer(settings, "k"));
    geometry.coordinate_axes = settings.at("axes") == "coordinate";
    geometry.precision = settings.at("precision") == "double" ? Precision::twice : Precision::single;
    geometry.rounding = settings.at("rounding") == "safe" ? Rounding::safe : Rounding::nearest;
    if (geometry.coordinate_axes && geometry.k != 8)
        throw InputError("setting axes=coordinate goes with k=8 only; leave axes out for other k");
    return geometry;
}

Defines geometry_defines(const Geometry& geometry, std::uint32_t group_size) {
    return {{"K", std::to_string(geometry.k)},
            {"AXES", geometry.coordinate_axes ? "1" : "0"},
            {"PRECISION", geometry.precision == Precision::twice ? "64" : "32"},
            {"ROUNDING", geometry.rounding == Rounding::safe ? "1" : "0"},
            {"GROUP_SIZE", std::to_string(group_size)}};
}

} // namespace tandem
