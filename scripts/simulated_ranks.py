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
WORK_OF_A_PAIR = 6  # deal.cpp: in tetrahedra refitted
SPIN, DRIFT = 0.03, 0.01  # pile.cpp: radians, and of a radius, a frame
LATTICE = (1 << 21) - 1  # hierarchy/order.cpp
MOST_EXACT = 2000  # bodies whose poses are the scene's own numbers unless asked for: of more they are as random, and made faster
AT_ONCE = 100_000  # rows whose neighbours are looked for together: memory


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
    return which, np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts) + first[which]


class Grid:
    """Points in cubes of a side; those of a column of cubes lie behind one another."""

    def __init__(self, points, side):
        self.lower, self.side = points.min(0), side
        self.counts = self.cubes(points.max(0)) + 1
        cells = self.cubes(points)
        numbers = (cells[:, 0] * self.counts[1] + cells[:, 1]) * self.counts[2] + cells[:, 2]
        self.order = np.argsort(numbers, kind="stable")
        self.starts = np.concatenate([[0], np.cumsum(np.bincount(numbers, minlength=int(self.counts.prod())))])

    def cubes(self, points):
        return np.floor((points - self.lower) / self.side).astype(np.int64)

    def near(self, lower, upper):
        """(box, point) of all points in cubes that the boxes reach; more than those within."""
        low, high = np.maximum(self.cubes(lower), 0), np.minimum(self.cubes(upper), self.counts - 1)
        box, x = expanded(low[:, 0], high[:, 0] + 1)
        column, y = expanded(low[box, 1], high[box, 1] + 1)
        box, x = box[column], x[column]
        row = (x * self.counts[1] + y) * self.counts[2]
        which, place = expanded(self.starts[row + low[box, 2]], self.starts[row + np.maximum(high[box, 2], low[box, 2] - 1) + 1])
        return box[which], self.order[place]


def expected_pairs(distance, mesh):
    """deal.cpp's, of two balls of one mesh: tetrahedra strewn evenly through balls, those that come as near as both are large."""
    r = mesh.radius
    depth = 2 * r - distance
    common = np.pi * depth ** 2 * (distance ** 2 + 4 * distance * r) / (12 * np.maximum(distance, 1e-300))
    density = mesh.tetrahedra / (4 * np.pi / 3 * r ** 3)
    return common * density ** 2 * (2 / np.cbrt(density)) ** 3


def pairs_of_bodies(pile):
    """Of each body with those that follow it on the curve: candidate pairs expected from balls, and pairs of bodies whose bounds overlap."""
    expected, pairs = np.zeros(len(pile.centres)), np.zeros(len(pile.centres), np.int64)
    for first in range(0, len(pile.centres), AT_ONCE):
        centres = pile.centres[first:first + AT_ONCE]
        a, b = pile.grid.near(centres - 2 * pile.mesh.radius, centres + 2 * pile.mesh.radius)
        a += first
        a, b = a[b > a], b[b > a]
        way = pile.centres[a] - pile.centres[b]
        distance = np.sqrt(np.einsum("ij,ij->i", way, way))
        close = distance < 2 * pile.mesh.radius
        a, b, way, distance = a[close], b[close], way[close], distance[close]
        expected += np.bincount(a, expected_pairs(distance, pile.mesh), len(expected))
        overlap = np.ones(len(a), bool)
        for i, direction in enumerate(DIRECTIONS):
            overlap &= np.abs(way @ direction) <= pile.widths[a, i] + pile.widths[b, i]
        pairs += np.bincount(a[overlap], minlength=len(pairs))
    return expected, pairs


def cuts(work, ranks):
    """The first body of each rank, and the end: a body goes to the rank in whose part the middle of its work lies."""
    middles = np.cumsum(work) - work / 2
    return np.searchsorted(middles, work.sum() / ranks * np.arange(ranks + 1) * (1 - 1e-15))[:-1].tolist() + [len(work)]


def bounds(pile, starts, margin):
    """Ends of the boxes over so many bodies of each rank, along DIRECTIONS, and the rank of each."""
    firsts = np.concatenate([np.arange(a, b, IN_A_BOX) for a, b in zip(starts, starts[1:])])
    owner = np.repeat(np.arange(len(starts) - 1), [-(-(b - a) // IN_A_BOX) for a, b in zip(starts, starts[1:])])
    lower, upper = np.empty((len(firsts), len(DIRECTIONS))), np.empty((len(firsts), len(DIRECTIONS)))
    for i, direction in enumerate(DIRECTIONS):
        middle = pile.centres @ direction
        width = pile.widths[:, i] + margin * pile.mesh.radius * np.linalg.norm(direction)
        lower[:, i], upper[:, i] = np.minimum.reduceat(middle - width, firsts), np.maximum.reduceat(middle + width, firsts)
    return lower, upper, owner


def halo(pile, starts, margin):
    """{rank, body} of each body of a later rank that meets one of a rank's boxes: that one gets it."""
    lower, upper, rank_of_box = bounds(pile, starts, margin)
    owners = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    reach, found = np.linalg.norm(pile.mesh.half) + margin * pile.mesh.radius, []  # corners of a turned box reach further than the ball
    for first in range(0, len(lower), AT_ONCE // 4):
        part = slice(first, first + AT_ONCE // 4)
        box, body = pile.grid.near(lower[part, :3] - reach, upper[part, :3] + reach)
        box += first
        later = owners[body] > rank_of_box[box]
        box, body = box[later], body[later]
        for i, direction in enumerate(DIRECTIONS):
            width = pile.widths[body, i] + margin * pile.mesh.radius * np.linalg.norm(direction)
            middle = pile.centres[body] @ direction
            meets = (middle - width <= upper[box, i]) & (lower[box, i] <= middle + width)
            box, body = box[meets], body[meets]
        found.append(np.unique(rank_of_box[box] * len(owners) + body))
    codes = np.unique(np.concatenate(found))
    return codes // len(owners), codes % len(owners), owners


def settled_margin():
    """The margin that holds for long enough in a pile, and for how many frames: it doubles until then, as halo.cpp has it."""
    way = DRIFT + 2 * math.sin(SPIN / 2)  # of a radius, a frame: places.cpp
    margin = LEAST_MARGIN
    while int(margin / way) < SOON and margin < MOST_MARGIN:
        margin *= 2
    return margin, int(margin / way)


def count(pile, ranks, margin, measured=None):
    """Of each rank: bodies it owns, gets and sends in a frame, from and to how many ranks, pairs of bodies and candidate pairs expected.
    `measured`: pairs_of_bodies(pile), where they are known."""
    expected, pairs = measured or pairs_of_bodies(pile)
    starts = cuts(pile.mesh.tetrahedra + WORK_OF_A_PAIR * expected, ranks)
    to, body, owners = halo(pile, starts, margin)
    links = np.unique(to * ranks + owners[body])
    each = lambda values: np.bincount(values, minlength=ranks)
    sums = lambda values: np.add.reduceat(np.append(values, 0), starts[:-1]) * (np.diff(starts) > 0)
    return {"own": np.diff(starts), "halo": each(to), "sent": each(owners[body]), "senders": each(links // ranks), "receivers": each(links % ranks),
            "body_pairs": sums(pairs), "expected_pairs": np.rint(sums(expected)).astype(np.int64)}
