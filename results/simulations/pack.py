#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""pack.py RECORDING.frames OUT.frames.xz STEP|FIRST:LAST[:STRIDE]...: the frames of these steps of a recording of
'tandem simulate', as a recording (scenes/recording/README.md) that xz has compressed."""

import lzma
import pathlib
import struct
import sys
import zlib


def steps_of(words):
    """Steps that are named, ascending; ranges include both ends."""
    steps = set()
    for word in words:
        first, last, stride = (*map(int, word.split(":")), None, None)[:3]
        steps |= set(range(first, (first if last is None else last) + 1, stride or 1))
    return sorted(steps)


def packed(recording, steps):
    """Header and frames of `steps`, numbered from 0: a frame's checksum covers its number."""
    size = struct.unpack_from("<I", recording, 12)[0]
    bodies, text = struct.unpack_from("<II", recording, 32)
    kinds = struct.unpack_from(f"<{2 * bodies}I", recording, 40 + text)
    rows = zip(kinds[::2], kinds[1::2])
    frame = 16 + sum({0: 28, 1: 0}.get(kind, 12 * vertices) for kind, vertices in rows) + 4
    frames = {}
    for start in range(size, len(recording) - frame + 1, frame):
        frames[struct.unpack_from("<Q", recording, start)[0]] = recording[start : start + frame - 4]
    out = [recording[:size]]
    for number, step in enumerate(steps):
        checksum = zlib.crc32(frames[step], zlib.crc32(struct.pack("<Q", number)))
        out += [frames[step], struct.pack("<I", checksum)]
    return b"".join(out)


source, target, *words = sys.argv[1:]
whole = packed(pathlib.Path(source).read_bytes(), steps_of(words))
pathlib.Path(target).write_bytes(lzma.compress(whole, preset=9))
