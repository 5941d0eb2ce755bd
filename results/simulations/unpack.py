#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""unpack.py FOLDER DEVICE: gives a folder of 'tandem paper --size full' the recordings and records of this
folder, so that it does not simulate again. In a recording each frame has the number of its step. Frames that
were left out repeat the one before; they have the step of that frame."""

import json
import lzma
import pathlib
import shutil
import struct
import sys
import zlib

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "python"))
from tandem.paper.measuring import steps_of
from tandem.sequences.journal import Journal

STEPS = 500


def whole(recording):
    """A recording of some steps with a frame for each of all."""
    size = struct.unpack_from("<I", recording, 12)[0]
    bodies, text = struct.unpack_from("<II", recording, 32)
    kinds = struct.unpack_from(f"<{2 * bodies}I", recording, 40 + text)
    frame = 20 + sum({0: 28, 1: 0}.get(kind, 12 * n) for kind, n in zip(kinds[::2], kinds[1::2]))
    frames = [recording[start : start + frame - 4] for start in range(size, len(recording), frame)]
    steps = [struct.unpack_from("<Q", one)[0] for one in frames]
    out, last = [recording[:size]], 0
    for number in range(STEPS):
        last += last + 1 < len(steps) and steps[last + 1] <= number
        checksum = zlib.crc32(frames[last], zlib.crc32(struct.pack("<Q", number)))
        out += [frames[last], struct.pack("<I", checksum)]
    return b"".join(out)


def run_of(records):
    """The line of the run among the records of a simulation."""
    return json.loads(lzma.decompress(records.read_bytes()).splitlines()[-1])


def main(folder, device):
    (folder / "records").mkdir(parents=True, exist_ok=True)
    for packed in sorted(HERE.glob("*.frames.xz")):
        (folder / packed.stem).write_bytes(whole(lzma.decompress(packed.read_bytes())))
    journal = Journal(folder / "steps.jsonl", "is not a line of 'tandem paper'; name another folder")
    done = {line["key"] for line in journal.lines()}
    for step in steps_of("full", device):
        records = [HERE / f"{pathlib.PurePath(name).name}.xz" for name in step.written if "/solver-" in name]
        if not records or not records[0].exists() or step.key in done:
            continue
        shutil.copy(records[0], folder / "records")
        run = run_of(records[0])
        line = {"step": step.name, "size": "full", "device": device, "exit": 0}
        line |= {"seconds": run["host_ns"]["total"] / 1e9 if step.name.startswith("solver-") else 0}
        line |= {"says": step.says, "command": " ".join(step.command), "key": step.key}
        journal.append(line | {name: run["environment"][name] for name in ("commit", "dirty", "date")})


main(pathlib.Path(sys.argv[1]), sys.argv[2])
