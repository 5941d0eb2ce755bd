// SPDX-License-Identifier: MIT
#include "python/core/meshes.h"

#include "python/core/arrays.h"
#include "scenes/mesh.h"
#include "scenes/read/read.h"
#include "scenes/weld.h"

#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace nb = nanobind;

namespace tandem::python {

namespace {

static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double) && sizeof(Tetrahedron) == 4 * sizeof(uint32_t));

/// Completes a mesh that has vertices, tetrahedra and findings of its reader.
Mesh completed(Mesh mesh, const std::string& name, const MeshReading& reading) {
    mesh.name = name;
    complete_mesh(mesh, name, reading);
    mesh.findings.coincident = count_coincident(mesh);
    return mesh;
}

Mesh mesh_of(const Points& vertices, const Corners& tetrahedra, const std::optional<Numbers>& pressures,
             const std::string& name, const MeshReading& reading) {
    const nb::gil_scoped_release released;
    Mesh mesh;
    copy_points(vertices, mesh.vertices);
    const auto* const first = reinterpret_cast<const Tetrahedron*>(tetrahedra.data());
    mesh.tetrahedra.assign(first, first + tetrahedra.shape(0));
    if (pressures) mesh.pressures.assign(pressures->data(), pressures->data() + pressures->shape(0));
    return completed(std::move(mesh), name, reading);
}

Mesh parsed(const nb::bytes& data, const std::string& name, const MeshReading& reading) {
    const std::string_view view(data.c_str(), data.size());
    const nb::gil_scoped_release released;
    return completed(parse_mesh(view, name, reading), name, reading);
}

/// A copy that is connected by another reading.
Mesh connected(const Mesh& mesh, const MeshReading& reading) {
    const nb::gil_scoped_release released;
    return completed(mesh, mesh.name, reading);
}

/// For pickling: the function and its arguments that make the mesh again.
nb::tuple reduced(nb::handle self) {
    const nb::object modulus = self.attr("pressure");
    return nb::make_tuple(nb::module_::import_("tandem.meshes").attr("remade"),
                          nb::make_tuple(self.attr("vertices"), self.attr("tetrahedra"), self.attr("name"),
                                         self.attr("duplicates"), self.attr("weld"),
                                         modulus.is_none() ? self.attr("pressures") : modulus));
}

void bind_reading(nb::module_& module) {
    nb::class_<MeshReading>(module, "MeshReading",
                            "How a mesh is read and connected: the arguments of tandem.read_mesh.")
        .def(
            "__init__",
            [](MeshReading* self, const std::string& duplicates, std::optional<double> weld,
               std::optional<double> pressure, bool corners, bool only_tetrahedra) {
                if (weld) checked_weld(*weld);
                if (pressure) checked_pressure(*pressure);
                new (self)
                    MeshReading{duplicates_named(duplicates), weld, corners, only_tetrahedra, pressure};
            },
            nb::arg("duplicates"), nb::arg("weld").none(), nb::arg("pressure").none(),
            nb::arg("corners") = false, nb::arg("only_tetrahedra") = false);
}

/// How a mesh was connected.
void bind_findings(nb::class_<Mesh>& mesh) {
    mesh.def_ro("merged", &Mesh::merged)
        .def_prop_ro("welded",
                     [](nb::handle self) {
                         const auto& rows = nb::cast<const Mesh&>(self).welded;
                         return nb::ndarray<nb::numpy, const std::uint32_t, nb::shape<-1>>(
                             rows.data(), {rows.size()}, self);
                     })
        .def_prop_ro("duplicates",
                     [](const Mesh& self) {
                         return std::string(
                             duplicates_names[static_cast<std::size_t>(self.reading.duplicates)]);
                     })
        .def_prop_ro("weld", [](const Mesh& self) { return self.reading.weld; })
        .def_prop_ro("findings", [](const Mesh& self) { return findings_text(self, "weld=0"); });
}

using Pressures = nb::ndarray<nb::numpy, const double, nb::shape<-1>>;

void bind_field(nb::class_<Mesh>& mesh) {
    mesh.def_prop_ro("pressures",
                     [](nb::handle self) -> std::optional<Pressures> {
                         const auto& values = nb::cast<const Mesh&>(self).pressures;
                         if (values.empty()) return std::nullopt;
                         return Pressures(values.data(), {values.size()}, self);
                     })
        .def_prop_ro("pressure", [](const Mesh& self) { return self.reading.pressure; });
}

void bind_mesh(nb::module_& module) {
    nb::class_<Mesh> mesh(
        module, "Mesh",
        "Checked vertices and tetrahedra: every index is in range, every coordinate is finite.\n\n"
        "vertices: (n, 3) float64, in the unit of the scene. tetrahedra: (m, 4) uint32, indices of "
        "vertices; answers number tetrahedra in this order. Both are read-only "
        "views of the mesh's own memory. pressures: (n,) float64, the pressure at each vertex, or None "
        "without a field. inverted and degenerate count tetrahedra of negative and of zero volume; the mesh "
        "keeps them. duplicates and weld are those of make_mesh; pressure is the modulus that made the "
        "field, or None. merged lists "
        "duplicates of earlier tetrahedra, which are in no answer; welded has for each vertex the first of "
        "those that are one with it, or is empty; findings is one line about both and about coincident "
        "vertices, or empty.");
    mesh.def_prop_ro("vertices",
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
        .def_ro("degenerate", &Mesh::degenerate);
    bind_findings(mesh);
    bind_field(mesh);
}

} // namespace

void bind_meshes(nb::module_& module) {
    bind_reading(module);
    bind_mesh(module);
    module.def("make_mesh", &mesh_of, nb::arg("vertices"), nb::arg("tetrahedra"), nb::arg("pressures").none(),
               nb::arg("name"), nb::arg("reading"),
               "Implementation of tandem.make_mesh, which checks its input.");
    module.def("connected", &connected, nb::arg("mesh"), nb::arg("reading"),
               "A copy of a mesh that is connected by another reading.");
    module.def(
        "parse_mesh", &parsed, nb::arg("data"), nb::arg("name"), nb::arg("reading"),
        "Makes a mesh of the bytes of a file of read_mesh, except of TetGen's pairs. Raises ValueError.");
    module.def("read_mesh", &read_mesh, nb::arg("path"), nb::arg("reading"),
               nb::call_guard<nb::gil_scoped_release>(),
               "Reads a tetrahedral mesh. Content and suffix determine the format: Gmsh .msh 1, 2.2, 4.0 and "
               "4.1, Medit "
               ".mesh, TetGen .node/.ele, legacy .vtk and .vtu. Raises ValueError with FILE:LINE.");
}

} // namespace tandem::python
