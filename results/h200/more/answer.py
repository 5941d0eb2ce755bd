#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""answer.py: writes the tables of README.md of this folder from its records and from claims.csv."""

import csv
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER.parent.parent))
from measured import Cell, ends, paired, records, text
from tandem import markdown, names

TILED, GROUPED, PAPER, FAIR = (
    names.method(*cell)
    for cell in (("tiled", "resident"), ("chunked", "grouped"), ("chunked", "paper"), ("gproximity", "fair"))
)
METHODS = (TILED, GROUPED, PAPER, FAIR)
CLAIMS = {
    "schedule-resident": "A static schedule beats balancing, everything on the device: times as fast",
    "choice-of-k": "k = 8 suits the paper's schedule: time with k = 18 over that with k = 8",
    "chunk-bytes": "8 KiB suit the paper's schedule: its time over that with the best size",
    "z-order-enough": "Z-order suffices: time of the paper's schedule over that in Hilbert's order",
    "narrow-release-contacts": "Chunked's narrow phase is faster, with contacts as in the release's kernel",
    "thousand-launches": "Launches fall by up to three orders of magnitude: times fewer",
    "launches": "The same for each of the paper's GPUs: times fewer",
}
BYTES = ("2000", "8000", "32000", "128000", "512000")


def name_of(record):
    return names.method(record["algorithm"], record["preset"])


def claims():
    """The rows of claims.csv: the claim in short, its scene, our value, the paper's and the verdict."""
    with open(FOLDER / "claims.csv", newline="") as file:
        rows = list(csv.DictReader(file))

    def value(row):
        low, high = text(float(row["low"])), text(float(row["high"]))
        middle = text(float(row["value"]))
        return middle if low == high else f"{middle} [{low}, {high}]"

    def paper(row):
        ends = [row[name] for name in ("paper_low", "paper_high") if row[name]]
        return " to ".join(text(float(end)) for end in dict.fromkeys(ends))

    shown, last = [], None
    for row in rows:
        says = "" if row["claim"] == last else CLAIMS[row["claim"]]
        last = row["claim"]
        shown.append([says, row["scene"], value(row), paper(row), row["verdict"]])
    return markdown.table(["claim", "scene", "here", "in the paper", "verdict"], shown).rstrip("\n")


def chunk_bytes():
    """Milliseconds per frame by bytes of a chunk; the least of a row is bold."""
    rows = {}
    for record in records(FOLDER / "chunk-study.jsonl.xz"):
        own = record["settings"]
        if own["builder"] == "median":
            continue
        at = rows.setdefault((name_of(record), own["k"], own["builder"]), {})
        at[own["chunk_bytes"]] = Cell(record).median_ms
    shown = []
    for row, times in sorted(rows.items(), key=lambda item: (item[0][0], int(item[0][1]), item[0][2])):
        least = min(times.values())
        cells = (f"**{text(times[size])}**" if times[size] == least else text(times[size]) for size in BYTES)
        shown.append([*row, *cells])
    heads = ["method", "k", "order", *(f"{int(size):,} bytes" for size in BYTES)]
    return markdown.table(heads, shown).rstrip("\n")


def colosseum():
    """Milliseconds per frame, and the ratio of two methods: least and greatest of the frames."""
    rows = []
    for k in ("8", "18"):
        cells = {}
        for record in records(FOLDER / "resident-colosseum.jsonl.xz"):
            if record["settings"]["k"] == k:
                cells.setdefault(name_of(record), {})[record["frames"]["first"]] = Cell(record)
        ratios = [paired(cells[FAIR][frame], cells[PAPER][frame]) for frame in cells[FAIR]]
        times = (ends([cell.median_ms for cell in cells[name].values()]) for name in METHODS)
        rows.append([k, *times, ends([ratio.value for ratio in ratios])])
    return markdown.table(["k", *METHODS, f"{FAIR} ÷ {PAPER}"], rows).rstrip("\n")


if __name__ == "__main__":
    tables = {"claims": claims(), "chunk bytes": chunk_bytes(), "colosseum": colosseum()}
    markdown.rewrite(FOLDER / "README.md", "answer", tables)
