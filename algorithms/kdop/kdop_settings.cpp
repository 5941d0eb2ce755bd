// SPDX-License-Identifier: MIT
#include "algorithms/kdop/kdop_settings.h"

#include "scenes/error.h"

#include <algorithm>
#include <initializer_list>

namespace tandem {

namespace {

using Direction = std::array<int, 3>;

constexpr Direction coordinates[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
constexpr Direction corners[] = {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {1, -1, -1}};
constexpr Direction edges[] = {{1, 1, 0}, {1, -1, 0}, {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}};

const std::vector<Parameter> parameters{
    {"k",
     "18",
     {"6", "8", "12", "14", "16", "18", "20", "24", "26"},
     0,
     0,
     "planes of the k-DOPs (k/2 directions)"},
    {"axes",
     "standard",
     {"standard", "coordinate"},
     0,
     0,
     "k=8: standard = the paper's four cube diagonals, coordinate = x, y, z and one diagonal"},
    {"precision", "float", {"float", "double"}, 0, 0, "of vertices, slabs and contacts"},
    {"rounding",
     "safe",
     {"nearest", "safe", "published", "directed"},
     0,
     0,
     "safe widens diagonal slabs by their rounding bound: nothing is missed; published: unit directions, "
     "a fixed tolerance, as the paper's code; directed (CUDA): slabs contain the exact ones"},
    {"truth",
     "t1",
     {"t1", "t2"},
     0,
     0,
     "whose contacts no slab may miss: t1 those of the world vertices as rounded, t2 those of the scene's "
     "own poses and vertices, moved without rounding (safe and directed, wider slabs)"},
};

Rounding rounding_of(const std::string& name) {
    if (name == "nearest") return Rounding::nearest;
    if (name == "published") return Rounding::published;
    return name == "directed" ? Rounding::directed : Rounding::safe;
}

} // namespace

std::vector<Direction> directions(const Geometry& geometry) {
    std::vector<Direction> result;
    const auto add = [&](auto& set, std::size_t count) { result.insert(result.end(), set, set + count); };
    const auto is_one_of = [k = geometry.k](std::initializer_list<int> all) {
        return std::find(all.begin(), all.end(), k) != all.end();
    };
    if (geometry.coordinate_axes || !is_one_of({8, 12, 20})) add(coordinates, 3);
    if (geometry.coordinate_axes)
        add(corners, 1);
    else if (is_one_of({8, 14, 20, 26}))
        add(corners, 4);
    else if (geometry.k == 24)
        result.insert(result.end(), corners + 1, corners + 4);
    if (is_one_of({12, 18, 20, 24, 26})) add(edges, 6);
    if (geometry.k == 16) add(edges, 5);
    return result;
}

std::span<const Parameter> geometry_parameters() { return parameters; }

Geometry geometry_of(const Settings& settings) {
    Geometry geometry;
    geometry.k = static_cast<int>(integer(settings, "k"));
    geometry.coordinate_axes = settings.at("axes") == "coordinate";
    geometry.precision = settings.at("precision") == "double" ? Precision::twice : Precision::single;
    geometry.rounding = rounding_of(settings.at("rounding"));
    geometry.truth = settings.at("truth") == "t2" ? Truth::pose : Truth::vertices;
    if (geometry.coordinate_axes && geometry.k != 8)
        throw InputError("setting axes=coordinate goes with k=8 only; leave axes out for other k");
    if (geometry.truth == Truth::pose && geometry.rounding != Rounding::safe
        && geometry.rounding != Rounding::directed)
        throw InputError(
            "setting truth=t2 goes with rounding=safe or directed, which widen slabs by the bound "
            "it needs; leave rounding or truth out");
    return geometry;
}

Defines row_defines(const Geometry& geometry, std::uint32_t group_size) {
    return {{"PRECISION", geometry.precision == Precision::twice ? "64" : "32"},
            {"TRUTH", std::to_string(static_cast<int>(geometry.truth))},
            {"GROUP_SIZE", std::to_string(group_size)}};
}

Defines geometry_defines(const Geometry& geometry, std::uint32_t group_size) {
    auto defines = row_defines(geometry, group_size);
    defines["K"] = std::to_string(geometry.k);
    defines["AXES"] = geometry.coordinate_axes ? "1" : "0";
    defines["ROUNDING"] = std::to_string(static_cast<int>(geometry.rounding));
    return defines;
}

} // namespace tandem
