#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""peer_warp.py [--tree bodies|scene] BOXES BODIES DEVICE ROUNDS: wp.Bvh of NVIDIA Warp for scripts/peers. Needs
warp-lang.

With tree=bodies (the default) a box queries the trees of the bodies whose boxes meet its own body's. They are the
groups of one wp.Bvh; which bodies meet is found beforehand and not timed. With tree=scene a box queries one tree over
all boxes, and leaves out its own body's."""

import argparse
import json
import time

import numpy
import warp as wp

WHOLE = -1  # the root of all trees


@wp.kernel
def find_roots(tree: wp.uint64, roots: wp.array(dtype=wp.int32)):
    roots[wp.tid()] = wp.bvh_get_group_root(tree, wp.tid())


@wp.struct
class Boxes:
    lowers: wp.array(dtype=wp.vec3)
    uppers: wp.array(dtype=wp.vec3)
    bodies: wp.array(dtype=wp.int32)
    first: wp.array(dtype=wp.int32)  # partner of each body, and the end
    partners: wp.array(dtype=wp.int32)  # bodies, or WHOLE
    roots: wp.array(dtype=wp.int32)  # of the trees of bodies


@wp.kernel
def find_pairs(
    tree: wp.uint64, boxes: Boxes, pairs: wp.array(dtype=wp.vec2i), count: wp.array(dtype=wp.int64)
):
    box = wp.tid()
    body = boxes.bodies[box]
    for i in range(boxes.first[body], boxes.first[body + 1]):
        partner = boxes.partners[i]
        root = int(WHOLE)
        if partner != WHOLE:
            root = boxes.roots[partner]
        query = wp.bvh_query_aabb(tree, boxes.lowers[box], boxes.uppers[box], root)
        other = int(0)
        while wp.bvh_query_next(query, other):
            if partner != WHOLE or boxes.bodies[other] > body:
                slot = wp.atomic_add(count, 0, wp.int64(1))
                if slot < wp.int64(pairs.shape[0]):
                    pairs[int(slot)] = wp.vec2i(box, other)


def meeting(lo, hi, bodies):
    """(first partner of each body, partners): of two bodies whose boxes meet, the one with fewer tetrahedra has the
    other as a partner."""
    starts = numpy.unique(bodies, return_index=True)[1]
    lows, highs = numpy.minimum.reduceat(lo, starts), numpy.maximum.reduceat(hi, starts)
    sizes = numpy.bincount(bodies)
    partners = []
    for body, size in enumerate(sizes):
        meets = (lows[body] <= highs).all(1) & (lows <= highs[body]).all(1)
        is_less = (size < sizes) | ((size == sizes) & (body < numpy.arange(len(sizes))))
        partners.append(numpy.flatnonzero(meets & is_less))
    return numpy.cumsum([0, *map(len, partners)]), numpy.concatenate(partners)


class Peer:
    def __init__(self, boxes, bodies, options):
        lo, hi = boxes[:, 0].copy(), boxes[:, 1].copy()
        by_body = options.tree == "bodies"
        last = int(bodies.max())
        first, partners = meeting(lo, hi, bodies) if by_body else (range(last + 2), [WHOLE] * (last + 1))
        self._boxes = Boxes()
        self._boxes.lowers, self._boxes.uppers = (wp.array(corner, dtype=wp.vec3) for corner in (lo, hi))
        self._boxes.bodies, self._boxes.first, self._boxes.partners = (
            wp.array(numbers, dtype=wp.int32) for numbers in (bodies, first, partners)
        )
        self._boxes.roots = wp.zeros(last + 1 if by_body else 0, dtype=wp.int32)
        self._tree = wp.Bvh(
            self._boxes.lowers, self._boxes.uppers, groups=self._boxes.bodies if by_body else None
        )
        self._pairs = wp.empty(1, dtype=wp.vec2i)
        self._count = wp.zeros(1, dtype=wp.int64)

    def build(self):
        self._tree.rebuild()
        wp.launch(find_roots, len(self._boxes.roots), [self._tree.id, self._boxes.roots])

    def refit(self):
        self._tree.refit()

    def query(self):
        """The number of pairs."""
        self._count.zero_()
        wp.launch(find_pairs, len(self._boxes.lowers), [self._tree.id, self._boxes, self._pairs, self._count])
        return int(self._count.numpy()[0])

    def warm_up(self):
        """Makes room for all pairs."""
        self.build()
        self.refit()
        self._pairs = wp.empty(max(self.query(), 1), dtype=wp.vec2i)
        self.query()


def milliseconds(call):
    """(its value, how long it takes until the device is done)."""
    wp.synchronize()
    begin = time.perf_counter()
    value = call()
    wp.synchronize()
    return value, 1e3 * (time.perf_counter() - begin)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tree", choices=("bodies", "scene"), default="bodies")
    for name in ("boxes", "bodies", "device"):
        parser.add_argument(name)
    parser.add_argument("rounds", type=int)
    options = parser.parse_args()
    wp.config.quiet = True
    wp.set_device("cpu" if options.device == "host" else options.device)
    boxes = numpy.fromfile(options.boxes, "<f4").reshape(-1, 2, 3)
    peer = Peer(boxes, numpy.fromfile(options.bodies, "<u4").astype("i4"), options)
    peer.warm_up()
    times = {"build_ms": [], "refit_ms": [], "query_ms": []}
    for _ in range(options.rounds):
        for call, values in zip((peer.build, peer.refit, peer.query), times.values()):
            pairs, spent = milliseconds(call)
            values.append(spent)
    who = {
        "name": f"Warp, tree={options.tree}",
        "version": f"Warp {wp.__version__}",
        "device": wp.get_device().name,
    }
    print(json.dumps(who | {"pairs": pairs} | times))


if __name__ == "__main__":
    main()
