# SPDX-License-Identifier: MIT
"""Compares the polygons of both programs, pair of tetrahedra by pair."""

import dataclasses

import numpy

from hydroelastic import exact

TOLERANCE = {"double": 1e-9, "float": 1e-4}  # of area, force and torque, relative
ROUNDING = {"double": 1e-12, "float": 1e-5}  # of weights of corners and gradients, with some to spare


WITHOUT_FORCE = 1e-6  # of modulus times area: a smaller force is 0 but for cancellation


@dataclasses.dataclass
class Single:
    """A polygon that only one side has. share: its area over that of the frame's largest polygon."""

    frame: int
    side: str
    pair: tuple
    area: float
    share: float
    reason: str

    @property
    def is_excused(self):
        return self.share <= exact.LEAST_AREA or self.reason in (exact.IDLE, exact.LIMIT)


@dataclasses.dataclass
class Frame:
    """One pose's result. counts: of both sides, polygons and idle ones. differences: those of
    Comparison.differences(). judged: the same without polygons of one side at the limit of angle."""

    counts: tuple
    differences: tuple
    judged: tuple
    singles: list


def unmatched(mine, others):
    """Rows of `mine` whose pair of tetrahedra the others lack."""
    have = set(map(tuple, others.pair.tolist()))
    return [row for row, pair in enumerate(map(tuple, mine.pair.tolist())) if pair not in have]


def without_twins(left, theirs, right, ours, tolerance):
    """Rows of both sides less those with equal area and place: of a polygon in a face, which several tetrahedra
    share, the sides may name different ones."""
    left, right = list(left), list(right)
    for row in tuple(left):
        for other in right:
            near = numpy.abs(theirs.centroid[row] - ours.centroid[other]).max() <= tolerance
            if near and abs(theirs.area[row] - ours.area[other]) <= tolerance * theirs.area[row]:
                left.remove(row)
                right.remove(other)
                break
    return left, right


class Comparison:
    """Of two bodies. shapes, fields: those of A and B. poses: (frames, 2, 7)."""

    def __init__(self, shapes, fields, poses, precision):
        self._shapes, self._fields, self._poses = shapes, fields, poses
        self._rounding = ROUNDING[precision]
        self._idle = [field[shape.tetrahedra].max(axis=1) == 0 for shape, field in zip(shapes, fields)]

    def idle(self, polygons):
        """Of each polygon, whether a tetrahedron has pressure 0 at all corners."""
        return self._idle[0][polygons.pair[:, 0]] | self._idle[1][polygons.pair[:, 1]]

    def pair(self, frame, numbers):
        """Two tetrahedra of a frame, in rational numbers."""
        parts = []
        for shape, field, number, pose in zip(self._shapes, self._fields, numbers, self._poses[frame]):
            cell = shape.tetrahedra[number]
            parts += [exact.placed(shape.vertices[cell], pose), field[cell]]
        return exact.Pair(*parts, self._rounding)

    def differences(self, frame, theirs, ours):
        """Relative, of area, force and torque, and of torque over the sum of the torques' lengths."""
        origin = self._poses[frame, 0, :3]
        one, other = (polygons.wrench(origin) for polygons in (theirs, ours))
        force = WITHOUT_FORCE * max(field.max() for field in self._fields) * one[0]
        torque = force * self._shapes[0].radius
        apart = [numpy.linalg.norm(a - b) for a, b in zip(one[:3], other[:3])]
        sizes = [max(numpy.linalg.norm(a), floor) for a, floor in zip(one, (0.0, force, torque, torque))]
        return tuple(a / size if size > 0 else a for a, size in zip((*apart, apart[2]), sizes))

    def frame(self, frame, theirs, ours):
        """Compares Drake's polygons of a frame with tandem's."""
        rows = unmatched(theirs, ours), unmatched(ours, theirs)
        left, right = without_twins(rows[0], theirs, rows[1], ours, self._rounding)
        largest = max([*theirs.area, *ours.area], default=0.0)
        singles = [
            self._single(frame, side, polygons, row, largest)
            for side, polygons, rows in (("Drake", theirs, left), ("tandem", ours, right))
            for row in rows
        ]
        idle = self.idle(theirs), self.idle(ours)
        pressing = theirs.without(idle[0]), ours.without(idle[1])
        limit = [single.pair for single in singles if single.reason == exact.LIMIT]
        judged = (
            polygons.without(numpy.array([tuple(pair) in limit for pair in polygons.pair.tolist()], bool))
            for polygons in pressing
        )
        return Frame(
            (len(theirs), len(ours), int(idle[0].sum()), int(idle[1].sum())),
            self.differences(frame, *pressing),
            self.differences(frame, *judged),
            singles,
        )

    def _single(self, frame, side, polygons, row, largest):
        pair, area = tuple(polygons.pair[row].tolist()), float(polygons.area[row])
        return Single(frame, side, pair, area, area / largest, self.pair(frame, pair).reason(largest))
