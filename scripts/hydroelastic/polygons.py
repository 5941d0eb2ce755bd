# SPDX-License-Identifier: MIT
"""Polygons of equal pressure, as both programs give them."""

import dataclasses

import numpy

NEAR = 1e-6  # m: farther outside a tetrahedron is no point of it


@dataclasses.dataclass
class Polygons:
    """One row for each polygon. pair: tetrahedra of bodies A and B. normal: of length 1, into A. pressure: at the
    centroid."""

    pair: numpy.ndarray
    centroid: numpy.ndarray
    normal: numpy.ndarray
    area: numpy.ndarray
    pressure: numpy.ndarray

    def __len__(self):
        return len(self.area)

    def without(self, rows):
        """The others than these. rows: a truth for each polygon."""
        return Polygons(*(getattr(self, field.name)[~rows] for field in dataclasses.fields(self)))

    def wrench(self, origin):
        """(area, force on A, torque on A about a point), sums over the polygons, and the sum of the torques'
        lengths."""
        force = (self.area * self.pressure)[:, None] * self.normal
        torque = numpy.cross(self.centroid - origin, force)
        lengths = numpy.linalg.norm(torque, axis=1).sum()
        return self.area.sum(), force.sum(axis=0), torque.sum(axis=0), lengths


def rotation(pose):
    """The matrix of a pose tx ty tz qw qx qy qz."""
    w, x, y, z = pose[3:] / numpy.linalg.norm(pose[3:])
    return numpy.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


class Cells:
    """The tetrahedra of a mesh with a field, to find the one in which a polygon lies."""

    def __init__(self, shape, field):
        corner = shape.vertices[shape.tetrahedra]
        value = field[shape.tetrahedra]
        self._first = corner[:, 0]
        self._low, self._high = corner.min(axis=1) - NEAR, corner.max(axis=1) + NEAR
        self._inverse = numpy.linalg.inv((corner[:, 1:] - corner[:, :1]).transpose(0, 2, 1))
        self._gradient = numpy.einsum("ti,tij->tj", value[:, 1:] - value[:, :1], self._inverse)
        self._scale = numpy.linalg.norm(self._gradient, axis=1).max()

    def of(self, points, gradients, pose):
        """For each point the tetrahedron with this gradient that has it deepest inside."""
        turn = rotation(pose)
        points, gradients = (points - pose[:3]) @ turn, gradients @ turn
        found = numpy.empty(len(points), "i8")
        for i, (point, gradient) in enumerate(zip(points, gradients)):
            near = numpy.flatnonzero(((self._low <= point) & (point <= self._high)).all(axis=1))
            weights = numpy.einsum("tij,tj->ti", self._inverse[near], point - self._first[near])
            depth = numpy.minimum(weights.min(axis=1), 1 - weights.sum(axis=1))
            wrong = numpy.abs(self._gradient[near] - gradient).max(axis=1) > 1e-9 * self._scale
            found[i] = near[numpy.argmax(numpy.where(wrong, depth - 1e3, depth))]
        return found
