# SPDX-License-Identifier: MIT
"""Rows of a comparison: a peer, which is a library of others behind a program of the user's, and walks of tandem."""

import collections
import json
import math
import shlex
import subprocess

from boxes.errors import BadData

from tandem import names

# A method on a frame. pairs: its count; the times are milliseconds, one a round: of a new tree, of new bounds in the
# same tree, of the query, and of the frame. A method may lack the first or the second.
Row = collections.namedtuple("Row", "name version device pairs build_ms refit_ms query_ms frame_ms")
REFIT = ("transform", "refit")  # stages of tandem


def are_times(values):
    """Whether values are finite and positive, at least one."""
    is_number = lambda value: isinstance(value, (int, float)) and not isinstance(value, bool)
    return (
        isinstance(values, list)
        and values != []
        and all(is_number(value) and 0 < value < math.inf for value in values)
    )


def row_of(line):
    """The row of a peer's line of JSON. Raises ValueError."""
    fields = json.loads(line)
    texts = [fields[name] for name in ("name", "version", "device")]
    pairs, build, query = (fields[name] for name in ("pairs", "build_ms", "query_ms"))
    refit = fields.get("refit_ms")
    if not all(isinstance(text, str) for text in texts) or type(pairs) is not int or pairs < 0:
        raise ValueError
    times = [build, query] + ([refit] if "refit_ms" in fields else [])
    if not all(map(are_times, times)) or len(set(map(len, times))) > 1:
        raise ValueError
    frame = [update + part for update, part in zip(refit or build, query)]
    return Row(*texts, pairs, build, refit, query, frame)


def of_peer(command, files, device, rounds):
    """The row of a peer. Raises BadData."""
    words = [*shlex.split(command), *map(str, files), device, str(rounds)]
    try:
        done = subprocess.run(words, capture_output=True, text=True, errors="replace", check=False)
    except OSError as error:
        raise BadData(f"{words[0]}: {error.strerror}") from None
    if done.returncode:
        lines = done.stderr.strip().splitlines() or [f"exit code {done.returncode}"]
        raise BadData(f"{command}: {lines[-1]}", 3)
    try:
        return row_of(done.stdout.strip().splitlines()[-1])
    except (IndexError, KeyError, TypeError, ValueError):
        raise BadData(f"{command}: its last line is not what a peer prints (docs/user/peers.md)") from None


def of_record(record):
    """The row of a record of tandem with one frame. Refit and query are device times of replays with timestamps, so
    that they do not add up to the frame."""
    parts = {True: [], False: []}
    for name, stage in record["stages"].items():
        parts[name in REFIT].append(stage["device_ns"]["samples"])
    refit, query = ([1e-6 * sum(times) for times in zip(*parts[is_refit])] for is_refit in (True, False))
    frame = [1e-6 * time for time in record["total_ns"]["samples"]]
    return Row(
        names.method(record["algorithm"], record["preset"]),
        f"tandem {record['environment']['commit']}",
        record["devices"][0]["name"],
        record["work"]["candidate_pairs"][0],
        None,
        refit,
        query,
        frame,
    )
