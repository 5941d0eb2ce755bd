// SPDX-License-Identifier: MIT
#include "python/core/meshes.h"

#include "python/core/arrays.h"
#include "scenes/mesh.h"

#include <nanobind/stl/string.h>

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
    return mesh;
}

} // namespace

void bind_meshes(nb::module_& module) {
    nb::class_<Mesh>(
        module, "Mesh",
        "Checked vertices and tetrahedra: every index is in range, every coordinate is finite.\n\n"
        "vertices: (n, 3) float64, in the unit of the scene. tetrahedra: (m, 4) uint32, indices of "
        "vertices; answers number tetrahedra in this order. Both are read-only "
        "views of the mesh's own memory. inverted and degenerate count tetrahedra of negative "
        "and of zero volume; the mesh keeps them.")
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
        .def_ro("name", &Mesh::name)
        .def_ro("inverted", &Mesh::inverted)
        .def_ro("degenerate", &Mesh::degenerate);
    module.def("make_mesh", &mesh_of, nb::arg("vertices"), nb::arg("tetrahedra"), nb::arg("name"),
               "Implementation of tandem.make_mesh, which checks its input.");
    module.def(
        "read_mesh", &read_mesh, nb::arg("path"), nb::call_guard<nb::gil_scoped_release>(),
        "Reads a tetrahedral mesh. Content and suffix determine the format: Gmsh .msh 2.2 and 4.1, Medit "
        ".mesh, TetGen .node/.ele, legacy .vtk and .vtu. Raises ValueError with FILE:LINE.");
}

} // namespace tandem::python
