# SPDX-License-Identifier: MIT
"""Cases: one or two sets of boxes, and the incident pairs, which share a vertex of a mesh."""

import collections

import numpy

from boxes import sweep, swept
from boxes.errors import BadData
from boxes.ply import contents

NO_KEYS = numpy.empty(0, "i8")
ROW = 6 * 4  # bytes of a box in a file: lo and hi in float


class Case(collections.namedtuple("Case", "kind names boxes incident")):
    """kind: a name; names and boxes: of the two sets, or of one whose pairs with itself count; incident:
    ascending keys of pairs."""

    def sweep(self):
        return sweep.between(*self.boxes) if len(self.boxes) == 2 else sweep.within(*self.boxes)


def of_frames(first, second, kinds):
    """Yields the cases of these kinds of two frames of a mesh. Raises BadData."""
    vertices, faces = swept.frames(first, second)
    of_vertices, edges = swept.boxes_of(vertices), swept.edges_of(faces)
    for kind in kinds:
        if kind == "vertex-face":
            of_both = of_vertices, swept.boxes_around(of_vertices, faces)
            yield Case(kind, ("vertices", "faces"), of_both, swept.own_vertices(faces))
        else:
            name, elements = ("edges", edges) if kind == "edge-edge" else ("faces", faces)
            yield Case(kind, (name,), (swept.boxes_around(of_vertices, elements),), swept.sharing(elements))


def boxes_in(path):
    """Boxes of a file of rows of six little-endian floats: lo and hi. Raises BadData."""
    data = contents(path)
    if not data or len(data) % ROW:
        raise BadData(f"{path}: has {len(data)} bytes; expected {ROW} for each box")
    rows = numpy.frombuffer(data, "<f4").astype("f8").reshape(-1, 2, 3)
    wrong = numpy.flatnonzero(~(numpy.isfinite(rows).all((1, 2)) & (rows[:, 0] <= rows[:, 1]).all(1)))
    if wrong.size:
        raise BadData(f"{path}: box {wrong[0]} is not finite, or has lo above hi")
    return rows[:, 0], rows[:, 1]


def of_boxes(first, second, kinds):
    """Yields the cases of these kinds of two files of boxes; `within` is of the second. Raises BadData."""
    both = boxes_in(first), boxes_in(second)
    for kind in kinds:
        yield Case(
            kind, *((("first", "second"), both) if kind == "between" else (("second",), both[1:])), NO_KEYS
        )
