#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What a call from Python costs beside the library's own frame, in microseconds: both medians from one run, and the median of their
difference, call by call. The library's time is taken within the call, around Session::run of C++. Scripted scenes only."""
import argparse
import importlib
import statistics
import sys
import time

import tandem


def replay(collider, frames, call):
    """(whole, within) of each frame in seconds."""
    times = []
    for frame in frames:
        begin = time.perf_counter()
        answer = call(collider, frame)
        times.append((time.perf_counter() - begin, answer.seconds))
    return times


def measure(collider, frames, call, rounds):
    """A line of figures; the first replay, in which kernels compile and rooms grow, is not in it."""
    replay(collider, frames, call)
    times = [pair for _ in range(rounds) for pair in replay(collider, frames, call)]
    whole, within = (1e6 * statistics.median(column) for column in zip(*times))
    beside = 1e6 * statistics.median(all_of - part for all_of, part in times)
    return f"call {whole:.1f} us, library's frame {within:.1f} us, the call beside it {beside:.1f} us"


def on_gpu(library):
    """What moves an array of NumPy's to the library's current GPU."""
    module = importlib.import_module(library)
    if library == "cupy":
        return module.asarray
    if library == "torch":
        return lambda array: module.from_numpy(array).cuda()
    module.config.update("jax_enable_x64", True)
    return lambda array: module.block_until_ready(module.numpy.asarray(array))


def frames_of(scene, numbers, moved):
    frames = []
    for i in numbers:
        vertices = {body: moved(rows) for body, rows in scene.vertices(i).items()}
        frames.append((moved(scene.poses(i)), vertices or None))
    return frames


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", nargs="?", default="plates")
    parser.add_argument("--device", default="host")
    parser.add_argument("--algorithm", default="tiled")
    parser.add_argument("--frames", default="60:79", help="FIRST:LAST")
    parser.add_argument("--rounds", type=int, default=10)
    parser.add_argument("--arrays", default="numpy", choices=("numpy", "cupy", "torch", "jax"), help="whose; all but NumPy's lie on the GPU")
    arguments = parser.parse_args()
    try:
        first, last = map(int, arguments.frames.split(":"))
        scene = tandem.make_scene(arguments.scene)
        collider = tandem.Collider(scene.meshes, arguments.algorithm, arguments.device, bodies=scene.bodies, deformable=scene.deformable)
        moved = on_gpu(arguments.arrays) if arguments.arrays != "numpy" else lambda array: array
        frames = frames_of(scene, range(first, min(last + 1, scene.frame_count)), moved)
        figures = measure(collider, frames, lambda c, frame: c.run(*frame), arguments.rounds)
    except (ImportError, ValueError, tandem.DeviceError) as error:
        print(f"call_cost.py: {error}", file=sys.stderr)
        sys.exit(2)
    print(f"{arguments.scene} on {arguments.device}, arrays of {arguments.arrays}, {len(frames)} frames, {arguments.rounds} rounds: {figures}")


if __name__ == "__main__":
    main()
