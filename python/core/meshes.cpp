// SPDX-License-Identifier: MIT
#include "python/core/meshes.h"

#include "python/core/arrays.h"
#include "scenes/mesh.h"
#include "scenes/read/read.h"
#include "scenes/weld.h"

#include <fmt/format.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace nb = nanobind;

namespace tandem::python {

namespace {

static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double) && sizeof(Tetrahedron) == 4 * sizeof(uint32_t));

Mesh mesh_of(const Points& vertices, const Corners& tetrahedra, const std::string& name) {
    const nb::gil_scoped_release released;
    Mesh mesh;
    mesh.name = name;
    copy_points(vertices, mesh.vertices);
    const auto* const first = reinterpret_cast<const Tetrahedron*>(tetrahedra.data());
    mesh.tetrahedra.assign(first, first + tetrahedra.shape(0));
    complete_mesh(mesh, name);
    mesh.findings.coincident = count_coincident(mesh);
    return mesh;
}

Mesh parsed(const nb::bytes& data, const std::string& name) {
    const std::string_view view(data.c_str(), data.size());
    const nb::gil_scoped_release released;
    auto mesh = parse_mesh(view, name);
    mesh.name = name;
    complete_mesh(mesh, name);
    mesh.findings.coincident = count_coincident(mesh);
    return mesh;
}

/// For pickling: the function and its arguments that make the mesh again.
nb::tuple reduced(nb::handle self) {
    return nb::make_tuple(nb::module_::import_("tandem.meshes").attr("make_mesh"),
                          nb::make_tuple(self.attr("vertices"), self.attr("tetrahedra"), self.attr("name")));
}

} // namespace

void bind_meshes(nb::module_& module) {
    nb::class_<Mesh>(
        module, "Mesh",
        "Checked vertices and tetrahedra: every index is in range, every coordinate is finite.\n\n"
        "vertices: (n, 3) float64, in the unit of the scene. tetrahedra: (m, 4) uint32, indices of "
        "vertices; answers number tetrahedra in this order. Both are read-only "
        "views of the mesh's own memory. inverted and degenerate count tetrahedra of negative "
        "and of zero volume; the mesh keeps them. merged lists duplicates of earlier tetrahedra, "
        "which are in no answer; findings is one line about them and about coincident vertices, or empty.")
        .def_prop_ro("vertices",
                     [](nb::handle self) {
                         const auto& rows = nb::cast<const Mesh&>(self).vertices;
                         return nb::ndarray<nb::numpy, const double, nb::shape<-1, 3>>(
                             rows.data(), {rows.size(), 3}, self);
                     })
        .def_prop_ro("tetrahedra",
                     [](nb::handle self) {
                         const auto& rows = nb::cast<const Mesh&>(self).tetrahedra;
                         return nb::ndarray<nb::numpy, const std::uint32_t, nb::shape<-1, 4>>(
                             rows.data(), {rows.size(), 4}, self);
                     })
        .def("__reduce__", &reduced)
        .def("__repr__",
             [](const Mesh& self) {
                 return fmt::format("<tandem.Mesh {}: {} vertices, {} tetrahedra>", self.name,
                                    self.vertices.size(), self.tetrahedra.size());
             })
        .def_ro("name", &Mesh::name)
        .def_ro("inverted", &Mesh::inverted)
        .def_ro("degenerate", &Mesh::degenerate)
        .def_ro("merged", &Mesh::merged)
        .def_prop_ro("findings", [](const Mesh& mesh) { return findings_text(mesh); });
    module.def("make_mesh", &mesh_of, nb::arg("vertices"), nb::arg("tetrahedra"), nb::arg("name"),
               "Implementation of tandem.make_mesh, which checks its input.");
    module.def(
        "parse_mesh", &parsed, nb::arg("data"), nb::arg("name"),
        "Makes a mesh of the bytes of a file of read_mesh, except of TetGen's pairs. Raises ValueError.");
    module.def(
        "read_mesh", [](const std::string& path) { return read_mesh(path); }, nb::arg("path"),
        nb::call_guard<nb::gil_scoped_release>(),
        "Reads a tetrahedral mesh. Content and suffix determine the format: Gmsh .msh 2.2 and 4.1, Medit "
        ".mesh, TetGen .node/.ele, legacy .vtk and .vtu. Raises ValueError with FILE:LINE.");
}

} // namespace tandem::python
