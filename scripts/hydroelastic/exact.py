# SPDX-License-Identifier: MIT
"""The polygon of two tetrahedra in rational arithmetic, and why rounding may decide about it."""

import math
from fractions import Fraction

import numpy

COSINE_OF_LIMIT = math.cos(5 * math.pi / 8)
DRAKES_TOLERANCE = 1e-14  # m: Drake joins corners that are nearer
LEAST_AREA = 1e-12  # of the largest polygon
IDLE, LIMIT = "in a boundary face, at pressure 0", "at the limit of angle"  # reasons


def rational(array):
    return [[Fraction(value) for value in row] for row in numpy.asarray(array, float).tolist()]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def length(a):
    return math.sqrt(dot(a, a))


def placed(corners, pose):
    """Corners in the world; the pose's quaternion is normalised without rounding."""
    *shift, w, x, y, z = (Fraction(value) for value in numpy.asarray(pose, float).tolist())
    vector, square = [x, y, z], w * w + x * x + y * y + z * z
    moved = []
    for corner in rational(corners):
        twice = [2 * value for value in cross(vector, corner)]
        turned = [w * a + b for a, b in zip(twice, cross(vector, twice))]
        moved.append([p + d / square + s for p, d, s in zip(corner, turned, shift)])
    return moved


class Linear:
    """A tetrahedron with pressures at its corners: the weights of corners and the pressure as linear functions."""

    def __init__(self, corners, pressures):
        self.weights = []
        for i in range(4):
            first, second, third = (corners[(i + j) % 4] for j in (1, 2, 3))
            normal = cross(minus(second, first), minus(third, first))
            height = dot(normal, minus(corners[i], first))
            along = [value / height for value in normal]
            self.weights.append((along, -dot(along, first)))
        values = [Fraction(float(value)) for value in pressures]
        self.gradient = [sum(v * w[0][k] for v, w in zip(values, self.weights)) for k in range(3)]
        self.offset = sum(v * w[1] for v, w in zip(values, self.weights))
        # Rounding of corners and pressures moves the gradient by about this, times the unit roundoff.
        self.size = max(float(max(values)) * length(along) for along, _ in self.weights)


def cut(polygon, along, offset):
    """What of a polygon is where a linear function is not negative."""
    heights = [dot(along, corner) + offset for corner in polygon]
    kept = []
    for i, (corner, height) in enumerate(zip(polygon, heights)):
        before, height_before = polygon[i - 1], heights[i - 1]
        if (height < 0) != (height_before < 0):
            part = height_before / (height_before - height)
            kept.append([p + part * (q - p) for p, q in zip(before, corner)])
        if height >= 0:
            kept.append(corner)
    return kept


def area(polygon):
    total = [Fraction(0)] * 3
    for i in range(2, len(polygon)):
        part = cross(minus(polygon[i - 1], polygon[0]), minus(polygon[i], polygon[0]))
        total = [a + b for a, b in zip(total, part)]
    return length(total) / 2


def distinct(polygon, tolerance):
    """The number of corners after joining those nearer than a tolerance to the corner before."""
    count = sum(length(minus(corner, polygon[i - 1])) >= tolerance for i, corner in enumerate(polygon))
    return count if len(polygon) > 1 else len(polygon)


class Pair:
    """Two tetrahedra in the world, with pressures. `tolerance`: relative, what rounding may change."""

    def __init__(self, a, pressures_of_a, b, pressures_of_b, tolerance):
        self.a, self.b, self._tolerance = Linear(a, pressures_of_a), Linear(b, pressures_of_b), tolerance
        self._centre = a[0]
        self._reach = 4 * max(abs(value) for corner in a for value in minus(corner, a[0]))
        self.difference = minus(self.a.gradient, self.b.gradient)
        self._is_idle = not any(pressures_of_a) or not any(pressures_of_b)

    def polygon(self, margin=0.0):
        """The polygon inside both, from whose faces it keeps this part of a height."""
        normal, offset = self.difference, self.a.offset - self.b.offset
        square = dot(normal, normal)
        if square == 0:
            return []
        axis = min(range(3), key=lambda i: abs(normal[i]))
        one = cross(normal, [Fraction(int(i == axis)) for i in range(3)])
        two = cross(normal, one)
        step = (dot(normal, self._centre) + offset) / square
        middle = [c - step * n for c, n in zip(self._centre, normal)]
        u, v = ([value * self._reach / Fraction(length(d)) for value in d] for d in (one, two))
        corners = [
            [m + s * p + t * q for m, p, q in zip(middle, u, v)]
            for s, t in ((1, 1), (-1, 1), (-1, -1), (1, -1))
        ]
        for along, constant in self.a.weights + self.b.weights:
            corners = cut(corners, along, constant - Fraction(margin))
        return corners

    def cosines(self):
        """Of the normal with A's gradient, and of its opposite with B's; 1 for a gradient of 0."""
        size = length(self.difference)
        a, b = length(self.a.gradient), length(self.b.gradient)
        return (
            float(dot(self.difference, self.a.gradient)) / (size * a) if a else 1.0,
            -float(dot(self.difference, self.b.gradient)) / (size * b) if b else 1.0,
        )

    def reason(self, largest):
        """Why two programs that round differently may differ here, or "unexplained". `largest`: area of the largest
        polygon of the frame."""
        rounding = self._tolerance
        if length(self.difference) <= rounding * (self.a.size + self.b.size):
            return "of equal gradients"
        if any(abs(cosine - COSINE_OF_LIMIT) <= rounding for cosine in self.cosines()):
            return LIMIT
        grown = self.polygon(-rounding)
        if area(grown) <= LEAST_AREA * largest:
            return "small"
        if area(self.polygon(rounding)) == 0:
            return IDLE if self._is_idle else "in a face"
        here = self.polygon()
        return "of near corners" if distinct(here, 2 * DRAKES_TOLERANCE) < len(here) else "unexplained"
