# SPDX-License-Identifier: MIT
"""Pairs of boxes that overlap, independent of tandem: a sweep along x in the cells of a grid over y and z.

Boxes are pairs (lo, hi) of arrays of shape (n, 3). Overlap is closed. A pair (i, j) has the key i * m + j,
where m is the number of second boxes."""

import numpy

AT_ONCE = 1 << 23  # pairs that are tested together
MOST_CELLS = 256  # along an axis


def runs(first, last):
    """Yields (number of the run, element) of all runs first[i] .. last[i] - 1, at most about AT_ONCE elements
    at a time."""
    lengths = numpy.maximum(last - first, 0)
    ends = numpy.cumsum(lengths)
    begin = 0
    while begin < len(lengths):
        done = ends[begin - 1] if begin else 0
        end = max(begin + 1, int(numpy.searchsorted(ends, done + AT_ONCE, "right")))
        part = lengths[begin:end]
        run = numpy.repeat(numpy.arange(begin, end), part)
        element = numpy.arange(len(run)) - numpy.repeat(numpy.cumsum(part) - part, part) + first[run]
        yield run, element
        begin = end


class Grid:
    """Cells over y and z, and the order of all lower bounds along x."""

    def __init__(self, boxes):
        lo, hi = (numpy.concatenate([one[side] for one in boxes]) for side in (0, 1))
        self.origin = lo.min(0)
        extent = (hi.max(0) - self.origin)[1:]
        self.size = numpy.maximum(
            numpy.maximum(extent / MOST_CELLS, 2 * (hi - lo).mean(0)[1:]), numpy.finfo("f8").tiny
        )
        self.columns = self.cell(hi.max(0)[None])[0, 1] + 1
        self.x = numpy.unique(lo[:, 0])

    def cell(self, points):
        return ((points - self.origin)[:, 1:] / self.size).astype("i8")


class Entries:
    """An entry for each cell that a box meets, in the order of cells, then of lower bounds along x."""

    def __init__(self, grid, boxes):
        self.lo, self.hi = boxes
        self.low, high = grid.cell(self.lo), grid.cell(self.hi)
        wide = high - self.low + 1
        box, part = map(numpy.concatenate, zip(*runs(numpy.zeros(len(wide), "i8"), wide.prod(1))))
        cell = self.low[box] + numpy.stack([part // wide[box, 1], part % wide[box, 1]], 1)
        base = (cell[:, 0] * grid.columns + cell[:, 1]) * (len(grid.x) + 1)
        key = base + numpy.searchsorted(grid.x, self.lo[box, 0])
        last = base + numpy.searchsorted(grid.x, self.hi[box, 0], "right")
        order = numpy.argsort(key, kind="stable")
        self.box, self.cell, self.key, self.last = box[order], cell[order], key[order], last[order]


def later(a, b, first):
    """Numbers of overlapping boxes whose second entry is in the run of its first: from first[i] on in b, up
    to the end along x of entry i."""
    found = [numpy.empty((0, 2), "i8")]
    for entry, other in runs(first, numpy.searchsorted(b.key, a.last)):
        i, j = a.box[entry], b.box[other]
        is_kept = numpy.ones(len(i), bool)
        for axis in (1, 2):
            is_kept &= (a.lo[i, axis] <= b.hi[j, axis]) & (b.lo[j, axis] <= a.hi[i, axis])
        entry, i, j = entry[is_kept], i[is_kept], j[is_kept]
        # Both boxes have entries in all cells that they share; the lowest one has the pair.
        is_home = (numpy.maximum(a.low[i], b.low[j]) == a.cell[entry]).all(1)
        found.append(numpy.stack([i[is_home], j[is_home]], 1))
    return numpy.concatenate(found)


def between(a, b):
    """Keys of overlapping pairs of a box of `a` and a box of `b`, in ascending order."""
    grid = Grid([a, b])
    of_a, of_b = Entries(grid, a), Entries(grid, b)
    above = later(of_a, of_b, numpy.searchsorted(of_b.key, of_a.key))
    below = later(of_b, of_a, numpy.searchsorted(of_a.key, of_b.key, "right"))
    return numpy.sort(
        numpy.concatenate([above[:, 0] * len(b[0]) + above[:, 1], below[:, 1] * len(b[0]) + below[:, 0]])
    )


def within(a):
    """Keys of overlapping pairs i < j of boxes of `a`, in ascending order."""
    entries = Entries(Grid([a]), a)
    pairs = later(entries, entries, numpy.arange(1, len(entries.key) + 1))
    return numpy.sort(pairs.min(1) * len(a[0]) + pairs.max(1))
