# SPDX-License-Identifier: MIT
"""Makes meshes of files, of arrays, and of the objects of mesh libraries."""

from __future__ import annotations

import os
from typing import Any

import numpy

from . import _core
from ._core import Mesh, Scene
from .arrays import host_array, host_numbers, numpy_array
from .telling import warn

# Types of cells by their name in meshio and by their number in VTK.
TETRAHEDRON = ("tetra", 10)
POINTS_LINES_FACES = (
    "vertex",
    "line",
    "line3",
    "triangle",
    "triangle6",
    "triangle7",
    "quad",
    "quad8",
    "quad9",
    "polygon",
    1,
    2,
    3,
    4,
    5,
    6,
    7,
    8,
    9,
    21,
    22,
    23,
    28,
    30,
    34,
    35,
)
KINDS = (
    "a tandem.Mesh, a path, (vertices, tetrahedra), or an object with points and cells_dict (meshio, PyVista)"
)


def _number(value, what, meaning):
    """A number as float, and None as it is."""
    if value is not None and (isinstance(value, (bool, str)) or not hasattr(value, "__float__")):
        raise TypeError(f"{what}: type {type(value).__name__}; expected {meaning}, or None")
    return None if value is None else float(value)


def _reading(duplicates, weld, pressure, corners=False, only_tetrahedra=False):
    if not isinstance(duplicates, str):
        raise TypeError(f"duplicates: type {type(duplicates).__name__}; expected merge, keep or reject")
    return _core.MeshReading(
        duplicates,
        _number(weld, "weld", "a tolerance of 0 or more"),
        _number(pressure, "pressure", "a modulus above 0"),
        bool(corners),
        bool(only_tetrahedra),
    )


def _warned(mesh):
    """Warns of what the mesh has beside sound tetrahedra, and returns it."""
    if mesh.findings:
        warn(f"mesh {mesh.name}: {mesh.findings}")
    return mesh


def make_mesh(
    vertices: Any,
    tetrahedra: Any,
    name: str = "mesh",
    *,
    pressures: Any = None,
    duplicates: str = "merge",
    weld: float | None = None,
    pressure: float | None = None,
) -> Mesh:
    """Makes a Mesh of vertices, (n, 3) numbers, and tetrahedra, (m, 4) integers from 0; both are copied.

    pressures: (n,) numbers, finite and not negative: the pressure field, by vertex, of contact_rule="pressure".
    None: no field.

    duplicates: handling of tetrahedra with the four vertices of an earlier one: "merge" (they keep their
    numbers and take no part), "keep"
        (they take part) or "reject" (ValueError).
    weld: vertices at most this far apart, also along chains, count as one for boundary faces, duplicates and
    self_collision; coordinates and
        numbers stay. None: no welding. 0: equal positions.
    pressure: a modulus above 0: a mesh without pressures gets the field of modulus times the distance from the
        boundary, over the largest such distance of a vertex. None: it stays without.

    A UserWarning tells once of duplicates and of coincident vertices. Raises ValueError or TypeError, whose
    one-line message begins with `name` or the argument."""
    arrays = (
        host_array(vertices, f"{name}: vertices", 3),
        host_array(tetrahedra, f"{name}: tetrahedra", 4, numpy.uint32),
    )
    field = None if pressures is None else host_numbers(pressures, f"{name}: pressures")
    return _warned(_core.make_mesh(*arrays, field, name, _reading(duplicates, weld, pressure)))


def remade(vertices, tetrahedra, name, duplicates, weld, field=None):
    """A mesh of its pickle, without the warning that its making gave. field: its pressures, or the modulus that
    made them."""
    modulus = field if isinstance(field, float) else None
    reading = _core.MeshReading(duplicates, weld, modulus)
    return _core.make_mesh(vertices, tetrahedra, None if modulus else field, name, reading)


def read_mesh(
    path: str | os.PathLike[str],
    *,
    duplicates: str = "merge",
    weld: float | None = None,
    pressure: float | None = None,
    corners: bool = False,
    only_tetrahedra: bool = False,
) -> Mesh:
    """Reads a tetrahedral mesh. Content and suffix determine the format: Gmsh .msh 1, 2.2, 4.0 and 4.1, Medit
    .mesh, TetGen .node/.ele, Vega .veg, legacy .vtk and .vtu. Point data "pressure" of Gmsh, .vtk and .vtu
    become the mesh's field. duplicates, weld and pressure are those of make_mesh. corners: reads tetrahedra of higher order by their corners. only_tetrahedra: leaves out other volume
    cells. Raises ValueError with FILE:LINE."""
    reading = _reading(duplicates, weld, pressure, corners, only_tetrahedra)
    return _warned(_core.read_mesh(os.fspath(path), reading))


def make_scene(
    specification: str,
    *,
    duplicates: str = "merge",
    weld: float | None = None,
    pressure: float | None = None,
    corners: bool = False,
    only_tetrahedra: bool = False,
) -> Scene:
    """Makes a scene from the same text as the program: NAME, NAME:par=value,par=value, the path of a scene
    description (.json) or of a recording (.frames). The keyword arguments are those of read_mesh, for all its
    meshes. Raises ValueError."""
    reading = _reading(duplicates, weld, pressure, corners, only_tetrahedra)
    scene = _core.make_scene(specification, reading)
    for mesh in scene.meshes:
        _warned(mesh)
    return scene


def mesh_of(
    mesh: Any,
    name: str,
    duplicates: str | None = None,
    weld: float | None = None,
    pressure: float | None = None,
) -> Mesh:
    """A Mesh of any of KINDS, or of the bytes of a mesh file, as trimesh.interfaces.gmsh.to_volume() returns
    them. Points, lines and faces among cells are left out. duplicates, weld and pressure are those of
    make_mesh; a Mesh keeps its own where they are None. Raises ValueError or TypeError, whose one-line message
    begins with `name`, the path or the argument."""
    if isinstance(mesh, Mesh):
        return _reconnected(mesh, duplicates, weld, pressure)
    given = {"duplicates": "merge" if duplicates is None else duplicates, "weld": weld, "pressure": pressure}
    if isinstance(mesh, (bytes, bytearray)):
        return _warned(_core.parse_mesh(bytes(mesh), name, _reading(**given)))
    if isinstance(mesh, (str, os.PathLike)):
        return read_mesh(mesh, **given)
    if isinstance(mesh, (tuple, list)) and len(mesh) == 2:
        return make_mesh(*mesh, name=name, **given)
    if hasattr(mesh, "points") and hasattr(mesh, "cells_dict"):
        given["pressures"] = _pressures(getattr(mesh, "point_data", None), name)
        return make_mesh(mesh.points, _tetrahedra(mesh.cells_dict, name), name, **given)
    if hasattr(mesh, "faces"):
        raise TypeError(
            f"{name}: type {type(mesh).__name__} has faces, not tetrahedra; fill the surface with tetrahedra (docs/user/own_data.md)"
        )
    raise TypeError(f"{name}: type {type(mesh).__name__}; expected {KINDS}")


def _reconnected(mesh, duplicates, weld, pressure):
    """The mesh, or a copy by the arguments that are not None."""
    if duplicates is None and weld is None and pressure is None:
        return mesh
    own = (
        mesh.duplicates if duplicates is None else duplicates,
        mesh.weld if weld is None else weld,
        mesh.pressure if pressure is None else pressure,
    )
    return _warned(_core.connected(mesh, _reading(*own)))


def tell_missing_fields(meshes):
    """Warns of bodies, by their meshes, that make no polygons of equal pressure."""
    without = sum(mesh.pressures is None for mesh in meshes)
    if without:
        warn(
            f"{without} of {len(meshes)} bodies have no pressure field and make no polygons (pressure=MODULUS gives them one)"
        )


def _pressures(data, name):
    """Point data "pressure" of meshio or PyVista, as a row of numbers; None without them."""
    if data is None or "pressure" not in data:
        return None
    array = numpy_array(data["pressure"], f"{name}: pressures")
    return array[:, 0] if array.ndim == 2 and array.shape[1] == 1 else array


def _tetrahedra(cells, name):
    unusable = [kind for kind in cells if kind not in TETRAHEDRON and kind not in POINTS_LINES_FACES]
    if unusable:
        raise ValueError(f"{name}: has cells of type {_type_name(unusable[0])}; give linear tetrahedra only")
    found = [rows for kind, rows in cells.items() if kind in TETRAHEDRON]
    if not found:
        raise ValueError(
            f"{name}: has no tetrahedra among its cells ({', '.join(map(_type_name, cells)) or 'none'}); fill the surface with tetrahedra "
            "(docs/user/own_data.md)"
        )
    return found[0]


def _type_name(kind):
    return kind if isinstance(kind, str) else getattr(kind, "name", f"{kind} of VTK")
