#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""partitions.py: writes the tables between <!-- partitions: NAME --> and <!-- end --> of
results/scaling/README.md, from the microbenchmarks of the partitioner and the ghost lists
(tests/bench/partition.cpp) in results/cpu/bench.json."""

import json
import pathlib
import re
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER.parent.parent / "python"))
from tandem import markdown

BENCHMARKS = FOLDER.parent / "cpu/bench.json"


def _iterations(found, name):
    """(numbers in the name, benchmark) of all runs of that name, sorted by the numbers."""
    own = [one for one in found if one["run_type"] == "iteration" and one["name"].startswith(f"{name},")]
    numbers = lambda one: [int(number) for number in re.findall(r"/(\d+)", one["name"])]
    return sorted(((numbers(one), one) for one in own), key=lambda pair: pair[0])


def _ghosts(one):
    return [f"{one['ghosts_mean']:,.0f}", f"{one['ghosts_most']:,.0f}"]


def tables(found):
    """Texts by the names of their marks, from the runs of Google Benchmark."""
    rows = {"partitioner": [], "ghosts": []}
    for (parts, each, *_), one in _iterations(found, "partition"):
        us, most = one["real_time"] * 1e3 / parts / each, one["own_most"] / each
        own = [f"{parts:,}", f"{each:,}", f"{one['real_time'] / 1e3:.2f}", f"{us:.1f}", f"{most:.2f}"]
        rows["partitioner"].append([*own, *_ghosts(one)])
    for (ranks, each, *_), one in _iterations(found, "ghosts"):
        kilobytes = [f"{one['setup_bytes_most'] / 1e3:,.0f}", f"{one['frame_bytes_most'] / 1e3:,.1f}"]
        own = [f"{ranks:,}", f"{each:,}", *_ghosts(one), f"{one['neighbours_mean']:.1f}"]
        rows["ghosts"].append([*own, *kilobytes])
    ghosts = ["ghost bodies, mean", "most"]
    heads = {
        "partitioner": [
            "parts",
            "bodies per part",
            "seconds",
            "us per body",
            "largest part / mean part",
            *ghosts,
        ],
        "ghosts": ["ranks", "bodies per rank", *ghosts, "ranks that own them", "KB sent at the set-up, most"]
        + ["KB per frame, most"],
    }
    return {name: markdown.table(heads[name], rows[name], numeric=True).rstrip("\n") for name in heads}


def committed():
    return tables(json.loads(BENCHMARKS.read_text())["benchmarks"])


if __name__ == "__main__":
    markdown.rewrite(FOLDER / "README.md", "partitions", committed())
