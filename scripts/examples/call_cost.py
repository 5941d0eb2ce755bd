#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What a call from Python costs beside the library's own frame, in microseconds: medians of all frames and rounds, and the median of the
difference call by call. The library's time is taken within the call, around Session::run of C++. Then what the pairs take on their way to
the arrays' library (NumPy: to the host, sorted), and what that library's own protocols take for the arrays of a frame when they are asked
from Python: Collider uses the one that takes least. Scripted scenes only."""
import argparse
import importlib
import importlib.util
import statistics
import sys
import time

import tandem

LIBRARIES = ("numpy", "cupy", "torch", "jax")


def spent(call):
    """(seconds, what it returned)."""
    begin = time.perf_counter()
    value = call()
    return time.perf_counter() - begin, value


def replay(collider, frames, hand_out):
    """(whole, within, out) of each frame in seconds."""
    times = []
    for frame in frames:
        whole, answer = spent(lambda: collider.run(*frame))
        times.append((whole, answer.seconds, spent(lambda: hand_out(answer))[0]))
    return times


def microseconds(values):
    return 1e6 * statistics.median(values)


def measure(collider, frames, hand_out, rounds):
    """Lines of figures; the first replay, in which kernels compile and rooms grow, is not in them."""
    replay(collider, frames, hand_out)
    times = [line for _ in range(rounds) for line in replay(collider, frames, hand_out)]
    whole, within, out = (microseconds(column) for column in zip(*times))
    beside = microseconds(all_of - part for all_of, part, _ in times)
    return f"call {whole:.1f} us, library's frame {within:.1f} us, the call beside it {beside:.1f} us; pairs handed out {out:.1f} us"


def asked(frames, rounds, protocol):
    """What a protocol takes for the arrays of a frame."""
    return microseconds([spent(lambda: [protocol(array) for array in arrays])[0] for _ in range(rounds) for arrays in frames])


def protocols(frames, rounds, stream):
    """A line of what the arrays' own protocols take, those that they have; `stream` is what DLPack is told."""
    frames = [[poses, *(vertices or {}).values()] for poses, vertices in frames]
    kinds = {"__dlpack_device__": lambda array: array.__dlpack_device__(), "__dlpack__": lambda array: array.__dlpack__(stream=stream),
             "__cuda_array_interface__": lambda array: array.__cuda_array_interface__}
    taken = [f"{name} {asked(frames, rounds, ask):.1f} us" for name, ask in kinds.items() if hasattr(frames[0][0], name)]
    table = "with" if hasattr(type(frames[0][0]), "__dlpack_c_exchange_api__") else "without"
    return f"  {len(frames[0])} arrays, asked from Python: {', '.join(taken)}; {table} DLPack's table of C functions"


def moved_by(library, on_gpu):
    """What makes an array of NumPy's one of the library's, and what takes an answer's pairs."""
    if library == "numpy":
        return lambda array: array, lambda answer: answer.pairs()
    module = importlib.import_module(library)
    moved, taken = {"cupy": lambda: (module.asarray, module.from_dlpack),
                    "torch": lambda: (lambda array: module.tensor(array, device="cuda" if on_gpu else "cpu"), module.from_dlpack),
                    "jax": lambda: (lambda array: module.block_until_ready(module.numpy.asarray(array)), module.dlpack.from_dlpack)}[library]()
    if library == "jax":
        module.config.update("jax_enable_x64", True)
    return moved, lambda answer: taken(answer.pairs(on_device=True))


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
    parser.add_argument("--arrays", default="numpy", choices=(*LIBRARIES, "all"), help="whose; on a CUDA device all but NumPy's lie there")
    arguments = parser.parse_args()
    on_gpu = arguments.device.startswith("cuda")
    libraries = [library for library in LIBRARIES if importlib.util.find_spec(library)] if arguments.arrays == "all" else [arguments.arrays]
    try:
        first, last = map(int, arguments.frames.split(":"))
        scene = tandem.make_scene(arguments.scene)
        collider = tandem.Collider(scene.meshes, arguments.algorithm, arguments.device, bodies=scene.bodies, deformable=scene.deformable)
        for library in libraries:
            if library == "cupy" and not on_gpu:
                continue  # whose arrays are never in the host's memory
            moved, hand_out = moved_by(library, on_gpu)
            frames = frames_of(scene, range(first, min(last + 1, scene.frame_count)), moved)
            figures = measure(collider, frames, hand_out, arguments.rounds)
            print(f"{arguments.scene} on {arguments.device}, arrays of {library}, {len(frames)} frames, {arguments.rounds} rounds: {figures}")
            stream = (collider._core.queue or 1) if on_gpu and library != "numpy" else None
            print(protocols(frames, arguments.rounds, stream), flush=True)
    except (ImportError, ValueError, tandem.DeviceError) as error:
        print(f"call_cost.py: {error}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
