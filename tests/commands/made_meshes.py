# SPDX-License-Identifier: MIT
# test: cost=10 full=50
"""Meshes that meshio writes in every format that it has for tetrahedra, of the
project's meshes, and with TANDEM_MESHES=FOLDER of those there: plain, with duplicates, torn, beside surfaces,
mixed, of second order, with ghost cells. tandem reads each with the counts that meshio reads, or refuses it
in one line that names the way out, which then gives these counts."""

import itertools
import os
import pathlib
import re

import meshio
import numpy
from meshio.gmsh import _gmsh40

from tests.program import LONG, SOURCE, Case, bar, tandem

READ, CONVERTED = "read", "by tandem convert"  # how tandem takes a format
# Edges of meshio's tetra10, whose nodes 4 to 9 are their middles.
EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
MOST = 20000  # tetrahedra of a real mesh


def written(kind, **options):
    return lambda mesh, path: meshio.write(str(path), mesh, file_format=kind, **options)


def as_gmsh40(binary, version):
    """Gmsh 4.0 itself writes version 4."""

    def write(mesh, path):
        _gmsh40.write(str(path), mesh, binary=binary)
        path.write_bytes(path.read_bytes().replace(b"$MeshFormat\n4.0 ", b"$MeshFormat\n%b " % version, 1))

    return write


VTU = (
    {"binary": False},
    {"header_type": "UInt64"},
    *({"compression": how} for how in (None, "zlib", "lzma")),
)
IN_BOTH = ((".vtk", "vtk42"), (".vtk", "vtk51"), (".msh", "gmsh"), (".msh", "gmsh22"))  # as text and binary
FORMATS = [  # suffix, how, writer
    *((suffix, READ, written(kind, binary=binary)) for suffix, kind in IN_BOTH for binary in (False, True)),
    *((".vtu", READ, written("vtu", **options)) for options in VTU),
    *((".msh", READ, as_gmsh40(binary, version)) for binary in (False, True) for version in (b"4.0", b"4")),
    (".mesh", READ, written("medit")),
    (".node", READ, written("tetgen")),
    (".ele", READ, written("tetgen")),
    (".inp", CONVERTED, written("abaqus")),
    (".msh", CONVERTED, written("ansys", binary=False)),
    (".msh", CONVERTED, written("ansys", binary=True)),
    (".avs", CONVERTED, written("avsucd")),
    (".cgns", CONVERTED, written("cgns")),
    (".xml", CONVERTED, written("dolfin-xml")),
    (".e", CONVERTED, written("exodus")),
    *((".f3grid", CONVERTED, written("flac3d", binary=binary)) for binary in (False, True)),
    (".h5m", CONVERTED, written("h5m")),
    (".hmf", CONVERTED, written("hmf")),
    *((".mdpa", CONVERTED, written("mdpa", binary=binary)) for binary in (False, True)),
    (".med", CONVERTED, written("med")),
    *(
        (".bdf", CONVERTED, written("nastran", point_format=points, cell_format=cells))
        for points, cells in (
            ("fixed-large", "fixed-small"),
            ("fixed-small", "fixed-small"),
            ("free", "free"),
            ("fixed-large", "fixed-large"),
        )
    ),
    (".vol", CONVERTED, written("netgen")),
    (".post", CONVERTED, written("permas")),
    (".su2", CONVERTED, written("su2")),
    (".dat", CONVERTED, written("tecplot")),
    (".ugrid", CONVERTED, written("ugrid")),
    (".lb8.ugrid", CONVERTED, written("ugrid")),
    (".b8.ugrid", CONVERTED, written("ugrid")),
    *((".xdmf", CONVERTED, written("xdmf", data_format=form)) for form in ("XML", "Binary", "HDF")),
]


def plain(points, tets):
    return meshio.Mesh(points, [("tetra", tets)])


def with_duplicates(points, tets):
    return plain(points, numpy.vstack((tets, tets[::2][:, [3, 1, 0, 2]])))


def torn(points, tets):
    return plain(points[tets.reshape(-1)], numpy.arange(tets.size).reshape(-1, 4))


def beside_surfaces(points, tets):
    return meshio.Mesh(points, [("triangle", tets[:, :3]), ("tetra", tets), ("line", tets[:, :2])])


def mixed(points, tets):
    """Beside a hexahedron and a wedge of their own vertices."""
    cube = numpy.array(list(itertools.product((9.0, 10.0), repeat=3)))[[0, 4, 6, 2, 1, 5, 7, 3]]
    n = len(points)
    return meshio.Mesh(
        numpy.vstack((points, cube)),
        [
            ("tetra", tets),
            ("hexahedron", numpy.arange(n, n + 8)[None]),
            ("wedge", numpy.array([[0, 1, 3, 4, 5, 7]]) + n),
        ],
    )


def second_order(points, tets):
    pairs = numpy.sort(tets[:, EDGES].reshape(-1, 2), axis=1)
    unique, numbers = numpy.unique(pairs, axis=0, return_inverse=True)
    middles = (points[unique[:, 0]] + points[unique[:, 1]]) / 2
    return meshio.Mesh(
        numpy.vstack((points, middles)),
        [("tetra10", numpy.hstack((tets, numbers.reshape(-1, 6) + len(points))))],
    )


def with_ghosts(points, tets):
    """Every third tetrahedron is a duplicate of another part, every seventh is hidden."""
    flags = numpy.zeros(len(tets), numpy.uint8)
    flags[::3], flags[::7] = 1, 32
    return meshio.Mesh(points, [("tetra", tets)], cell_data={"vtkGhostType": [flags]})


# Content: option that the refusal names.
CONTENTS = dict.fromkeys((plain, with_duplicates, torn, beside_surfaces, with_ghosts))
CONTENTS |= {mixed: "--only-tetrahedra", second_order: "--corners"}


def rows_of(path):
    return [
        line.split() for line in path.read_text().splitlines() if line.strip() and not line.startswith("#")
    ]


def own_meshes():
    """Points and tetrahedra of bars, and of the meshes in scenes/meshes."""
    yield "bar", *map(numpy.array, bar(3, (0, 0, 0)))
    for node in sorted((SOURCE / "scenes/meshes").glob("*.node")):
        points, tets = (rows_of(node.with_suffix(suffix))[1:] for suffix in (".node", ".ele"))
        yield (
            node.stem,
            numpy.array([row[1:4] for row in points], float),
            numpy.array([row[1:5] for row in tets], int) - int(points[0][0]),
        )


def real_meshes():
    for path in (
        sorted(pathlib.Path(os.environ["TANDEM_MESHES"]).rglob("*.m*sh"))
        if "TANDEM_MESHES" in os.environ
        else ()
    ):
        try:
            mesh = meshio.read(path)
        except (Exception, SystemExit):  # meshio has no type of its own
            continue
        tets = numpy.vstack(
            [block.data for block in mesh.cells if block.type == "tetra"] or [numpy.zeros((0, 4), int)]
        )
        if 0 < len(tets) <= MOST:
            yield path.stem, mesh.points, tets


def drawn(count):
    """(format, content, mesh), each content in each format, the meshes by turns; `count` evenly spaced ones
    of them."""
    meshes = [*own_meshes(), *real_meshes()]
    small = [mesh for mesh in meshes if len(mesh[2]) <= 3000]
    every = [
        (form, content)
        for content in CONTENTS
        for form in FORMATS
        if content is not with_ghosts or form[0] == ".vtu"
    ]
    # meshio writes no elements of second order to TetGen's files, and reads such a file without an end.
    every = [
        (form, content)
        for form, content in every
        if content is not second_order or form[0] not in (".node", ".ele")
    ]
    every += 3 * [(form, plain) for form in FORMATS if form[1] is READ]
    made = [(*one, (meshes if one[1] is plain and one[0][1] is READ else small)) for one in every]
    made = [(form, content, pool[i * 5 % len(pool)]) for i, (form, content, pool) in enumerate(made)]
    return made if count is None else [made[i * len(made) // count] for i in range(count)]


class MadeMeshes(Case):
    def counts_of_meshio(self, path):
        """What tandem is to find, from a mesh as meshio reads it."""
        twin = self.work / "twin.msh"
        if path.read_bytes().startswith(b"$MeshFormat\n4 "):  # which meshio takes for 4.1
            twin.write_bytes(path.read_bytes().replace(b"\n4 ", b"\n4.0 ", 1))
        mesh = meshio.read(twin if path.read_bytes().startswith(b"$MeshFormat\n4 ") else path)
        blocks = [(block.type, block.data) for block in mesh.cells]
        tets = numpy.vstack([data[:, :4] for kind, data in blocks if kind in ("tetra", "tetra10")])
        flags = numpy.concatenate([*mesh.cell_data.get("vtkGhostType", [numpy.zeros(len(tets))])]).astype(int)
        kept = tets[(flags & 33) == 0] if path.suffix == ".vtu" and len(flags) == len(tets) else tets
        used = mesh.points[numpy.unique(kept)]
        return {
            "vertices": len(mesh.points),
            "tetrahedra": len(kept),
            "duplicates": len(kept) - len(numpy.unique(numpy.sort(kept, axis=1), axis=0)),
            "coincident": len(used) - len(numpy.unique(used + 0.0, axis=0)),
            "ghosts": len(tets) - len(kept),
            "reduced": sum(len(data) for kind, data in blocks if kind == "tetra10"),
            "other_cells": sum(
                len(data) for kind, data in blocks if kind in ("hexahedron", "wedge", "pyramid")
            ),
        }

    def run_on(self, path, *options):
        out = self.work / "made.jsonl"
        out.unlink(missing_ok=True)
        status, text, errors = tandem(
            f"run --mesh {path} --device host --algorithm tiled --no-check --no-count --quiet --out {out}",
            *options,
        )
        if status != 0:
            self.assertEqual((status, len(errors)), (2, 1), (text, errors))
            self.assertEqual(re.findall(r"[^\x20-\x7e]", errors[0].replace(str(path), "")), [], errors)
            return errors[0]
        (record,) = self.records(out)
        reading = record["scene"]["reading"]
        return {
            **{name: record["scene"][name] for name in ("vertices", "tetrahedra")},
            **{
                name: reading[name]
                for name in ("duplicates", "coincident", "ghosts", "reduced", "other_cells")
            },
        }

    def expect_read(self, path, content, counts):
        """Reads a file of a format that tandem has; without the option of its content it is refused."""
        option = CONTENTS[content]
        if option is not None and counts["reduced"] + counts["other_cells"] > 0:
            refusal = self.run_on(path)
            self.assertIsInstance(refusal, str)
            self.assertIn(option, refusal)
        self.assertEqual(self.run_on(path, *([option] if option else [])), counts)

    def write(self, form, content, mesh, path):
        """The file that stands for the mesh, or None where meshio cannot write or read this content."""
        try:
            form[2](content(mesh[1], mesh[2]), path.with_suffix(".node") if path.suffix == ".ele" else path)
            return self.counts_of_meshio(path)
        except (Exception, SystemExit):  # meshio has no type of its own
            return None

    def test_made_meshes(self):
        read = converted = left = 0
        for number, (form, content, mesh) in enumerate(drawn(None if LONG else 24)):
            path = self.work / f"made{number}{form[0]}"
            with self.subTest(f"{number}: {content.__name__} {mesh[0]} as {form[0]}"):
                counts = self.write(form, content, mesh, path)
                if counts is None:
                    left += 1
                elif form[1] is READ:
                    self.expect_read(path, content, counts)
                    read += 1
                else:
                    self.assertIn("tandem convert", self.run_on(path))
                    output = self.work / f"made{number}.vtu"
                    self.output("convert", path, "-o", output)
                    self.expect_read(output, content, counts)
                    converted += 1
        print(
            f"{read} meshes read, {converted} refused and converted, {left} that meshio cannot write or read"
        )
        self.assertGreater(read, 150 if LONG else 8)
        self.assertGreater(converted, 100 if LONG else 4)
