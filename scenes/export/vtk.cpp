// SPDX-License-Identifier: MIT
#include "scenes/export/vtk.h"

#include "scenes/export/vtk_xml.h"
#include "scenes/export/world.h"
#include "scenes/pressure_field.h"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <numeric>

namespace tandem {

namespace {

/// VTK_TETRA of vtkCellType.h.
constexpr std::uint8_t vtk_tetra = 10;

/// All bodies of a frame as one grid.
struct Grid {
    std::vector<float> points;
    std::vector<double> pressures; ///< one a point; empty unless all bodies have a field
    std::vector<std::int64_t> corners;
    std::vector<std::uint32_t> bodies, tetrahedra; ///< one a cell
};

Grid grid_of(const Scene& scene, const Frame& frame) {
    Grid grid;
    grid.points.reserve(vertex_count(scene) * 3);
    grid.corners.reserve(tetrahedron_count(scene) * 4);
    const bool have_fields = bodies_without_field(scene) == 0;
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body) {
        const auto first = static_cast<std::int64_t>(grid.points.size() / 3);
        for (const auto& v : exporting::world_vertices(scene, frame, body))
            for (const double x : v) grid.points.push_back(static_cast<float>(x));
        const auto& mesh = scene.meshes[scene.bodies[body].mesh];
        if (have_fields) std::ranges::copy(mesh.pressures, std::back_inserter(grid.pressures));
        for (std::uint32_t t = 0; t < mesh.tetrahedra.size(); ++t) {
            for (const auto vertex : mesh.tetrahedra[t]) grid.corners.push_back(first + vertex);
            grid.bodies.push_back(body);
            grid.tetrahedra.push_back(t);
        }
    }
    return grid;
}

/// Ends of `cells` cells of `corners` corners each: 4, 8, 12, ... or 1, 2, 3, ...
std::vector<std::int64_t> ends(std::size_t cells, std::int64_t corners) {
    std::vector<std::int64_t> result(cells, corners);
    std::partial_sum(result.begin(), result.end(), result.begin());
    return result;
}

/// One number a contact: field(contact).
template<class Number, class Field>
std::vector<Number> each(std::span<const ContactPoint> contacts, Field field) {
    std::vector<Number> values;
    values.reserve(contacts.size());
    for (const auto& contact : contacts) values.push_back(static_cast<Number>(field(contact)));
    return values;
}

std::vector<float> vectors(std::span<const ContactPoint> contacts,
                           std::array<double, 3> ContactPoint::*member) {
    std::vector<float> values;
    values.reserve(contacts.size() * 3);
    for (const auto& contact : contacts)
        for (const double x : contact.*member) values.push_back(static_cast<float>(x));
    return values;
}

void add_contact_data(exporting::VtkXml& xml, std::span<const ContactPoint> contacts) {
    using Contact = ContactPoint;
    xml.open("PointData Scalars=\"depth\" Normals=\"normal\"");
    xml.array("normal", 3, vectors(contacts, &Contact::normal));
    xml.array("depth", 1, each<float>(contacts, [](const Contact& c) { return c.depth; }));
    xml.array("body_a", 1, each<std::uint32_t>(contacts, [](const Contact& c) { return c.pair.body_a; }));
    xml.array("tet_a", 1, each<std::uint32_t>(contacts, [](const Contact& c) { return c.pair.tet_a; }));
    xml.array("body_b", 1, each<std::uint32_t>(contacts, [](const Contact& c) { return c.pair.body_b; }));
    xml.array("tet_b", 1, each<std::uint32_t>(contacts, [](const Contact& c) { return c.pair.tet_b; }));
    xml.array("feature", 1, each<std::uint32_t>(contacts, [](const Contact& c) { return c.feature; }));
    xml.close();
}

} // namespace

void write_vtu(const std::string& path, const Scene& scene, const Frame& frame,
               std::span<const CellNumbers> numbers) {
    const auto grid = grid_of(scene, frame);
    const auto cells = grid.bodies.size();
    exporting::VtkXml xml("UnstructuredGrid");
    xml.open("UnstructuredGrid");
    xml.open(fmt::format("Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\"", grid.points.size() / 3, cells));
    if (!grid.pressures.empty()) {
        xml.open("PointData Scalars=\"pressure\"");
        xml.array("pressure", 1, grid.pressures);
        xml.close();
    }
    xml.open("Points");
    xml.array("Points", 3, grid.points);
    xml.close();
    xml.open("Cells");
    xml.array("connectivity", 1, grid.corners);
    xml.array("offsets", 1, ends(cells, 4));
    xml.array("types", 1, std::vector<std::uint8_t>(cells, vtk_tetra));
    xml.close();
    xml.open("CellData Scalars=\"body\"");
    xml.array("body", 1, grid.bodies);
    xml.array("tetrahedron", 1, grid.tetrahedra);
    for (const auto& added : numbers) xml.array(added.name, 1, added.values);
    exporting::write_file(path, xml.finish());
}

void write_contacts_vtp(const std::string& path, std::span<const ContactPoint> contacts) {
    exporting::VtkXml xml("PolyData");
    xml.open("PolyData");
    xml.open(fmt::format("Piece NumberOfPoints=\"{0}\" NumberOfVerts=\"{0}\" NumberOfLines=\"0\" "
                         "NumberOfStrips=\"0\" NumberOfPolys=\"0\"",
                         contacts.size()));
    xml.open("Points");
    xml.array("Points", 3, vectors(contacts, &ContactPoint::point));
    xml.close();
    xml.open("Verts");
    std::vector<std::int64_t> indices(contacts.size());
    std::iota(indices.begin(), indices.end(), std::int64_t{0});
    xml.array("connectivity", 1, indices);
    xml.array("offsets", 1, ends(contacts.size(), 1));
    xml.close();
    add_contact_data(xml, contacts);
    exporting::write_file(path, xml.finish());
}

void write_pvd(const std::string& path, std::span<const TimedFile> files) {
    std::string text =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n";
    for (const auto& [time, file] : files)
        text += fmt::format("<DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", time, file);
    exporting::write_file(path, text + "</Collection>\n</VTKFile>\n");
}

} // namespace tandem
