# SPDX-License-Identifier: MIT
"""Makes meshes of files, of arrays, and of the objects of mesh libraries."""
from __future__ import annotations

import os
import warnings
from typing import Any

import numpy

from . import _core
from ._core import Mesh
from .arrays import host_array

# Types of cells by their name in meshio and by their number in VTK.
TETRAHEDRON = ("tetra", 10)
POINTS_LINES_FACES = ("vertex", "line", "line3", "triangle", "triangle6", "triangle7", "quad", "quad8", "quad9", "polygon",
                      1, 2, 3, 4, 5, 6, 7, 8, 9, 21, 22, 23, 28, 30, 34, 35)
KINDS = "a tandem.Mesh, a path, (vertices, tetrahedra), or an object with points and cells_dict (meshio, PyVista)"


def _warned(mesh):
    """Warns of what the mesh has beside sound tetrahedra, and returns it."""
    if mesh.findings:
        warnings.warn(f"mesh {mesh.name}: {mesh.findings}", stacklevel=3)
    return mesh


def make_mesh(vertices: Any, tetrahedra: Any, name: str = "mesh") -> Mesh:
    """Makes a Mesh of vertices, (n, 3) numbers, and tetrahedra, (m, 4) integers from 0; both are copied. Raises ValueError or TypeError, whose
    one-line message begins with `name`."""
    return _warned(_core.make_mesh(host_array(vertices, f"{name}: vertices", 3), host_array(tetrahedra, f"{name}: tetrahedra", 4, numpy.uint32), name))


def read_mesh(path: str | os.PathLike[str]) -> Mesh:
    """Reads a tetrahedral mesh. Content and suffix determine the format: Gmsh .msh 2.2 and 4.1, Medit .mesh, TetGen .node/.ele, legacy .vtk
    and .vtu. Duplicate tetrahedra take no part in answers: a UserWarning tells of them and of coincident vertices. Raises ValueError with
    FILE:LINE."""
    return _warned(_core.read_mesh(os.fspath(path)))


def mesh_of(mesh: Any, name: str) -> Mesh:
    """A Mesh of any of KINDS, or of the bytes of a mesh file, as trimesh.interfaces.gmsh.to_volume() returns them. Points, lines and faces
    among cells are left out. Raises ValueError or TypeError, whose one-line message begins with `name` or the path."""
    if isinstance(mesh, Mesh):
        return mesh
    if isinstance(mesh, (bytes, bytearray)):
        return _warned(_core.parse_mesh(bytes(mesh), name))
    if isinstance(mesh, (str, os.PathLike)):
        return read_mesh(mesh)
    if isinstance(mesh, (tuple, list)) and len(mesh) == 2:
        return make_mesh(*mesh, name=name)
    if hasattr(mesh, "points") and hasattr(mesh, "cells_dict"):
        return make_mesh(mesh.points, _tetrahedra(mesh.cells_dict, name), name)
    if hasattr(mesh, "faces"):
        raise TypeError(f"{name}: type {type(mesh).__name__} has faces, not tetrahedra; fill the surface with tetrahedra (docs/user/own_data.md)")
    raise TypeError(f"{name}: type {type(mesh).__name__}; expected {KINDS}")


def _tetrahedra(cells, name):
    unusable = [kind for kind in cells if kind not in TETRAHEDRON and kind not in POINTS_LINES_FACES]
    if unusable:
        raise ValueError(f"{name}: has cells of type {_type_name(unusable[0])}; give linear tetrahedra only")
    found = [rows for kind, rows in cells.items() if kind in TETRAHEDRON]
    if not found:
        raise ValueError(f"{name}: has no tetrahedra among its cells ({', '.join(map(_type_name, cells)) or 'none'}); fill the surface with tetrahedra "
                         "(docs/user/own_data.md)")
    return found[0]


def _type_name(kind):
    return kind if isinstance(kind, str) else getattr(kind, "name", f"{kind} of VTK")
