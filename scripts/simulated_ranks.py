# SPDX-License-Identifier: MIT
"""The deal of a pile to ranks without ranks: bodies along Hilbert's curve, cuts, and who is near by boxes, as algorithms/shares/deal.cpp
and algorithms/ranks/halo.cpp have them; what each rank would own, get and send. All bodies have one mesh, and all ranks are as fast."""
import dataclasses
import math
import pathlib

import numpy as np

MESHES = pathlib.Path(__file__).resolve().parent.parent / "scenes" / "meshes"
# k = 18 of algorithms/bounds/directions.clh.
DIRECTIONS = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, -1, 0], [1, 0, 1], [1, 0, -1], [0, 1, 1], [0, 1, -1]], float)
IN_A_BOX, IN_A_GROUP = 8, 32  # halo.cpp: bodies, boxes
LEAST_MARGIN, MOST_MARGIN, SOON = 0.25, 2.0, 8  # halo.cpp: of a radius; frames
ROOM = 2.0  # halo.cpp: times a margin, beyond it; who is that near has a place in the session
WORK_OF_A_PAIR, CUTS = 6, 4  # deal.cpp: in tetrahedra refitted; tried
SPIN, DRIFT = 0.03, 0.01  # pile.cpp: radians, and of a radius, a frame
LATTICE = (1 << 21) - 1  # hierarchy/order.cpp
MOST_EXACT = 2000  # bodies whose poses are the scene's own numbers unless asked for: of more they are as random, and made faster
AT_ONCE = 10_000  # rows whose neighbours are looked for together: what of them stays in a cache


@dataclasses.dataclass
class Jack:
    """What of a mesh the deal looks at: half of its box, radius about the box's middle, volume, tetrahedra."""
    half: np.ndarray
    radius: float
    volume: float
    tetrahedra: int


def jack():
    rows = lambda name: np.loadtxt(MESHES / name, comments="#", skiprows=2)
    vertices, corners = rows("jack.node")[:, 1:4], rows("jack.ele")[:, 1:5].astype(int)
    lower, upper = vertices.min(0), vertices.max(0)
    a, b, c, d = (vertices[corners[:, i]] for i in range(4))
    volume = np.abs(np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a))).sum() / 6
    return Jack((upper - lower) / 2, float(np.linalg.norm(vertices - (lower + upper) / 2, axis=1).max()), float(volume), len(corners))


class SplitMix:
    """scenes/random.cpp, number for number."""

    def __init__(self, seed):
        self.state = seed

    def uniform(self, low=-1.0, high=1.0):
        mask = (1 << 64) - 1
        self.state = x = (self.state + 0x9e3779b97f4a7c15) & mask
        x = ((x ^ (x >> 30)) * 0xbf58476d1ce4e5b9) & mask
        x = ((x ^ (x >> 27)) * 0x94d049bb133111eb) & mask
        return low + (high - low) * (((x ^ (x >> 31)) >> 11) * 2.0 ** -53)

    def on_ball(self, size):
        while True:
            x = [self.uniform() for _ in range(size)]
            square = sum(v * v for v in x)
            if 1e-6 <= square <= 1:
                return [v / math.sqrt(square) for v in x]


def scene_poses(bodies, seed):
    """Places in a cube of side 1 and rotations {w, x, y, z} of frame 0, as scenes/pile.cpp draws them."""
    chance = SplitMix(seed)
    places, rotations = [], []
    for _ in range(bodies):
        places.append([chance.uniform(-0.5, 0.5) for _ in range(3)])
        rotations.append(chance.on_ball(4))
        chance.on_ball(3), chance.on_ball(3)  # axis and drift
    return np.array(places), np.array(rotations)


def random_poses(bodies, seed):
    chance = np.random.default_rng(seed)
    rotations = chance.standard_normal((bodies, 4))
    return chance.random((bodies, 3)) - 0.5, rotations / np.linalg.norm(rotations, axis=1)[:, None]


def hilbert_codes(points):
    """hierarchy/order.cpp's, of all points at once."""
    lower, extent = points.min(0), np.ptp(points, axis=0).max()
    axes = [np.minimum((points[:, i] - lower[i]) * (LATTICE / extent if extent else 0), LATTICE).astype(np.uint32) for i in range(3)]
    bit = (LATTICE + 1) // 2
    while bit > 1:
        for i in range(3):
            is_set = (axes[i] & bit) != 0
            swapped = np.where(is_set, 0, (axes[0] ^ axes[i]) & (bit - 1)).astype(np.uint32)
            axes[0] ^= np.where(is_set, bit - 1, swapped).astype(np.uint32)
            axes[i] ^= swapped
        bit //= 2
    axes[1] ^= axes[0]
    axes[2] ^= axes[1]
    flipped = np.zeros(len(points), np.uint32)
    bit = (LATTICE + 1) // 2
    while bit > 1:
        flipped ^= np.where(axes[2] & bit, bit - 1, 0).astype(np.uint32)
        bit //= 2
    return spread(axes[0] ^ flipped) << 2 | spread(axes[1] ^ flipped) << 1 | spread(axes[2] ^ flipped)


def spread(x):
    """The 21 low bits to every third bit."""
    x = x.astype(np.uint64) & LATTICE
    for shift, mask in ((32, 0x1f00000000ffff), (16, 0x1f0000ff0000ff), (8, 0x100f00f00f00f00f), (4, 0x10c30c30c30c30c3), (2, 0x1249249249249249)):
        x = (x | x << np.uint64(shift)) & np.uint64(mask)
    return x


class Pile:
    """Bodies of frame 0 in the order of the curve: `centres` and half `widths` along DIRECTIONS."""

    def __init__(self, bodies, density, seed=1, most_exact=MOST_EXACT):
        self.mesh = jack()
        places, rotations = (scene_poses if bodies <= most_exact else random_poses)(bodies, seed)
        centres = places * (bodies * self.mesh.volume / density) ** (1 / 3)
        order = np.argsort(hilbert_codes(centres), kind="stable")
        self.centres, rotations = centres[order], rotations[order]
        self.widths = np.empty((bodies, len(DIRECTIONS)))
        for first in range(0, bodies, AT_ONCE):
            part = slice(first, first + AT_ONCE)
            self.widths[part] = np.abs(np.einsum("nji,dj->ndi", matrices(rotations[part]), DIRECTIONS)) @ self.mesh.half
        self.grid = Grid(self.centres, self.mesh.radius)


def matrices(q):
    """Of rotations {w, x, y, z}: rows, columns last."""
    w, x, y, z = q.T
    return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                     2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], -1).reshape(-1, 3, 3)


def expanded(first, end):
    """Of ranges of whole numbers: which range each number is of, and the number."""
    counts = np.maximum(end - first, 0)
    which = np.repeat(np.arange(len(first)), counts)
    return which, np.arange(len(which)) + np.repeat(first - (np.cumsum(counts) - counts), counts)


class Grid:
    """Points in cubes of a side; those of a column of cubes lie behind one another."""

    def __init__(self, points, side):
        self.lower, self.side = points.min(0), side
        self.counts = self.cubes(points.max(0)) + 1
        self.cells = self.cubes(points)
        numbers = (self.cells[:, 0] * self.counts[1] + self.cells[:, 1]) * self.counts[2] + self.cells[:, 2]
        self.order = np.argsort(numbers, kind="stable").astype(np.int32)
        self.starts = np.concatenate([[0], np.cumsum(np.bincount(numbers, minlength=int(self.counts.prod())))])

    def cubes(self, points):
        return np.floor((points - self.lower) / self.side).astype(np.int64)

    def column(self, x, y, low, high):
        """Places, first and end, of cubes low..high of a column; none where there is no such column."""
        inside = (x >= 0) & (x < self.counts[0]) & (y >= 0) & (y < self.counts[1])
        row = np.where(inside, (x * self.counts[1] + y) * self.counts[2], 0)
        low, high = np.maximum(low, 0), np.minimum(high, self.counts[2] - 1)
        return self.starts[row + np.minimum(low, self.counts[2] - 1)], np.where(inside & (low <= high), self.starts[row + np.maximum(high, 0) + 1], 0)

    def near(self, lower, upper):
        """(box, point) of all points in cubes that the boxes reach; more than those within."""
        low, high = np.maximum(self.cubes(lower), 0), np.minimum(self.cubes(upper), self.counts - 1)
        box, x = expanded(low[:, 0], high[:, 0] + 1)
        column, y = expanded(low[box, 1], high[box, 1] + 1)
        box, x = box[column], x[column]
        which, place = expanded(*self.column(x, y, low[box, 2], high[box, 2]))
        return box[which], self.order[place]

    def pairs(self, first, end, reach):
        """Pairs, once each, of the points first..end - 1 in the order of cubes with all others in cubes so many sides off or nearer."""
        points, cells = self.order[first:end], self.cells[self.order[first:end]]
        x, y, z = cells.T
        parts = []
        for i in range(reach + 1):
            for j in range(-reach if i else 0, reach + 1):
                begin, stop = self.column(x + i, y + j, z if (i, j) == (0, 0) else z - reach, z + reach)
                if (i, j) == (0, 0):
                    begin = np.arange(first + 1, end + 1)  # of the same cube those behind
                which, place = expanded(begin, stop)
                parts.append((points[which], self.order[place]))
        return (np.concatenate(part) for part in zip(*parts))


def expected_pairs(distance, mesh):
    """deal.cpp's, of two balls of one mesh: tetrahedra strewn evenly through balls, those that come as near as both are large."""
    r = mesh.radius
    depth = np.maximum(2 * r - distance, 0)
    common = np.pi * depth ** 2 * (distance ** 2 + 4 * distance * r) / (12 * np.maximum(distance, 1e-300))
    density = mesh.tetrahedra / (4 * np.pi / 3 * r ** 3)
    return common * density ** 2 * (2 / np.cbrt(density)) ** 3


@dataclasses.dataclass
class Pairs:
    """Of each body with those that follow it on the curve: candidate pairs expected from balls, and pairs of bodies whose balls and bounds
    overlap; `near`, from `starts`: the later bodies of pairs whose balls do not lie apart along any direction, which the deal goes by."""
    expected: np.ndarray
    bodies: np.ndarray
    near: np.ndarray
    starts: np.ndarray


def pairs_of_bodies(pile):
    many, reach = len(pile.centres), 2 * pile.mesh.radius
    lengths = np.linalg.norm(DIRECTIONS, axis=1)
    expected, pairs, first_of, second_of = np.zeros(many), np.zeros(many, np.int64), [], []
    for first in range(0, many, AT_ONCE):
        a, b = pile.grid.pairs(first, min(first + AT_ONCE, many), math.ceil(reach / pile.grid.side))
        close = np.ones(len(a), bool)
        for axis in np.ascontiguousarray(pile.centres.T):
            close &= np.abs(axis[a] - axis[b]) <= reach
        a, b = a[close], b[close]
        way = pile.centres[a] - pile.centres[b]
        along = np.abs(way @ DIRECTIONS.T)
        close = (along <= reach * lengths).all(1)
        a, b, along, way = np.minimum(a, b)[close], np.maximum(a, b)[close], along[close], way[close]
        distance = np.sqrt(np.einsum("ij,ij->i", way, way))
        np.add.at(expected, a, expected_pairs(distance, pile.mesh))
        np.add.at(pairs, a[(distance < reach) & (along <= pile.widths[a] + pile.widths[b]).all(1)], 1)
        first_of.append(a), second_of.append(b)
    first_of, near = np.concatenate(first_of), np.concatenate(second_of)
    order = np.argsort(first_of, kind="stable")
    return Pairs(expected, pairs, near[order], np.concatenate([[0], np.cumsum(np.bincount(first_of, minlength=many))]))


def cut_once(work, brought):
    """The first body of each rank, and the end: a body goes to the rank in whose part the middle of its work lies, and a part is less by
    what others' bodies bring that rank."""
    middles = np.cumsum(work) - work / 2
    parts = np.maximum(0, (work.sum() + brought.sum()) / len(brought) - brought)
    return np.concatenate([[0], np.searchsorted(middles, np.cumsum(parts)[:-1]), [len(work)]])


def brought_by(starts, pairs):
    """Of each rank: how many bodies of later ones its own have pairs with."""
    is_there, counts = np.zeros(len(pairs.expected), bool), []
    for first, end in zip(starts, starts[1:]):
        near = pairs.near[pairs.starts[first]:pairs.starts[end]]
        near = near[near >= end]
        is_there[near] = True
        counts.append(np.count_nonzero(is_there))
        is_there[near] = False
    return np.array(counts)


def sums(values, starts):
    """Of each rank's bodies."""
    return np.diff(np.concatenate([[0], np.cumsum(values)])[starts])


def cuts(pairs, mesh, ranks):
    """Deal::cut: of four cuts, each with what the last one brought, that in which the rank that takes longest is done first."""
    work = mesh.tetrahedra + WORK_OF_A_PAIR * pairs.expected
    brought, shortest, best = np.zeros(ranks), math.inf, None
    for _ in range(CUTS):
        starts = cut_once(work, brought)
        brought = mesh.tetrahedra * brought_by(starts, pairs).astype(float)
        longest = (sums(work, starts) + brought).max()
        if longest < shortest:
            shortest, best = longest, starts
    return best


class Slabs:
    """Ends of bodies along DIRECTIONS, with a margin."""

    def __init__(self, pile, margin):
        middles = pile.centres @ DIRECTIONS.T
        widths = pile.widths + margin * pile.mesh.radius * np.linalg.norm(DIRECTIONS, axis=1)
        self.lower, self.upper = middles - widths, middles + widths

    def around(self, firsts):
        """Boxes around bodies from each of these to the next."""
        boxes = object.__new__(Slabs)
        boxes.lower, boxes.upper = np.minimum.reduceat(self.lower, firsts), np.maximum.reduceat(self.upper, firsts)
        return boxes

    def meet(self, own, others, theirs):
        """Of pairs of numbers, of these slabs and of others: which overlap."""
        found = np.arange(len(own))
        for axes in (slice(0, 3), slice(3, None)):  # most lie apart along the first
            a, b = own[found], theirs[found]
            found = found[((self.lower[a, axes] <= others.upper[b, axes]) & (others.lower[b, axes] <= self.upper[a, axes])).all(1)]
        return found


class Met:
    """What ranks find when they meet: {rank, body} of each body of a later rank that meets one of a rank's boxes, with more than a margin
    (`offered`), of those that meet one of its bodies so (`room`: its session has them), and of those within the margin (`halo`); which ranks
    send which their boxes."""

    def __init__(self, pile, starts, margin):
        ranks = len(starts) - 1
        self.owners = np.repeat(np.arange(ranks), np.diff(starts))
        self.slabs = Slabs(pile, margin)
        self.firsts = np.concatenate([np.arange(a, b, IN_A_BOX) for a, b in zip(starts, starts[1:])])
        self.wide = Slabs(pile, (1 + ROOM) * margin)
        self.boxes = self.wide.around(self.firsts)
        filled = np.flatnonzero(np.diff(starts))
        whole = self.wide.around(starts[filled])
        a, b = np.triu_indices(len(filled), 1)
        hears = whole.meet(a, whole, b)
        self.told, self.hears = filled[a[hears]], filled[b[hears]]
        self.offered, self.room, self.halo = (np.unique(np.concatenate(codes)) for codes in zip(*self.parts(pile, margin)))

    def of(self, codes):
        return codes // len(self.owners), codes % len(self.owners)

    def parts(self, pile, margin):
        """(offered, room, halo) of some boxes at a time, as rank times bodies plus body."""
        reach = np.linalg.norm(pile.mesh.half) + margin * pile.mesh.radius  # corners of a turned box reach further than the ball
        rank_of_box = self.owners[self.firsts]
        for first in range(0, len(self.firsts), AT_ONCE // 8):
            part = slice(first, first + AT_ONCE // 8)
            box, body = pile.grid.near(self.boxes.lower[part, :3] - reach, self.boxes.upper[part, :3] + reach)
            box += first
            later = self.owners[body] > rank_of_box[box]
            box, body = box[later], body[later]
            meets = self.boxes.meet(box, self.slabs, body)
            box, body = box[meets], body[meets]
            codes, which = np.unique(rank_of_box[box] * len(self.owners) + body, return_inverse=True)
            yield codes, *(codes[self.is_near(slabs, box, body, which, len(codes))] for slabs in (self.wide, self.slabs))

    def is_near(self, slabs, box, body, which, many):
        """Of so many bodies at boxes: whether one of a box's bodies, with these slabs, meets it."""
        kept, end = np.zeros(many, bool), np.append(self.firsts, len(self.owners))
        for i in range(IN_A_BOX):
            one = self.firsts[box] + i
            rest = np.flatnonzero(~kept[which] & (one < end[box + 1]))
            kept[which[rest[slabs.meet(one[rest], self.slabs, body[rest])]]] = True
        return kept


def settled_margin():
    """The margin that holds for long enough in a pile, and for how many frames: it doubles until then, as halo.cpp has it."""
    way = DRIFT + 2 * math.sin(SPIN / 2)  # of a radius, a frame: places.cpp
    margin = LEAST_MARGIN
    while int(margin / way) < SOON and margin < MOST_MARGIN:
        margin *= 2
    return margin, int(margin / way)


def count(pile, ranks, margin, pairs=None):
    """Of each rank: bodies it owns, gets and sends in a frame, from and to how many ranks, and has room for beside its own; when
    ranks meet, bodies that it hears of and tells others of, and from and to how many ranks boxes go; bodies of others and pairs of the deal; pairs of bodies and candidate pairs
    expected. `pairs`: pairs_of_bodies(pile), where they are known."""
    pairs = pairs or pairs_of_bodies(pile)
    starts = cuts(pairs, pile.mesh, ranks)
    met = Met(pile, starts, margin)
    each = lambda values: np.bincount(values, minlength=ranks)
    (to, body), (hears, told) = met.of(met.halo), met.of(met.offered)
    links = np.unique(to * ranks + met.owners[body])
    return {"own": np.diff(starts), "halo": each(to), "sent": each(met.owners[body]), "senders": each(links // ranks), "receivers": each(links % ranks),
            "room": each(met.of(met.room)[0]), "offered": each(hears), "offers": each(met.owners[told]), "boxes_from": each(met.hears), "boxes_to": each(met.told),
            "brought": brought_by(starts, pairs), "near_pairs": np.diff(pairs.starts[starts]), "body_pairs": sums(pairs.bodies, starts),
            "expected_pairs": np.rint(sums(pairs.expected, starts)).astype(np.int64)}
