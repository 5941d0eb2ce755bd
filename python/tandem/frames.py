# SPDX-License-Identifier: MIT
"""Writes frames of a simulation as a scene that `tandem run` takes."""

from __future__ import annotations

import base64
import json
import os
import pathlib
from typing import Any, Iterable, Mapping, Sequence

import numpy

from .arguments import list_of, number_of
from .arrays import POSE, host_array
from .meshes import mesh_of

TETRAHEDRON_OF_VTK = 10


def write_frames(
    folder: str | os.PathLike[str],
    meshes: Sequence[Any],
    *,
    poses: Sequence[Any] | None = None,
    vertices: Sequence[Any] | None = None,
    bodies: Iterable[int] | None = None,
    deformable: Iterable[int] = (),
) -> pathlib.Path:
    """Writes a new folder with frames, and returns the path of its scene description
    (scenes/description/README.md): `tandem run FOLDER/scene.json`.

    meshes, bodies, deformable: as of Collider; deformable: numbers of bodies. poses: for each frame (bodies,
    7) rows or (bodies, 4, 4) matrices, as run() takes them; those of deformable bodies are ignored. vertices:
    for each frame the world coordinates of all deformable bodies, a list of (n, 3) arrays in their order or
    {body: array}. Each is None where no body needs it. Numbers keep all bits of double; readers normalise
    quaternions. Raises ValueError or TypeError before anything is written, and OSError if the folder exists
    or cannot be written."""
    parts = [mesh_of(mesh, f"meshes[{i}]") for i, mesh in enumerate(list_of(meshes, "meshes"))]
    numbers = list(range(len(parts))) if bodies is None else _numbers(bodies, "bodies", "mesh")
    soft = sorted(set(_numbers(deformable, "deformable", "body")))
    if not parts or max(numbers, default=0) >= len(parts) or max(soft, default=-1) >= len(numbers):
        raise ValueError(
            f"bodies, deformable: {numbers}, {soft}; there are {len(parts)} meshes and {len(numbers)} bodies, numbered from 0"
        )
    rigid = [body for body in range(len(numbers)) if body not in soft]
    moves = _poses(poses, numbers, rigid)
    states = _states(vertices, [len(parts[number].vertices) for number in numbers], soft)
    frames = {len(given) for given, needed in ((moves, rigid), (states, soft)) if needed}
    if len(frames) != 1 or 0 in frames:
        raise ValueError(
            f"poses, vertices: {len(moves)} and {len(states)} frames; give one entry for each frame in both"
        )
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True)
    for i, part in enumerate(parts):
        text = _vtu(part.vertices, part.tetrahedra, part.pressures)
        (folder / f"mesh{i}.vtu").write_text(text, encoding="ascii")
    described = [{"mesh": f"mesh{number}"} for number in numbers]
    for body in rigid:
        described[body]["poses"] = [rows[body].tolist() for rows in moves]
    for body in soft:
        described[body]["series"] = _series(folder, body, states, parts[numbers[body]].tetrahedra)
    scene = folder / "scene.json"
    names = {f"mesh{i}": {"file": f"mesh{i}.vtu"} for i in range(len(parts))}
    scene.write_text(
        json.dumps({"name": folder.name, "frames": frames.pop(), "meshes": names, "bodies": described})
    )
    return scene


def _series(folder, body, states, tetrahedra):
    """Writes the states of a deformable body. Returns the names of their files."""
    names = [f"body{body}-{frame:06}.vtu" for frame in range(len(states))]
    for name, state in zip(names, states):
        (folder / name).write_text(_vtu(state[body], tetrahedra), encoding="ascii")
    return names


def _numbers(values, what, of):
    return [number_of(value, f"{what}[{i}]", of) for i, value in enumerate(list_of(values, what))]


def _finite(rows, what):
    if not numpy.isfinite(rows).all():
        raise ValueError(f"{what}: is not finite")
    return rows


def _poses(poses, bodies, rigid):
    frames = [
        _finite(host_array(rows, f"poses[{i}]", POSE), f"poses[{i}]")
        for i, rows in enumerate(poses if poses is not None and rigid else ())
    ]
    for i, rows in enumerate(frames):
        if len(rows) != len(bodies):
            raise ValueError(f"poses[{i}]: {len(rows)} rows for {len(bodies)} bodies; give each body its row")
        if not rows[rigid, 3:].any(axis=1).all():
            raise ValueError(f"poses[{i}]: a row has no rotation; give tx ty tz qw qx qy qz")
    return frames


def _states(vertices, counts, soft):
    frames = []
    for i, given in enumerate(vertices if vertices is not None and soft else ()):
        state = (
            dict(given)
            if isinstance(given, Mapping)
            else dict(zip(soft, given))
            if len(given) == len(soft)
            else {}
        )
        if sorted(number_of(body, f"vertices[{i}]", "body") for body in state) != soft:
            raise ValueError(
                f"vertices[{i}]: needs one array for each deformable body ({', '.join(map(str, soft))})"
            )
        state = {
            body: _finite(
                host_array(rows, f"vertices[{i}] of body {body}", 3), f"vertices[{i}] of body {body}"
            )
            for body, rows in state.items()
        }
        for body, rows in state.items():
            if len(rows) != counts[body]:
                raise ValueError(
                    f"vertices[{i}]: {len(rows)} rows for body {body}, whose mesh has {counts[body]} vertices"
                )
        frames.append(state)
    return frames


def _vtu(vertices, tetrahedra, pressures=None):
    """A file of VTK XML for unstructured grids, with binary arrays."""
    count = len(tetrahedra)
    field = {} if pressures is None else {"PointData": [("pressure", "Float64", 1, pressures, "<f8")]}
    arrays = field | {
        "Points": [("", "Float64", 3, vertices, "<f8")],
        "Cells": [
            ("connectivity", "Int64", 1, tetrahedra, "<i8"),
            ("offsets", "Int64", 1, numpy.arange(4, 4 * count + 1, 4), "<i8"),
            ("types", "UInt8", 1, numpy.full(count, TETRAHEDRON_OF_VTK), "u1"),
        ],
    }
    sections = "".join(
        f"<{section}>{''.join(_array(*one) for one in of)}</{section}>\n" for section, of in arrays.items()
    )
    return (
        '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n<UnstructuredGrid>\n'
        f'<Piece NumberOfPoints="{len(vertices)}" NumberOfCells="{count}">\n{sections}</Piece>\n</UnstructuredGrid>\n</VTKFile>\n'
    )


def _array(name, kind, components, values, form):
    data = numpy.ascontiguousarray(values, form).tobytes()
    text = base64.b64encode(len(data).to_bytes(8, "little") + data).decode()
    return f'<DataArray type="{kind}" Name="{name or "Points"}" NumberOfComponents="{components}" format="binary">{text}</DataArray>\n'
