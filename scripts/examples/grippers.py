#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""grippers.py [WORLDS [DEVICE]]: worlds of two compliant fingers that close on an object, collided by one call per
step. Poses and wrenches are PyTorch's tensors on the GPU and stay there; without PyTorch, or with device host, they are
in the host's memory."""

import sys
import time

import numpy

import tandem

try:
    import torch as library
except ImportError:
    library = numpy

STEPS, STEP = 10, 0.0012  # m, of each finger


def wrenches_of(collider, poses):
    """Bodies of pairs (n, 2), and rows of force, torque, area (n, 8), where the collider works."""
    queued = collider.enqueue(poses)
    flag, _, count, *_ = library.from_dlpack(queued.counts)[0].tolist()  # waits
    if flag:  # too much for the buffers: run() grows them, or raises what is wrong
        collider.run(poses)
        return wrenches_of(collider, poses)
    pairs, values = library.from_dlpack(queued.pairs), library.from_dlpack(queued.contact_values)
    rows = library.from_dlpack(queued.contact_ids)[:count, 0]
    return pairs[rows][:, [0, 2]], values[:count]


def main(worlds=64, device=None):
    if device is None:
        device = "cuda:0" if library is not numpy and library.cuda.is_available() else "host"
    scene = tandem.make_scene(f"grippers:worlds={worlds}")
    room = {"pair_capacity": 2500 * worlds}  # for the tightest step
    of_world = {"bodies": scene.bodies[:3], "worlds": worlds, "device": device}
    collider = tandem.Collider(scene.meshes, output="wrenches", **of_world, **room)
    poses = numpy.array(scene.poses(0)).reshape(worlds, 3, 7)  # finger, finger, object
    if library is not numpy:
        poses = library.from_numpy(poses).to(device.replace("host", "cpu"))
    for step in range(1, STEPS + 1):
        poses[:, 0, 0] += STEP
        poses[:, 1, 0] -= STEP
        begin = time.perf_counter()
        bodies, values = wrenches_of(collider, poses)
        ms = 1e3 * (time.perf_counter() - begin)
        forces = (values[:, :3] ** 2).sum(-1) ** 0.5
        told = f"mean force {float(forces.mean()):.3g}" if len(bodies) else "no force"
        print(f"step {step}: {len(bodies)} of {2 * worlds} fingers touch, {told}, {ms:.2f} ms")


if __name__ == "__main__":
    try:
        main(*(kind(text) for kind, text in zip((int, str), sys.argv[1:])))
    except ValueError as error:
        sys.exit(f"grippers.py: {error}")
