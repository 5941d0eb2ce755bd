#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""worlds.py [WORLDS [BODIES [DEVICE]]]: many independent worlds of boxes at random poses, collided by one call. Prints
the contacts of the first worlds, and the time of a call beside the time per world."""

import sys
import time

import numpy

import tandem


def box(cells=2):
    """Vertices and tetrahedra of a unit cube of cells, six tetrahedra each."""
    side = numpy.arange(cells + 1) / cells
    vertices = numpy.stack(numpy.meshgrid(side, side, side, indexing="ij"), axis=-1).reshape(-1, 3)
    steps = numpy.array([(cells + 1) ** 2, cells + 1, 1])
    first = (numpy.indices([cells] * 3).reshape(3, -1).T @ steps)[:, None]
    paths = [
        (0, 1, 2),
        (1, 2, 0),
        (2, 0, 1),
        (0, 2, 1),
        (2, 1, 0),
        (1, 0, 2),
    ]  # from a corner to the opposite one
    corners = [[0, *numpy.cumsum(steps[list(path)])] for path in paths]
    for mirrored in corners[3:]:
        mirrored[1], mirrored[2] = mirrored[2], mirrored[1]
    return vertices, numpy.concatenate([first + corner for corner in corners])


def poses(worlds, bodies, random):
    rows = random.normal(size=(worlds, bodies, 7))
    rows[..., :3] = random.uniform(size=(worlds, bodies, 3)) * (2.5 * bodies) ** (1 / 3)
    rows[..., 3:] /= numpy.linalg.norm(rows[..., 3:], axis=-1, keepdims=True)
    return rows


def main(worlds=1024, bodies=16, device="host"):
    mesh = tandem.make_mesh(*box())
    collider = tandem.Collider([mesh], bodies=[0] * bodies, worlds=worlds, device=device)
    rows = poses(worlds, bodies, numpy.random.default_rng(1))
    answer = collider.run(rows)
    world = answer.contacts().pairs[:, 0]
    print(
        f"{answer.count} candidate pairs and {answer.contact_count} contacts in {worlds} worlds of {bodies} boxes"
    )
    print("contacts of the first worlds:", *numpy.bincount(world, minlength=worlds)[:8])
    times = []
    for _ in range(20):
        begin = time.perf_counter()
        collider.run(rows)
        times.append(time.perf_counter() - begin)
    median = numpy.median(times)
    print(f"{1e3 * median:.2f} ms per call, {1e6 * median / worlds:.2f} us per world, on {device}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]), *sys.argv[3:4])
