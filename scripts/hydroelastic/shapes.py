# SPDX-License-Identifier: MIT
"""Tetrahedral meshes that both programs read, and their pressure fields."""

import dataclasses
import itertools
import pathlib

import numpy

BUILT_IN = pathlib.Path(__file__).resolve().parents[2] / "scenes/meshes"
FACES = ((1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2))


@dataclasses.dataclass
class Shape:
    """vertices: (n, 3). tetrahedra: (m, 4), of positive volume."""

    vertices: numpy.ndarray
    tetrahedra: numpy.ndarray

    def __post_init__(self):
        corner = self.vertices[self.tetrahedra]
        negative = numpy.linalg.det(corner[:, 1:] - corner[:, :1]) < 0
        self.tetrahedra = self.tetrahedra.copy()
        self.tetrahedra[negative] = self.tetrahedra[negative][:, [0, 2, 1, 3]]

    @property
    def radius(self):
        """The largest distance of a vertex from the origin."""
        return numpy.linalg.norm(self.vertices, axis=1).max()


def grid(cells, keep=lambda centre: True):
    """The cube [-1/2, 1/2]^3 of cells^3 cells, six tetrahedra each; `keep` tells which, by their centres."""
    number = cells + 1
    corners = numpy.array(list(itertools.product(range(number), repeat=3)))
    tetrahedra = []
    for cell in itertools.product(range(cells), repeat=3):
        if not keep((numpy.array(cell) + 0.5) / cells - 0.5):
            continue
        for order in itertools.permutations(range(3)):
            place, path = list(cell), []
            for axis in (None, *order):
                if axis is not None:
                    place[axis] += 1
                path.append((place[0] * number + place[1]) * number + place[2])
            tetrahedra.append(path)
    used, tetrahedra = numpy.unique(numpy.array(tetrahedra), return_inverse=True)
    return Shape(corners[used] / cells - 0.5, tetrahedra.reshape(-1, 4))


def ball(cells, radii=(0.5, 0.5, 0.5)):
    """An ellipsoid: the cube's shells are moved to spheres, then stretched."""
    cube = grid(cells)
    length = numpy.linalg.norm(cube.vertices, axis=1, keepdims=True)
    shell = numpy.abs(cube.vertices).max(axis=1, keepdims=True)
    round_ones = cube.vertices * (2 * shell / numpy.where(length > 0, length, 1))
    return Shape(round_ones * numpy.array(radii), cube.tetrahedra)


def corner_piece(cells):
    """The cube without a quarter of it, an L."""
    return grid(cells, keep=lambda centre: centre[0] < 0 or centre[1] < 0)


def split(shape):
    """Replaces each tetrahedron by four around its centroid, so that none has its vertices on the boundary."""
    centroids = shape.vertices[shape.tetrahedra].mean(axis=1)
    inner = len(shape.vertices) + numpy.arange(len(centroids))
    parts = [numpy.column_stack([shape.tetrahedra[:, face], inner]) for face in map(list, FACES)]
    return Shape(numpy.vstack([shape.vertices, centroids]), numpy.vstack(parts))


def built_in(name):
    """A mesh of scenes/meshes, moved to the origin, with a largest extent of 1."""
    nodes = numpy.loadtxt(BUILT_IN / f"{name}.node", skiprows=2, usecols=(1, 2, 3))
    elements = numpy.loadtxt(BUILT_IN / f"{name}.ele", "i8", skiprows=2)
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    return Shape((nodes - (low + high) / 2) / (high - low).max(), elements[:, 1:])


def boundary(shape):
    """(n, 3) vertices of the faces of one tetrahedron only."""
    faces = numpy.vstack([shape.tetrahedra[:, face] for face in map(list, FACES)])
    _, first, count = numpy.unique(numpy.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return faces[first[count == 1]]


def distance_to_segment(points, start, end):
    edge = end - start
    along = numpy.clip((points - start) @ edge / (edge @ edge), 0, 1)
    return numpy.linalg.norm(points - start - along[:, None] * edge, axis=1)


def distance_to_triangle(points, corner):
    distance = numpy.min([distance_to_segment(points, corner[i - 1], corner[i]) for i in range(3)], axis=0)
    edges = (corner[1:] - corner[0]).T
    weights = (points - corner[0]) @ numpy.linalg.pinv(edges).T
    inside = (weights >= 0).all(axis=1) & (weights.sum(axis=1) <= 1)
    normal = numpy.cross(edges[:, 0], edges[:, 1])
    height = numpy.abs((points - corner[0]) @ normal) / numpy.linalg.norm(normal)
    return numpy.where(inside, height, distance)


def pressures(shape, modulus):
    """At each vertex modulus times its distance from the boundary, over the largest such distance."""
    faces = boundary(shape)
    inner = numpy.setdiff1d(numpy.arange(len(shape.vertices)), faces)
    distance = numpy.full(len(inner), numpy.inf)
    for face in faces:
        distance = numpy.minimum(distance, distance_to_triangle(shape.vertices[inner], shape.vertices[face]))
    field = numpy.zeros(len(shape.vertices))
    field[inner] = modulus * distance / distance.max()
    return field


def write(shape, path):
    """A legacy VTK file, which keeps all bits of coordinates."""
    lines = ["# vtk DataFile Version 3.0", path.stem, "ASCII", "DATASET UNSTRUCTURED_GRID"]
    lines.append(f"POINTS {len(shape.vertices)} double")
    lines += [" ".join(map(repr, row)) for row in shape.vertices.tolist()]
    lines.append(f"CELLS {len(shape.tetrahedra)} {5 * len(shape.tetrahedra)}")
    lines += ["4 " + " ".join(map(str, row)) for row in shape.tetrahedra.tolist()]
    lines.append(f"CELL_TYPES {len(shape.tetrahedra)}")
    lines += ["10"] * len(shape.tetrahedra)
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
