# SPDX-License-Identifier: MIT
"""python3 -m tandem.schedules RESIDENT.jsonl PUBLISHED.jsonl [--write README.md ...]: makes two Markdown
tables of whole frames. The first has the paper's schedule beside ours, gProximity, tiled and leaf queries,
everything resident. The second has the paper's data path, with three sizes of gProximity's queue array.

--write writes each table between its marks, <!-- schedules: NAME --> and <!-- end -->, of the pages; without
it the tables are printed. Where a frame has parts only (setting most_body_pairs), or another frame of the
scene was measured, its time is composed: the frame with a small array, and an upload of the array for each
batch of body pairs. Exits with 2 and one error line for a file of something else."""

import argparse
import dataclasses
import math
import re
import statistics
import sys

from . import cell_rows, kinds, lines, markdown
from .answer import agrees, inverse, text, with_interval, with_width
from .commands import Parser, check_packages, run, warn
from .errors import BadUse
from .paper.quantities import batch_size

SCENES = {
    "plates": "plates",
    "funnel": "funnel",
    "glasses": "glasses",
    "tower": "tower",
    "0.05": "2,000 jacks, density 0.05",
    "0.2": "2,000 jacks, density 0.2",
}
WALKS = {
    "chunked paper": "the paper's schedule",
    "chunked grouped": "ours, grouped",
    "gproximity fair": "gProximity",
    "tiled resident": "tiled",
    "leaf_query resident": "leaf queries",
}
SMALL = "4194304"


def scene_of(record):
    name = record["scene"]["key"]
    density = re.search(r"density=([\d.]+)", name)
    return density[1] if density else next(word for word in SCENES if word in name)


@dataclasses.dataclass
class Cell:
    """Milliseconds per frame by round, and what the record says of the frame."""

    rounds: dict
    upload: float  # milliseconds of the writes of one batch
    batches: int  # batches of body pairs in a frame; 1 for walks without
    body_pairs: int
    is_part: bool
    key: str

    @classmethod
    def of(cls, record):
        frames, settings = cell_rows.frames_of(record), record["settings"]
        rounds = {
            n: cell_rows.milliseconds(statistics.median(own), frames)
            for n, own in lines.samples_by_round(record).items()
        }
        pairs, groups = record["work"]["body_pairs"][0], batch_of(record)
        batches = max(1, math.ceil(pairs / groups)) if groups else 1
        write = statistics.median(record["stages"]["write"]["host_ns"]["samples"])
        return cls(
            rounds,
            cell_rows.milliseconds(write, frames) / batches,
            batches,
            pairs,
            settings.get("most_body_pairs", "0") != "0",
            record["key"],
        )


def batch_of(record):
    """Body pairs in a batch of gProximity's published presets; None for other cells."""
    if record["algorithm"] != "gproximity" or record["settings"]["residency"] != "published":
        return None
    return batch_size(record)


def read(path, name_of):
    """Cells of correct records by scene and name_of(record); the last one of a name counts, parts of a frame
    apart. Raises RecordError."""
    cells = {}
    for location, kind, record in kinds.each(path, warn):
        if kind == "verdict":
            continue
        with kinds.fields_of("cell of these scenes", location):
            if agrees(record):
                cells.setdefault(scene_of(record), {})[name_of(record)] = Cell.of(record)
    if not cells:
        raise BadUse(f"{path}: no correct cells of these scenes; give the files of results/h100")
    return cells


def ratio(cell, base):
    """ "1.35 [1.3, 1.36]": how many times as long as `base` the cell takes, over common rounds."""
    from .resampling import paired_ratio

    common = [n for n in cell.rounds if n in base.rounds]
    return paired_ratio([base.rounds[n] for n in common], [cell.rounds[n] for n in common])


def resident_table(path):
    cells = read(path, lambda record: (record["settings"]["k"], f"{record['algorithm']} {record['preset']}"))
    rows = []
    for scene, name in SCENES.items():
        for k in ("8", "18"):
            own = {walk: cells.get(scene, {}).get((k, walk)) for walk in WALKS}
            if all(own.values()):
                rows.append(
                    [
                        name,
                        k,
                        *(with_width(cell.rounds.values()) for cell in own.values()),
                        with_interval(inverse(ratio(own["chunked paper"], own["gproximity fair"]))),
                    ]
                )
    return markdown.table(["scene", "k", *WALKS.values(), "gProximity / the paper's"], rows).rstrip("\n")


def published_name(record):
    settings = record["settings"]
    array = settings.get("queue_bytes", "")
    kind = "K40c" if record["preset"] == "published-k40c" else "this GPU"
    return (
        record["algorithm"]
        if record["algorithm"] == "chunked"
        else f"small, {kind}"
        if array == SMALL
        else f"array, {kind}"
    )


def composed(small, array, batch):
    """(milliseconds of a frame, whether they are composed) with an upload of the array for each batch."""
    if (
        not array.is_part
        and array.batches == math.ceil(small.body_pairs / batch)
        and array.body_pairs == small.body_pairs
    ):
        return statistics.median(array.rounds.values()), False
    return statistics.median(small.rounds.values()) + math.ceil(small.body_pairs / batch) * array.upload, True


def published_table(path):
    cells = read(path, published_name)
    batches = {}
    for _, kind, record in kinds.each(path, warn):
        if kind != "verdict" and batch_of(record):
            batches[published_name(record).split(", ")[1]] = batch_of(record)
    rows = []
    for scene, name in SCENES.items():
        own = cells.get(scene, {})
        if "chunked" not in own or "small, this GPU" not in own:
            continue
        small, chunked = own["small, this GPU"], statistics.median(own["chunked"].rounds.values())
        row = [
            name,
            f"{small.body_pairs:,}",
            with_width(own["chunked"].rounds.values()),
            with_width(small.rounds.values()),
        ]
        for kind in ("K40c", "this GPU"):
            arrays = (
                [own[f"array, {kind}"]]
                if f"array, {kind}" in own
                else [c for of in cells.values() for n, c in of.items() if n == f"array, {kind}"]
            )
            whole, is_composed = composed(small, arrays[0], batches[kind])
            row.append(f"{text(whole)}{' (composed)' if is_composed else ''}, {text(whole / chunked)} times")
        rows.append(row)
    return markdown.table(
        [
            "scene",
            "body pairs",
            "chunked",
            "gProximity, array of 4 MiB",
            "a K40c's sizes and array (3.02 GB)",
            "this GPU's sizes and array",
        ],
        rows,
    ).rstrip("\n")


def _make(arguments):
    parser = Parser(
        prog="python3 -m tandem.schedules",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("resident", metavar="RESIDENT.jsonl")
    parser.add_argument("published", metavar="PUBLISHED.jsonl")
    parser.add_argument("--write", nargs="+", default=[], metavar="README.md")
    options = parser.parse_args(arguments)
    check_packages("tandem.schedules", ("numpy",))
    texts = {"resident": resident_table(options.resident), "published": published_table(options.published)}
    for page in options.write:
        markdown.rewrite(page, "schedules", texts)
    return "" if options.write else "".join(
        f"{name}\n\n{table_text}\n\n" for name, table_text in texts.items()
    ), 0


def main(arguments, program=""):
    return run(lambda: _make(arguments))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
