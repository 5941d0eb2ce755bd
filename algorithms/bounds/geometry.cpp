// SPDX-License-Identifier: MIT
#include "algorithms/bounds/geometry.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

namespace tandem {

namespace {

using Direction = std::array<int, 3>;

/// Directions of k-DOPs, one for each pair of parallel planes. Integers, so that a projection is a sum of
/// coordinates.
constexpr Direction coordinates[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
constexpr Direction corners[] = {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {1, -1, -1}};
constexpr Direction edges[] = {{1, 1, 0}, {1, -1, 0}, {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}};

constexpr std::array<const Parameter*, 9> declared{
    &parameters::k,        &parameters::axes,      &parameters::precision,
    &parameters::rounding, &parameters::placement, &parameters::origin,
    &parameters::motion,   &parameters::margin,    &parameters::pressure_slab};

} // namespace

/// Coordinates, diagonals of the cube, diagonals of its faces, in this order. k = 8 has the paper's four cube
/// diagonals, or three coordinates and one diagonal.
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

std::span<const Parameter* const> geometry_parameters() { return declared; }

Geometry geometry_of(const Settings& settings) {
    Geometry geometry;
    geometry.k = settings[parameters::k];
    geometry.coordinate_axes = settings[parameters::axes] == Axes::coordinate;
    geometry.precision = settings[parameters::precision];
    geometry.rounding = settings[parameters::rounding];
    geometry.placement = settings[parameters::placement];
    geometry.origin = settings[parameters::origin];
    geometry.motion = settings[parameters::motion];
    geometry.margin = settings[parameters::margin];
    geometry.pressure_slab = bounds_pressures(settings);
    geometry.pressures = has_polygons(settings) || geometry.pressure_slab;
    if (geometry.coordinate_axes && geometry.k != 8)
        throw InputError("setting axes=coordinate goes with k=8 only; leave axes out for other k");
    if (geometry.placement == Placement::exact && geometry.rounding != Rounding::safe
        && geometry.rounding != Rounding::directed)
        throw InputError("setting placement=exact goes with rounding=safe or directed, which widen slabs by "
                         "the bound it needs; leave rounding or placement out");
    // The difference is rounded once in double, which these bounds do not cover.
    if (geometry.placement == Placement::exact && geometry.precision == Precision::fp64)
        geometry.origin = Origin::world;
    if (geometry.motion == Motion::linear && geometry.rounding == Rounding::published)
        throw InputError("setting motion=linear does not go with rounding=published, which has no bound for "
                         "positions between frames; choose rounding=safe");
    if (geometry.margin > 0 && geometry.rounding == Rounding::published)
        throw InputError("setting margin does not go with rounding=published, whose bounds promise no "
                         "distance; choose rounding=safe");
    return geometry;
}

float reach_of_margin(const Geometry& geometry) {
    if (!(geometry.margin > 0)) return 0;
    const double reach = geometry.margin / 2 * (1 + 0x1p-20);
    auto rounded = static_cast<float>(reach);
    if (double{rounded} < reach) rounded = std::nextafter(rounded, std::numeric_limits<float>::infinity());
    return std::max(rounded, std::numeric_limits<float>::min()); // a device may round smaller ones to 0
}

Defines row_defines(const Geometry& geometry, std::uint32_t group_size) {
    Defines defines;
    define(defines, parameters::precision, geometry.precision);
    define(defines, parameters::placement, geometry.placement);
    define(defines, parameters::motion, geometry.motion);
    define(defines, parameters::group_size, group_size);
    return defines;
}

Defines geometry_defines(const Geometry& geometry, std::uint32_t group_size) {
    auto defines = row_defines(geometry, group_size);
    define(defines, parameters::k, ends_of_node(geometry));
    define(defines, parameters::pressure_slab, geometry.pressure_slab);
    define(defines, parameters::axes, geometry.coordinate_axes ? Axes::coordinate : Axes::standard);
    define(defines, parameters::rounding, geometry.rounding);
    if (geometry.margin > 0) defines["MARGIN"] = "1";
    return defines;
}

} // namespace tandem
