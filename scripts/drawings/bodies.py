# SPDX-License-Identifier: MIT
"""Two bodies of triangles that overlap, and their trees. Triangles stand for tetrahedra, boxes for k-DOPs."""

import dataclasses
import math

ACROSS, ALONG = 16, 4  # cells of the mesh, with two triangles each
LEAVES = 2 * ACROSS * ALONG


def mesh():
    """Triangles of a long body with rounded ends, which is thicker in its middle."""

    def point(i, j):
        x, y = 2 * i / ACROSS - 1, 2 * j / ALONG - 1
        return x * (1 - 0.07 * y * y), 0.26 * y * math.sqrt(1 - 0.6 * x * x) + 0.1 * x * x

    triangles = []
    for i in range(ACROSS):
        for j in range(ALONG):
            corners = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]
            start = (i < ACROSS // 2) == (j < ALONG // 2)  # diagonals away from the middle
            a, b, c, d = corners[start:] + corners[:start]
            triangles += [(a, b, c), (a, c, d)]
    return triangles


def placed(triangles, angle, scale, x, y):
    """The triangles turned by an angle in degrees, scaled and moved."""
    cos, sin = scale * math.cos(math.radians(angle)), scale * math.sin(math.radians(angle))
    return [tuple((cos * p - sin * q + x, sin * p + cos * q + y) for p, q in one) for one in triangles]


def box_of(points):
    xs, ys = zip(*points)
    return min(xs), min(ys), max(xs), max(ys)


def union(a, b):
    return min(a[0], b[0]), min(a[1], b[1]), max(a[2], b[2]), max(a[3], b[3])


def overlap(a, b):
    """Closed: boxes that touch overlap."""
    return a[0] <= b[2] and b[0] <= a[2] and a[1] <= b[3] and b[1] <= a[3]


def size(box):
    """The sum of the squared widths, by which walks choose the larger of two nodes."""
    return (box[2] - box[0]) ** 2 + (box[3] - box[1]) ** 2


def common(triangle, other):
    """The corners of the common part of two triangles, or none (Sutherland and Hodgman 1974)."""
    side = lambda p, q, r: (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
    sign = 1 if side(*other) > 0 else -1
    corners = list(triangle)
    for start, end in zip(other, (*other[1:], other[0])):
        whole, corners = corners, []
        for p, q in zip(whole, (*whole[1:], *whole[:1])):
            one, two = sign * side(start, end, p), sign * side(start, end, q)
            if one >= 0:
                corners.append(p)
            if one * two < 0:
                part = one / (one - two)
                corners.append((p[0] + part * (q[0] - p[0]), p[1] + part * (q[1] - p[1])))
    return corners


def halved(triangles):
    """The triangles in an order whose halves, and halves of these, are compact."""
    if len(triangles) == 1:
        return triangles
    middle = lambda triangle, axis: sum(point[axis] for point in triangle)
    widths = [
        max(middle(t, axis) for t in triangles) - min(middle(t, axis) for t in triangles) for axis in (0, 1)
    ]
    axis = int(widths[1] > widths[0])
    ordered = sorted(triangles, key=lambda t: (round(middle(t, axis), 9), round(middle(t, 1 - axis), 9)))
    half = len(ordered) // 2
    return halved(ordered[:half]) + halved(ordered[half:])


@dataclasses.dataclass
class Body:
    """nodes: boxes of a complete binary tree in heap order, from 1 on. Node n has the children 2n and 2n + 1, and
    leaf LEAVES + i has triangle i."""

    triangles: list
    nodes: list = dataclasses.field(init=False)

    def __post_init__(self):
        self.triangles = halved(self.triangles)
        self.nodes = [None] * LEAVES + [box_of(triangle) for triangle in self.triangles]
        for node in reversed(range(1, LEAVES)):
            self.nodes[node] = union(self.nodes[2 * node], self.nodes[2 * node + 1])

    def below(self, node):
        """The triangles below a node."""
        depth = LEAVES.bit_length() - node.bit_length()
        first = (node << depth) - LEAVES
        return range(first, first + (1 << depth))

    def boxes_below(self, node):
        return [self.nodes[LEAVES + triangle] for triangle in self.below(node)]


def two_bodies():
    return Body(placed(mesh(), 3, 242, 268, 62)), Body(placed(mesh(), 5, 242, 252, 149))
