// SPDX-License-Identifier: MIT
#include "algorithms/parameters/row_columns.h"

namespace tandem {

namespace {

using Room = std::array<double, 3>;
using Numbers = std::span<const double>;

Numbers point_of(const ContactPoint& row, Room&) { return row.point; }
Numbers normal_of(const ContactPoint& row, Room&) { return row.normal; }
Numbers depth_of(const ContactPoint& row, Room&) { return {&row.depth, 1}; }
Numbers pressure_of(const ContactPoint& row, Room&) { return {&row.pressure, 1}; }
Numbers other_point_of(const ContactPoint& row, Room& room) { return room = other_point(row); }

constexpr std::array contact_columns{
    RowColumn{"point", "px,py,pz", "length", "where the two touch", point_of},
    RowColumn{"normal", "nx,ny,nz", "1", "out of body a, of length 1", normal_of},
    RowColumn{"depth", "depth", "length", "negative inside", depth_of}};

constexpr std::array distance_columns{
    RowColumn{"point_a", "ax,ay,az", "length", "of tetrahedron a, closest to b", point_of},
    RowColumn{"point_b", "bx,by,bz", "length", "of tetrahedron b, closest to a", other_point_of},
    RowColumn{"normal", "nx,ny,nz", "1", "from point a to point b, of length 1", normal_of},
    RowColumn{"distance", "distance", "length", "negative for two that meet", depth_of}};

constexpr std::array pressure_columns{
    RowColumn{"centroid", "cx,cy,cz", "length", "of the polygon of equal pressure", point_of},
    RowColumn{"normal", "nx,ny,nz", "1", "of the polygon, into body a, of length 1", normal_of},
    RowColumn{"area", "area", "length squared", "of the polygon", depth_of},
    RowColumn{"pressure", "pressure", "that of the meshes' field", "at the centroid", pressure_of}};

Numbers count_of(const ContactPoint& row, Room& room) {
    room[0] = row.feature;
    return std::span(room).first(1);
}

constexpr std::array wrench_columns{
    RowColumn{"force", "fx,fy,fz", "pressure times length squared", "on body a", point_of},
    RowColumn{"torque", "mx,my,mz", "pressure times length cubed", "on body a, about its pose", normal_of},
    RowColumn{"area", "area", "length squared", "of all polygons of the two bodies", depth_of},
    RowColumn{"polygons", "polygons", "1", "their number", count_of}};

} // namespace

std::span<const RowColumn> row_columns(ContactRule rule, Output output) {
    if (output == Output::wrenches) return wrench_columns;
    if (has_near_pairs(rule)) return distance_columns;
    if (needs_pressures(rule)) return pressure_columns;
    return contact_columns;
}

std::string row_header(std::span<const RowColumn> columns) {
    std::string header = "frame,body_a,tet_a,body_b,tet_b";
    for (const auto& column : columns) header.append(",").append(column.csv);
    return header + '\n';
}

} // namespace tandem
