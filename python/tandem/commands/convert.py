# SPDX-License-Identifier: MIT
"""tandem convert: reads a mesh by meshio, or a .tet or .t file, and writes it as .vtu, which tandem reads.
Cells of every kind are kept, and data are not."""

import contextlib
import io
import os

from ..errors import BadUse
from ..files import check_output, replace_whole, temporary_folder
from . import Parser, check_packages, run


def _parsed(arguments):
    parser = Parser("tandem convert", __doc__, "tandem convert mesh.inp -o mesh.vtu")
    parser.add_argument("file", help="a mesh file that meshio reads, or a .tet file")
    parser.add_argument("-o", "--output", required=True, metavar="FILE.vtu", help="the file to write")
    return parser.read(arguments)


def _words(path):
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            return [word for line in file for word in line.split("#")[0].split()]
    except OSError as problem:
        raise BadUse(f"{path}: cannot be read ({problem.strerror}); check the file") from None


def _tet(path):
    """Points and tetrahedra of the two formats with the suffix .tet: "tet V T", or "V vertices T tets" with a
    4 before each tetrahedron."""
    words = _words(path)
    try:
        counted = words[0] == "tet"
        points, cells = (int(words[1]), int(words[2])) if counted else (int(words[0]), int(words[2]))
        start, width = (3, 4) if counted else (4, 5)
        end = start + 3 * points
        count = end + width * cells
        rows = [words[end + width * i : end + width * (i + 1)][width - 4 :] for i in range(cells)]
        positions = [
            [float(word) for word in words[start + 3 * i : start + 3 * i + 3]] for i in range(points)
        ]
        corners = [[int(word) for word in row] for row in rows]
    except (IndexError, ValueError):
        raise BadUse(f"{path}: is no .tet file; it begins with 'tet V T' or 'V vertices T tets'") from None
    if len(words) != count:
        raise BadUse(
            f"{path}: {len(words)} words for {points} vertices and {cells} tetrahedra; export the file again"
        )
    return positions, corners


def _t(path):
    """Points and tetrahedra of a .t file, of MeshLib and of the simulator Gaia: lines "Vertex N x y z" and
    "Tet N V V V V", in which V are numbers N of vertices above. Properties in braces, and other lines, are
    left out."""
    rows, positions, corners = {}, [], []
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            for line, text in enumerate(file, 1):
                kind, *words = text.partition("{")[0].split() or [""]
                if kind == "Vertex":
                    number, x, y, z = words
                    if rows.setdefault(int(number), len(positions)) != len(positions):
                        raise ValueError(f"vertex {number} is there twice")
                    positions.append([float(x), float(y), float(z)])
                elif kind == "Tet":
                    _, *numbers = words
                    a, b, c, d = (rows[int(number)] for number in numbers)
                    corners.append([a, b, c, d])
    except OSError as problem:
        raise BadUse(f"{path}: cannot be read ({problem.strerror}); check the file") from None
    except KeyError as problem:
        raise BadUse(
            f"{path}:{line}: there is no vertex {problem.args[0]} above; export the file again"
        ) from None
    except ValueError:
        raise BadUse(
            f"{path}:{line}: is no line 'Vertex N x y z' or 'Tet N V V V V' with a new N; export the file again"
        ) from None
    return positions, corners


OWN = {".tet": _tet, ".t": _t}  # readers by suffix, of formats that meshio does not have


def _by_meshio(path):
    import meshio

    errors = io.StringIO()
    try:
        with contextlib.redirect_stdout(errors), contextlib.redirect_stderr(errors):
            return meshio.read(path)
    except ImportError as problem:
        raise BadUse(f"{path}: meshio needs {problem.name} for this format; install it with pip") from None
    except (
        Exception,
        SystemExit,
    ) as problem:  # meshio ends the program where it cannot read, and has no type of its own for damaged files
        message = errors.getvalue() or ("" if isinstance(problem, SystemExit) else str(problem))
        raise BadUse(
            f"{path}: meshio cannot read it ({' '.join(message.split()) or 'damaged'}); export .msh, .vtk or .vtu"
        ) from None


def _read(path):
    import meshio

    reader = OWN.get(os.path.splitext(path)[1].lower())
    if reader:
        points, tetrahedra = reader(path)
        return meshio.Mesh(points, [("tetra", tetrahedra)])
    given = _by_meshio(path)
    field = {name: given.point_data[name] for name in given.point_data if name == "pressure"}
    return meshio.Mesh(given.points, given.cells, point_data=field)


def _vtu(mesh):
    """The bytes of a .vtu file. meshio writes files only."""
    with temporary_folder() as folder:
        path = os.path.join(folder, "mesh.vtu")
        try:
            mesh.write(path, file_format="vtu")
        except Exception as problem:  # meshio has no type of its own
            raise BadUse(
                f"meshio cannot write this mesh ({' '.join(str(problem).split())}); export its tetrahedra alone"
            ) from None
        with open(path, "rb") as file:
            return file.read()


def _make(arguments):
    options = _parsed(arguments)
    if not options.output.endswith(".vtu"):
        raise BadUse(f"{options.output}: tandem convert writes .vtu; name a file FILE.vtu")
    if not os.path.isfile(options.file):
        raise BadUse(f"{options.file}: there is no such file; check the path")
    check_output(options.output, [options.file], ".partial")
    check_packages("tandem convert", ("numpy", "meshio"))
    import numpy

    mesh = _read(options.file)
    tetrahedra = sum(len(block.data) for block in mesh.cells if block.type.startswith("tetra"))
    if tetrahedra == 0:
        raise BadUse(f"{options.file}: no tetrahedra; export the volume, not only the surface")
    mesh.points = numpy.asarray(mesh.points, dtype=float)
    replace_whole(options.output, _vtu(mesh))
    return f"{options.output}: {len(mesh.points)} vertices and {tetrahedra} tetrahedra of {options.file}\n", 0


def main(arguments, program=""):
    return run(lambda: _make(arguments))
