# SPDX-License-Identifier: MIT
"""python3 -m tandem.answer FILE.jsonl [--write README.md ... | --picture FILE.svg]: makes the Markdown tables
of the README from the records of results/h200/plan.json. They have the times of a frame, of its refit and
walk, and the ratios of the other walks to tiled.

--write writes each table between its marks, <!-- answer: NAME --> and <!-- end -->, of the pages; without it
the tables are printed. --picture draws the first table as a chart instead (python3-matplotlib). Medians have
the half width of their 95 % interval. Ratios are medians over rounds that were measured side by side. Exits
with 2 and one error line for a file that is not of that plan."""

import argparse
import itertools
import re
import statistics
import sys

from . import cell_rows, kinds, lines, markdown
from .commands import Parser, check_packages, run, warn
from .errors import BadUse, OutputError
from .files import check_output

SCENES = {
    "plates": "plates, frames 20:121",
    "funnel": "funnel, frames 140:149",
    "glasses": "glasses, frames 140:149",
    "0.05": "2,000 jacks, density 0.05",
    "0.2": "2,000 jacks, density 0.2",
}
METHODS = {
    "tiled": "tiled",
    "other": "tiled, other slabs",
    "chunked": "chunked, grouped",
    "sah": "chunked, grouped, tiled's trees",
    "paper": "chunked, the paper's schedule",
    "fair": "gproximity fair",
    "chunked published": "chunked published",
    "gproximity published": "gproximity published",
}
USUAL = ("tiled", "other", "chunked", "sah", "fair")
WALK = ("refit", "seed", "traverse", "balance")


def scene_of(record):
    name = record["scene"]["key"]
    density = re.search(r"density=([\d.]+)", name)
    found = [density[1]] if density else [word for word in SCENES if word in name]
    return found[0]


def method_of(record):
    settings, preset, algorithm = record["settings"], record["preset"], record["algorithm"]
    if preset == "published":
        return f"{algorithm} published"
    if algorithm == "gproximity":
        return "fair"
    if algorithm == "tiled":
        return (
            "tiled" if "slabs" in record["asked"] else "other"
        )  # "asked" has slabs if the cell of slabs=usual took another value
    return "sah" if settings["builder"] == "sah" else "paper" if settings["schedule"] == "item" else "chunked"


def origin_of(record):
    """Where a record is from: "NVIDIA H200, commit 8c7a169 of 2026-11-23"."""
    devices = " and ".join(sorted({device["name"] for device in record["devices"]}))
    made = record["environment"]
    return f"{devices}, commit {(made['commit'] or 'unknown')[:7]} of {(made['date'] or 'unknown')[:10]}"


def origins(cells):
    return " and ".join(sorted({cell.origin for cell in cells.values()}))


class Cell:
    """Milliseconds per frame by round: of samples, and the device time of refit and walk from replays that
    time every command."""

    def __init__(self, record):
        frames = cell_rows.frames_of(record)
        self.total = {
            n: cell_rows.milliseconds(statistics.median(own), frames)
            for n, own in lines.samples_by_round(record).items()
        }
        walks = [record["stages"][s]["device_ns"]["samples"] for s in WALK if s in record["stages"]]
        self.walk = {n: cell_rows.milliseconds(sum(own), frames) for n, own in enumerate(zip(*walks))}
        self.origin = origin_of(record)
        self.key, self.session = record["key"], record.get("session") or ""


def agrees(record):
    """Whether the answer of the cell equals that of the reference."""
    agreement = record["agreement"]
    return (
        record["status"] == "ok"
        and agreement["missing"] == agreement["extra"] == agreement["contact_frames_wrong"] == 0
    )


def read(path):
    """Correct cells by scene, k and method, and for each record whether its answer equals that of the
    reference. Raises RecordError."""
    cells, answers = {}, []
    for location, kind, record in kinds.each(path, warn):
        if kind == "verdict":
            continue
        with kinds.fields_of("cell of the plan", location):
            answers.append(agrees(record))
            if record["status"] == "ok":
                cells[(scene_of(record), record["settings"]["k"], method_of(record))] = Cell(record)
    return cells, answers


def text(value):
    return f"{value:.3g}" if value < 100 else f"{value:,.0f}"


def with_interval(ratio):
    """ "1.38 [1.37, 1.40]"."""
    return f"{text(ratio.value)} [{text(ratio.low)}, {text(ratio.high)}]"


def span(ratios):
    """Range of ratios with the intervals of its ends: "1.38 [1.37, 1.4] to 2.05 [2.03, 2.07]"."""
    low, high = (with_interval(end(ratios, key=lambda ratio: ratio.value)) for end in (min, max))
    return low if low == high else f"{low} to {high}"


def inverse(ratio):
    return type(ratio)(1 / ratio.value, 1 / ratio.high, 1 / ratio.low, ratio.log_error)


def with_width(values):
    """The median with half the width of its interval: "0.348 ± 0.002"."""
    from .resampling import median_interval

    values = list(values)
    low, high = median_interval(values)
    half, middle = (high - low) / 2, statistics.median(values)
    digits = max(0, min(5, 2 - len(str(int(middle))) + 1 if half == 0 else -int(f"{half:e}".split("e")[1])))
    return f"{middle:,.{digits}f} ± {half:.{digits}f}"


def paired(cell, base, part="total"):
    """resampling.Ratio of the times of a cell to those of `base`, over their common rounds."""
    from .resampling import paired_ratio

    above, below = getattr(cell, part), getattr(base, part)
    common = [n for n in above if n in below]
    return paired_ratio([below[n] for n in common], [above[n] for n in common])


def ratio_text(cell, base, part):
    """The ratio with its interval, marked with ≈ if the interval contains 1."""
    found = paired(cell, base, part)
    about = "≈ " if found.low <= 1 <= found.high else ""
    return f"{about}{text(found.value)} [{text(found.low)}, {text(found.high)}]"


def table(cells, methods, cell_text):
    """A table with one row per scene and k, and one column per method."""
    rows = []
    for scene, name in SCENES.items():
        for k in ("8", "18"):
            own = {m: cells.get((scene, k, m)) for m in METHODS}
            if any(own[m] for m in methods):
                rows.append([name, k, *(cell_text(own, m) for m in methods)])
    return markdown.table(["scene", "k", *(METHODS[m] for m in methods)], rows).rstrip("\n")


def tables(cells, answers):
    """Texts of the tables by the names of their marks."""
    plain = lambda part: lambda own, m: with_width(getattr(own[m], part).values()) if own[m] else ""
    against = lambda part: (
        lambda own, m: ratio_text(own[m], own["tiled"], part) if own[m] and own["tiled"] else ""
    )
    of_paper = {key[:2] for key in cells if "published" in key[2] or key[2] == "paper"}
    published = {key: cell for key, cell in cells.items() if key[:2] in of_paper}
    return {
        "first": first_lines(cells, answers),
        "frame": table(cells, USUAL, plain("total")),
        "walk": table(cells, USUAL, plain("walk")),
        "frame ratios": table(cells, USUAL[1:], against("total")),
        "walk ratios": table(cells, USUAL[1:], against("walk")),
        "published": table(
            published,
            ["chunked", "paper", "fair", "chunked published", "gproximity published"],
            plain("total"),
        ),
    }


def first_lines(cells, answers):
    """The answer as a list, for whole frames and, unless stated otherwise, k = 18."""
    at = lambda scene, method, k="18": cells.get((scene, k, method))
    scenes = [scene for scene in SCENES if all(at(scene, method) for method in ("tiled", "chunked", "fair"))]
    next_best = [
        min(
            (paired(at(s, other), at(s, "tiled")) for other in ("chunked", "fair")),
            key=lambda ratio: ratio.value,
        )
        for s in scenes
    ]
    grouped = [paired(at(s, "fair"), at(s, "chunked")) for s in scenes]
    return (
        "- **Fastest: the tiled walk** (`tiled`, tiles of 32 boxes against 32).\n"
        f"  A whole frame with contacts is {span(next_best)} times as fast\n"
        "  as with the better of `chunked` and gProximity (k = 18, everything on the device).\n"
        f"  Measured on one {origins(cells)}.\n"
        "  Brackets are 95 % intervals.\n"
        "- **Ours, grouped** (`chunked` by default) has the paper's chunks and another schedule: a work-group shares its walks.\n"
        f"  It {against_gproximity(grouped, 'scenes', ' ')}\n"
        + paper_schedule(cells)
        + f"- **Right**: {sum(answers)} of {len(answers)} cells of the plan have the reference's pairs and contacts, bit for bit.\n"
        "  With default bounds no colliding pair is missed: this is [proved](algorithms/bounds/README.md), and\n"
        "  [tested](docs/user/accuracy.md) against the exact truth."
    )


def against_gproximity(ratios, noun, each):
    """One or two sentences on the Ratio of gProximity's time to that of the walk: where the walk is faster,
    and where it is slower."""
    wins, loses = (
        [ratio for ratio in ratios if ratio.value >= 1],
        [inverse(ratio) for ratio in ratios if ratio.value < 1],
    )
    if not loses:
        return f"is {span(wins)} times as fast as gProximity in {len(wins)} of {len(ratios)} {noun}."
    if not wins:
        return f"takes {span(loses)} times as long as gProximity in {len(loses)} of {len(ratios)} {noun}."
    rest = f"In the other{'s' if len(loses) > 1 else ''} it takes {span(loses)} times as long."
    return f"is {span(wins)} times as fast as gProximity in {len(wins)} of {len(ratios)} {noun}.{each}{rest}"


def paper_schedule(cells):
    """The list item on the paper's own schedule, over all cells of the plan that have it; empty if there are
    none."""
    ratios = {
        key[:2]: paired(cells[(*key[:2], "fair")], cell)
        for key, cell in cells.items()
        if key[2] == "paper" and (*key[:2], "fair") in cells
    }
    scenes = [scene for scene in SCENES if any(key[0] == scene for key in ratios)]
    ks = " and ".join(sorted({k for _, k in ratios}, key=int))
    return (
        (
            "- **The paper's own schedule**, in which each work-item walks its own seeds, was measured in "
            f"{len(scenes)} of these scenes (k = {ks}).\n"
            f"  It {against_gproximity(list(ratios.values()), 'cells', ' ')}\n"
            "- **The paper's claim**, 6 to 133 times less time than gProximity, is one about uploads: its factors come mostly from those of\n"
            "  [empty queues](results/paper/README.md). [Each claim has a verdict](results/h200/paper/README.md).\n"
        )
        if ratios
        else ""
    )


def fastest_of(cells, scene, names):
    """The name of the method that is told to be the fastest in a scene."""
    from .verdicts import TimedCell, computed

    methods = list(names)
    own = [cells[(scene, "18", method)] for method in methods]
    leaders = computed([TimedCell(cell.key, cell.total, cell.session) for cell in own]).leaders()
    return names[methods[leaders[0]]] if len(leaders) == 1 else "not told apart"


def title_of(cells, names):
    """The title of the chart: the fastest methods with k = 18, and the number of scenes."""
    fastest = [fastest_of(cells, scene, names) for scene in SCENES]
    counts = sorted(((fastest.count(name), name) for name in set(fastest)), reverse=True)
    where = "in every scene" if len(counts) == 1 else f"in {counts[0][0]} of {len(SCENES)} scenes"
    return f"Fastest with k = 18 {where}: {counts[0][1]}" + "".join(
        f"; in {count}: {name}" for count, name in counts[1:]
    )


def _draw_scene(ax, row, cells, shown):
    """Draws medians with intervals of the walks in one scene. The first row has the names of all walks."""
    from .resampling import median_interval

    for method, (colour, marker, name) in shown.items():
        values = list(cells[method].total.values())
        middle = statistics.median(values)
        ax.plot(median_interval(values), [row, row], color=colour, linewidth=3, alpha=0.6)
        ax.plot(middle, row, marker, color=colour, markersize=7)
        first = row == 0
        if method == "tiled" or first:
            label = (
                f"{name}{' ' + text(middle) + ' ms' if method == 'tiled' else ''}" if first else text(middle)
            )
            side = {"tiled": "right"}.get(method, "left") if first else "center"
            ax.annotate(
                label,
                (middle, row),
                xytext=(0, 8),
                textcoords="offset points",
                ha=side,
                color=colour,
                fontweight="bold",
                fontsize=8,
            )


def picture(cells, path):
    """Draws milliseconds per frame of the three walks with intervals, one row per scene. Raises BadUse if a
    cell with k = 18 is missing, and OutputError."""
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    shown = {
        "tiled": ("#0b5394", "o", "tiled"),
        "chunked": ("#6b7885", "s", "chunked, grouped"),
        "fair": ("#96753a", "D", "gProximity"),
    }
    for scene, method in itertools.product(SCENES, shown):
        if (scene, "18", method) not in cells:
            raise BadUse(
                f"--picture needs all scenes of the plan, but the file has no cell of {METHODS[method]}, k = 18, {SCENES[scene]}"
            )
    with matplotlib.rc_context(
        {"svg.hashsalt": "tandem", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False}
    ):
        figure, ax = plt.subplots(figsize=(7, 2.9), layout="constrained")
        for row, scene in enumerate(SCENES):
            _draw_scene(ax, row, {method: cells[(scene, "18", method)] for method in shown}, shown)
        ax.set_yticks(range(len(SCENES)), SCENES.values())
        ax.set_ylim(len(SCENES) - 0.5, -0.7)
        ax.set(
            xscale="log",
            xlim=(0.025, 10),
            xlabel="milliseconds per frame, contacts included, k = 18; bars: 95 % intervals\n"
            + origins(cells),
        )
        ax.set_title(
            title_of(cells, {method: name for method, (_, _, name) in shown.items()}),
            loc="left",
            fontweight="bold",
            fontsize=10.5,
        )
        ax.xaxis.set_major_formatter("{x:g}")
        ax.grid(axis="x", alpha=0.25)
        try:
            check_output(path)
            figure.savefig(path, metadata={"Date": None})
        except OSError as problem:
            raise OutputError(f"{path}: cannot be written ({problem.strerror})") from None
        finally:
            plt.close(figure)


def _parsed(arguments):
    parser = Parser(
        prog="python3 -m tandem.answer",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", metavar="FILE.jsonl")
    outputs = parser.add_mutually_exclusive_group()
    outputs.add_argument("--write", nargs="+", default=[], metavar="README.md")
    outputs.add_argument("--picture", metavar="FILE.svg")
    return parser.parse_args(arguments)


def _make(arguments):
    options = _parsed(arguments)
    check_packages("tandem.answer", ("numpy", *(("matplotlib",) if options.picture else ())))
    cells, answers = read(options.file)
    if options.picture:
        picture(cells, options.picture)
        return "", 0
    texts = tables(cells, answers)
    for page in options.write:
        markdown.rewrite(page, "answer", texts)
    return "" if options.write else "".join(
        f"{name}\n\n{table_text}\n\n" for name, table_text in texts.items()
    ), 0


def main(arguments, program=""):
    return run(lambda: _make(arguments))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
