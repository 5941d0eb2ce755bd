// SPDX-License-Identifier: MIT
#include "scenes/export/surfaces.h"

#include "scenes/export/vtk_xml.h"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>

namespace tandem {

namespace {

std::vector<double> flat(std::span<const std::array<double, 3>> points) {
    std::vector<double> numbers;
    numbers.reserve(3 * points.size());
    for (const auto& point : points) numbers.insert(numbers.end(), point.begin(), point.end());
    return numbers;
}

template<class Number, class Field>
std::vector<Number> column(std::span<const ContactPoint> rows, Field field) {
    std::vector<Number> values;
    values.reserve(rows.size());
    for (const auto& row : rows) values.push_back(field(row));
    return values;
}

void add_cell_data(exporting::VtkXml& xml, const SurfaceFrames& all) {
    using Row = ContactPoint;
    const std::span<const Row> rows = all.rows;
    xml.open("CellData Scalars=\"pressure\" Normals=\"normal\"");
    xml.array("pressure", 1, column<double>(rows, [](const Row& r) { return r.pressure; }));
    xml.array("normal", 3, flat(column<std::array<double, 3>>(rows, [](const Row& r) { return r.normal; })));
    xml.array("area", 1, column<double>(rows, [](const Row& r) { return r.depth; }));
    xml.array("frame", 1, all.frames);
    xml.array("body_a", 1, column<std::uint32_t>(rows, [](const Row& r) { return r.pair.body_a; }));
    xml.array("tet_a", 1, column<std::uint32_t>(rows, [](const Row& r) { return r.pair.tet_a; }));
    xml.array("body_b", 1, column<std::uint32_t>(rows, [](const Row& r) { return r.pair.body_b; }));
    xml.array("tet_b", 1, column<std::uint32_t>(rows, [](const Row& r) { return r.pair.tet_b; }));
    xml.close();
}

} // namespace

void SurfaceFrames::add(std::uint32_t frame, std::span<const ContactPoint> more,
                        const ContactSurfaces& corners) {
    frames.resize(frames.size() + more.size(), frame);
    rows.insert(rows.end(), more.begin(), more.end());
    const auto first = surfaces.corners.size();
    surfaces.corners.insert(surfaces.corners.end(), corners.corners.begin(), corners.corners.end());
    surfaces.pressures.insert(surfaces.pressures.end(), corners.pressures.begin(), corners.pressures.end());
    for (const auto end : corners.ends) surfaces.ends.push_back(first + end);
}

double SurfaceFrames::most_pressure() const {
    return surfaces.pressures.empty() ? 0 : std::ranges::max(surfaces.pressures);
}

std::string surfaces_vtp(const SurfaceFrames& all) {
    const auto& [corners, pressures, ends] = all.surfaces;
    exporting::VtkXml xml("PolyData");
    xml.open("PolyData");
    xml.open(fmt::format("Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
                         "NumberOfStrips=\"0\" NumberOfPolys=\"{}\"",
                         corners.size(), all.rows.size()));
    xml.open("Points");
    xml.array("Points", 3, flat(corners));
    xml.close();
    xml.open("Polys");
    std::vector<std::int64_t> indices(corners.size());
    std::iota(indices.begin(), indices.end(), std::int64_t{0});
    xml.array("connectivity", 1, indices);
    xml.array("offsets", 1, std::vector<std::int64_t>(ends.begin(), ends.end()));
    xml.close();
    xml.open("PointData Scalars=\"pressure\"");
    xml.array("pressure", 1, pressures);
    xml.close();
    add_cell_data(xml, all);
    return xml.finish();
}

} // namespace tandem
