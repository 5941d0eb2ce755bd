#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""schedules.py: writes the tables of whole frames between <!-- schedules: NAME --> and <!-- end --> of
results/h100/README.md. The first, from schedules.jsonl, has the paper's schedule beside the other methods,
everything resident. The second, from published.jsonl, has the paper's data path, with three sizes of
gProximity's queue array. Where a frame has parts only (setting most_body_pairs), or another frame of the scene
was measured, its time is composed: the frame with a small array, and an upload of the array for each batch of
body pairs."""

import math
import pathlib
import statistics
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER.parent))
from measured import Cell, agrees, inverse, paired, records, scene_name, text, with_interval, with_width
from tandem import markdown
from tandem.paper.quantities import batch_size

METHODS = {
    "chunked paper": "the paper's schedule",
    "chunked grouped": "ours, grouped",
    "gproximity fair": "gProximity",
    "tiled resident": "tiled",
    "leaf_query resident": "leaf queries",
}
SMALL = "4194304"


def resident():
    cells = {}
    for record in filter(agrees, records(FOLDER / "schedules.jsonl")):
        own = cells.setdefault((scene_name(record["scene"]["key"]), record["settings"]["k"]), {})
        own[f"{record['algorithm']} {record['preset']}"] = Cell(record)
    rows = []
    for (scene, k), own in sorted(cells.items(), key=lambda item: (item[0][0], int(item[0][1]))):
        ratio = with_interval(inverse(paired(own["chunked paper"], own["gproximity fair"])))
        rows.append([scene, k, *(with_width(own[method].total.values()) for method in METHODS), ratio])
    return markdown.table(["scene", "k", *METHODS.values(), "gProximity / the paper's"], rows).rstrip("\n")


class Published(Cell):
    """A cell with the paper's data path. `upload`: milliseconds of the writes of one batch; `batch`: body
    pairs of a batch, or 0."""

    def __init__(self, record):
        super().__init__(record)
        is_batched = record["algorithm"] == "gproximity"
        self.batch = batch_size(self) if is_batched else 0
        self.body_pairs = record["work"]["body_pairs"][0]
        self.batches = self.batches_of(self.body_pairs)
        self.is_part = record["settings"].get("most_body_pairs", "0") != "0"
        write = statistics.median(record["stages"]["write"]["host_ns"]["samples"])
        self.upload = write / self.frames / 1e6 / self.batches

    def batches_of(self, body_pairs):
        return max(1, math.ceil(body_pairs / self.batch)) if self.batch else 1


def name_of(record):
    if record["algorithm"] == "chunked":
        return "chunked"
    kind = "K40c" if record["preset"] == "published-k40c" else "this GPU"
    is_small = record["settings"].get("queue_bytes", "") == SMALL
    return f"{'small' if is_small else 'array'}, {kind}"


def with_array(small, array, chunked):
    """The text of a frame with this array, measured or composed, and how many times chunked's it takes."""
    batches = array.batches_of(small.body_pairs)
    is_whole = not array.is_part and (array.batches, array.body_pairs) == (batches, small.body_pairs)
    ms = array.median_ms if is_whole else small.median_ms + batches * array.upload
    return f"{text(ms)}{'' if is_whole else ' (composed)'}, {text(ms / chunked.median_ms)} times"


def published():
    cells = {}
    for record in filter(agrees, records(FOLDER / "published.jsonl")):
        cells.setdefault(scene_name(record["scene"]["key"]), {})[name_of(record)] = Published(record)
    arrays, rows = {}, []  # arrays: for scenes without such a cell
    for own in reversed(cells.values()):
        arrays |= own
    for scene, own in sorted(cells.items()):
        if "chunked" in own and "small, this GPU" in own:
            small, chunked = own["small, this GPU"], own["chunked"]
            times = (with_width(cell.total.values()) for cell in (chunked, small))
            whole = (
                with_array(small, own.get(name, arrays[name]), chunked)
                for name in ("array, K40c", "array, this GPU")
            )
            rows.append([scene, f"{small.body_pairs:,}", *times, *whole])
    heads = [
        "scene",
        "body pairs",
        "chunked",
        "gProximity, array of 4 MiB",
        "a K40c's sizes and array (3.02 GB)",
    ]
    return markdown.table([*heads, "this GPU's sizes and array"], rows).rstrip("\n")


def tables():
    return {"resident": resident(), "published": published()}


if __name__ == "__main__":
    markdown.rewrite(FOLDER / "README.md", "schedules", tables())
