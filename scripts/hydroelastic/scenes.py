# SPDX-License-Identifier: MIT
"""The pairs of meshes and their poses."""

import numpy

from hydroelastic import shapes

# Meshes by scripts/make_meshes have tetrahedra without inner vertices, whose pressure is 0: they are split.
PAIRS = {
    "cubes": lambda: (shapes.split(shapes.grid(2)), shapes.grid(4)),
    "balls": lambda: (shapes.ball(6), shapes.ball(5, (0.5, 0.58, 0.66))),
    "L and ball": lambda: (shapes.corner_piece(4), shapes.split(shapes.ball(4))),
    "jack and grain": lambda: (
        shapes.split(shapes.built_in("jack")),
        shapes.split(shapes.built_in("grain3")),
    ),
    "grains": lambda: (shapes.split(shapes.built_in("grain1")), shapes.split(shapes.built_in("grain2"))),
}
IDENTITY = (1.0, 0.0, 0.0, 0.0)
# Of Drake's geometry/benchmarking/compliant_mesh_intersection_benchmark.cc: radii, and translations along each
# axis. Its resolution hints 4, 3, 2, 1 are about these numbers of cells along a diameter of our meshes.
# The built-in scene spheres has the same bodies.
RADII = (3.01, 3.5, 4.0), (3.0, 3.0, 3.0)
CELLS = (2, 3, 4, 8)
TRANSLATIONS = (7.0, 4.0, 3.5, 1.2)
FINEST = 32
CUBE_CELLS = (2, 4, 8, 16)
CUBE_TRANSLATION = (0.61, 0.13, 0.07)


def random_pose(random, middle):
    quaternion = random.normal(size=4)
    return [*middle, *(quaternion / numpy.linalg.norm(quaternion))]


def random_poses(random, reach):
    """Poses of A and B without end, (2, 7) each. reach: the sum of the bodies' radii."""
    while True:
        middle = random.uniform(-1, 1, size=3)
        direction = random.normal(size=3)
        direction *= random.uniform(0.1, 0.7) * reach / numpy.linalg.norm(direction)
        yield numpy.array([random_pose(random, middle), random_pose(random, middle + direction)])


def moved(translation, frames):
    """(frames, 2, 7): A stands, B is moved by a little more in each frame."""
    step = 1e-4 * numpy.array([1.0, 2.0, 3.0]) * numpy.abs(translation).max()
    places = [numpy.array(translation) + frame * step for frame in range(frames)]
    return numpy.array([[[0.0, 0.0, 0.0, *IDENTITY], [*place, *IDENTITY]] for place in places])


def timed(most):
    """(name, shapes, translation) of each case of at most that many tetrahedra in a mesh. The finest ball and
    ellipsoid are not of Drake's benchmark."""
    for cells in CUBE_CELLS:
        if 6 * cells**3 > most:
            continue
        yield f"cubes, {6 * cells**3:,} each", (shapes.grid(cells),) * 2, CUBE_TRANSLATION
    for cells in (*CELLS, FINEST):
        if 6 * cells**3 > most:
            continue
        pair = tuple(shapes.ball(cells, radii) for radii in RADII)
        for shift in TRANSLATIONS:
            yield f"ellipsoid and ball, {6 * cells**3:,} each, {shift:g}", pair, (shift,) * 3
