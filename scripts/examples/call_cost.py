#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures the overhead of calls from Python in microseconds: medians over all frames and rounds of the call,
of the library's own frame (Session::run of C++), and of their difference. Also measures the conversion of
pairs to arrays of a library (NumPy: in host memory and sorted), and the protocols of that library for the
arrays of a frame, called from Python. Collider uses the fastest one. Only for scripted scenes."""

import argparse
import importlib
import importlib.util
import statistics
import sys
import time

import tandem

LIBRARIES = ("numpy", "cupy", "torch", "jax")


def spent(call):
    """(seconds, result) of a call."""
    begin = time.perf_counter()
    value = call()
    return time.perf_counter() - begin, value


def replay(collider, frames, convert_pairs):
    """Seconds of each frame: (whole call, library's frame, conversion of pairs)."""
    times = []
    for frame in frames:
        whole, answer = spent(lambda: collider.run(*frame))
        times.append((whole, answer.seconds, spent(lambda: convert_pairs(answer))[0]))
    return times


def microseconds(values):
    return 1e6 * statistics.median(values)


def measure(collider, frames, convert_pairs, rounds):
    """A line of medians, without the first replay, in which kernels compile and buffers grow."""
    replay(collider, frames, convert_pairs)
    times = [line for _ in range(rounds) for line in replay(collider, frames, convert_pairs)]
    whole, within, conversion = (microseconds(column) for column in zip(*times))
    overhead = microseconds(call - frame for call, frame, _ in times)
    return f"call {whole:.1f} us, library's frame {within:.1f} us, overhead {overhead:.1f} us; conversion of pairs {conversion:.1f} us"


def protocol_time(frames, rounds, protocol):
    """Microseconds of a protocol for the arrays of a frame."""
    return microseconds(
        [spent(lambda: [protocol(array) for array in arrays])[0] for _ in range(rounds) for arrays in frames]
    )


def protocols(frames, rounds, stream):
    """A line of times of the protocols that the arrays support. `stream`: the argument of __dlpack__."""
    frames = [[poses, *(vertices or {}).values()] for poses, vertices in frames]
    kinds = {
        "__dlpack_device__": lambda array: array.__dlpack_device__(),
        "__dlpack__": lambda array: array.__dlpack__(stream=stream),
        "__cuda_array_interface__": lambda array: array.__cuda_array_interface__,
    }
    times = [
        f"{name} {protocol_time(frames, rounds, protocol):.1f} us"
        for name, protocol in kinds.items()
        if hasattr(frames[0][0], name)
    ]
    table = "with" if hasattr(type(frames[0][0]), "__dlpack_c_exchange_api__") else "without"
    return f"  {len(frames[0])} arrays, called from Python: {', '.join(times)}; {table} DLPack's table of C functions"


def converters(library, on_gpu):
    """Two functions: one converts a NumPy array to an array of the library, one converts the pairs of an
    answer."""
    if library == "numpy":
        return lambda array: array, lambda answer: answer.pairs()
    module = importlib.import_module(library)
    to_library, from_dlpack = {
        "cupy": lambda: (module.asarray, module.from_dlpack),
        "torch": lambda: (
            lambda array: module.tensor(array, device="cuda" if on_gpu else "cpu"),
            module.from_dlpack,
        ),
        "jax": lambda: (
            lambda array: module.block_until_ready(module.numpy.asarray(array)),
            module.dlpack.from_dlpack,
        ),
    }[library]()
    if library == "jax":
        module.config.update("jax_enable_x64", True)
    return to_library, lambda answer: from_dlpack(answer.pairs(on_device=True))


def frames_of(scene, numbers, to_library):
    frames = []
    for i in numbers:
        vertices = {body: to_library(rows) for body, rows in scene.vertices(i).items()}
        frames.append((to_library(scene.poses(i)), vertices or None))
    return frames


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", nargs="?", default="plates")
    parser.add_argument("--device", default="host")
    parser.add_argument("--algorithm", default="tiled")
    parser.add_argument("--frames", default="60:79", help="FIRST:LAST")
    parser.add_argument("--rounds", type=int, default=10)
    parser.add_argument(
        "--arrays",
        default="numpy",
        choices=(*LIBRARIES, "all"),
        help="library of the arrays; on a CUDA device all except NumPy's are in its memory",
    )
    arguments = parser.parse_args()
    on_gpu = arguments.device.startswith("cuda")
    libraries = (
        [library for library in LIBRARIES if importlib.util.find_spec(library)]
        if arguments.arrays == "all"
        else [arguments.arrays]
    )
    try:
        first, last = map(int, arguments.frames.split(":"))
        scene = tandem.make_scene(arguments.scene)
        collider = tandem.Collider(
            scene.meshes,
            arguments.algorithm,
            arguments.device,
            bodies=scene.bodies,
            deformable=scene.deformable,
        )
        for library in libraries:
            if library == "cupy" and not on_gpu:
                continue  # arrays of CuPy are never in host memory
            to_library, convert_pairs = converters(library, on_gpu)
            frames = frames_of(scene, range(first, min(last + 1, scene.frame_count)), to_library)
            figures = measure(collider, frames, convert_pairs, arguments.rounds)
            print(
                f"{arguments.scene} on {arguments.device}, arrays of {library}, {len(frames)} frames, {arguments.rounds} rounds: {figures}"
            )
            stream = (collider._core.queue or 1) if on_gpu and library != "numpy" else None
            print(protocols(frames, arguments.rounds, stream), flush=True)
    except (ImportError, ValueError, tandem.DeviceError) as error:
        print(f"call_cost.py: {error}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
