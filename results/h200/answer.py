#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""answer.py: writes the tables between <!-- answer: NAME --> and <!-- end --> of README.md and of
the pages of results/h200, and draws answer.svg. Scenes are those of plan.json, numbers those of plan.jsonl.
Medians have the half width of their 95 % interval. Ratios are medians over rounds that were measured side by
side."""

import collections
import csv
import json
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER.parent))
from measured import (
    Cell,
    RESULTS,
    agrees,
    ends,
    inverse,
    median_interval,
    paired,
    records,
    scene_name,
    text,
    with_interval,
    with_width,
)
from tandem import markdown, names

SECOND = FOLDER / "second_card"
PAGES = (
    RESULTS.parent / "README.md",
    *(FOLDER / page for page in ("README.md", "kernels.md", "paper/README.md")),
)
STAGES = {"refit": ["refit"], "walk": ["seed", "traverse", "balance"], "contacts": ["contact"]}
OTHERS = "rest of the device"
# Some claims in short, and what their values are.
SHOWN_CLAIMS = {
    "narrow-in-all-cases": ("Chunked's narrow phase is always faster (whole queue array)", "times as fast"),
    "write-bottleneck": ("Uploads take most of gProximity's time (whole queue array)", "% of the time"),
    "fewer-launches": ("Chunked always launches fewer kernels", "times fewer"),
    "schedule-resident": ("Its static schedule beats balancing (everything on the device)", "times as fast"),
    "threshold-choice": ("A seed threshold of 10^7 is best", "times as long as with the best one"),
    "opencl-and-cuda": ("OpenCL and CUDA give similar factors", "times another factor"),
}
VERDICTS = {
    "agrees": "agree",
    "differs": "differ",
    "not settled": "are not settled",
    "untested": "are untested",
    "by construction": "hold by construction",
    "erratum": "are errata",
}
METHODS = {
    "tiled": names.method("tiled", "resident"),
    "chunked": names.method("chunked", "grouped"),
    "paper": names.method("chunked", "paper"),
    "fair": names.method("gproximity", "fair"),
    "leaf_query": names.method("leaf_query", "resident"),
}
DRAWN = {
    "tiled": ("#0b5394", "o"),
    "chunked": ("#6b7885", "s"),
    "fair": ("#96753a", "D"),
    "leaf_query": ("#4b7d4f", "v"),
    "paper": ("#a0404a", "P"),
}


def scenes():
    """Names of the plan's scenes with their frames, in its order."""
    plan = json.loads((FOLDER / "plan.json").read_text())
    found = {}
    for entry in (plan, *plan["include"]):
        own = entry.get("scenes", plan["scenes"])
        for scene in [own] if isinstance(own, str) else own:
            found[f"{scene_name(scene)}, frames {entry.get('frames', plan['frames'])}"] = None
    return list(found)


def method_of(record):
    algorithm, preset = record["algorithm"], record["preset"]
    return preset if preset in ("paper", "fair") else algorithm


class Answer:
    """What the records tell. `cells`: by scene, k and method."""

    def __init__(self, path=FOLDER / "plan.jsonl"):
        found = records(path)
        self.scenes, self.cells = scenes(), {}
        self.right = [agrees(record) for record in found]
        for record in found:
            first, last = record["frames"]["first"], record["frames"]["last"]
            scene = f"{scene_name(record['scene']['key'])}, frames {first}:{last}"
            self.cells[scene, record["settings"]["k"], method_of(record)] = Cell(record)
        self.origin = " and ".join(sorted({cell.origin for cell in self.cells.values()}))

    def _times(self):
        """Milliseconds per frame, one row per scene and k; the least median of a row is bold."""

        def shown(own, method):
            medians = {name: median_interval(list(own[name].total.values())) for name in own}
            written = with_width(own[method].total.values())
            return f"**{written}**" if medians[method] == min(medians.values(), key=sum) else written

        rows = [
            [scene, k, *(shown({m: self.cells[scene, k, m] for m in METHODS}, method) for method in METHODS)]
            for scene in self.scenes
            for k in ("8", "18")
        ]
        return markdown.table(["scene", "k", *METHODS.values()], rows).rstrip("\n")

    def _stages(self):
        """Microseconds of the device per frame by stage, k = 18, and launches: a scene of few contacts, of many,
        and a small one; without the paper's schedule, whose walk is nearly all of its time."""
        rows = []
        for scene in (self.scenes[0], *self.scenes[-2:]):
            for method, name in METHODS.items():
                if method == "paper":
                    continue
                cell = self.cells[scene, "18", method]
                us = {stage: cell.stage_us(stages) for stage, stages in STAGES.items()}
                whole = cell.stage_us(cell.record["stages"])
                rest = whole - sum(us.values())
                numbers = [*us.values(), rest, whole]
                rows.append([scene.partition(", frames")[0], name, *map(text, numbers), text(cell.launches)])
        return markdown.table(["scene", "method", *STAGES, OTHERS, "all", "launches"], rows).rstrip("\n")

    def _ratios(self):
        """How many times as long as tiled each method takes with k = 18."""

        def shown(scene, method):
            ratio = paired(self.cells[scene, "18", method], self.cells[scene, "18", "tiled"])
            return ("≈ " if ratio.low <= 1 <= ratio.high else "") + with_interval(ratio)

        others = [method for method in METHODS if method != "tiled"]
        rows = [
            [scene.partition(", frames")[0], *(shown(scene, method) for method in others)]
            for scene in self.scenes
        ]
        return markdown.table(["scene", *map(METHODS.get, others)], rows).rstrip("\n")

    def tables(self):
        """Texts by the names of their marks."""
        return {
            "first": self.first_lines(),
            "frame": self._times(),
            "frame ratios": self._ratios(),
            "stages": self._stages(),
            "second card": self._second(),
            "libraries": self._libraries(),
            "verdicts": verdict_lines(FOLDER / "paper/claims.csv"),
            "factors": self.factors(),
            "kernels": kernel_table(records(FOLDER / "profile.jsonl")),
        }

    def _beside_cubql(self):
        """{scene: {contact rule: {method: Cell}}} of libraries.jsonl, with k = 6."""
        cells = {}
        for record in records(FOLDER / "libraries.jsonl"):
            own = cells.setdefault(scene_name(record["scene"]["key"]), {"none": {}, "opposing": {}})
            own[record["settings"]["contact_rule"]][method_of(record)] = Cell(record)
        return cells

    def _libraries(self):
        """Milliseconds per frame without contacts, and cuBQL's times over tiled's without contacts and with them."""
        methods = {name: METHODS[name] for name in METHODS if name != "paper"}
        methods["cubql"] = names.method("cubql", "resident")
        rows = []
        for scene, rules in self._beside_cubql().items():
            ratios = [with_interval(paired(own["cubql"], own["tiled"])) for own in rules.values()]
            rows.append([scene, *(text(rules["none"][method].median_ms) for method in methods), *ratios])
        heads = ["scene", *methods.values(), "cuBQL ÷ tiled", "the same with contacts"]
        return markdown.table(heads, rows).rstrip("\n")

    def _second(self):
        """How the same plan and claims came out on another card."""
        other = Answer(SECOND / "plan.jsonl.xz")
        rows = [(scene, k) for scene in self.scenes for k in ("8", "18")]
        best = lambda answer, row: min(METHODS, key=lambda method: answer.cells[*row, method].median_ms)
        same = sum(best(self, row) == best(other, row) for row in rows)
        ratios = {
            scene: text(
                other.cells[scene, "18", "tiled"].median_ms / self.cells[scene, "18", "tiled"].median_ms
            )
            for scene in self.scenes
        }
        least, most = (choose(ratios, key=lambda scene: float(ratios[scene])) for choose in (min, max))
        shown = [f"{ratios[scene]} ({scene.partition(', frames')[0]})" for scene in (least, most)]
        apart = verdicts(SECOND / "claims.csv"), verdicts(FOLDER / "paper/claims.csv")
        both = [claim for claim in apart[0] if "untested" not in (apart[0][claim], apart[1][claim])]
        changed = sum(apart[0][claim] != apart[1][claim] for claim in both)
        return f"""\
The plan also ran on another card of the same model, by {other.origin.partition(", ")[2]} (`second_card/`). The fastest method is the same in {same} of {len(rows)} rows.
With k = 18, tiled takes {" to ".join(shown)} times as long there: in small frames the host sets the pace, and the host of that card is faster. Of {len(both)} claims of the paper
that were tested on both cards, {changed} have another verdict there."""

    def _medians(self):
        """Milliseconds per frame with k = 18; the least of a row is bold."""
        rows = []
        for scene in self.scenes:
            medians = {method: self.cells[scene, "18", method].median_ms for method in METHODS}
            best = min(medians.values())
            shown = [f"**{text(ms)}**" if ms == best else text(ms) for ms in medians.values()]
            rows.append([scene.partition(", frames")[0], *shown])
        return markdown.table(["scene", *METHODS.values()], rows).rstrip("\n")

    def first_lines(self):
        """The answer of README: a table, where it comes from, and what it says of the paper."""
        at = lambda scene, method: self.cells[scene, "18", method]
        others = [method for method in METHODS if method != "tiled"]
        lead = lambda scene: min(
            (paired(at(scene, other), at(scene, "tiled")) for other in others), key=lambda ratio: ratio.value
        )
        grouped = [paired(at(scene, "fair"), at(scene, "chunked")) for scene in self.scenes]
        schedule = [paired(at(scene, "fair"), at(scene, "paper")) for scene in self.scenes]
        cubql = [
            paired(rules["none"]["cubql"], rules["none"]["tiled"]).value
            for rules in self._beside_cubql().values()
        ]
        low, high = claimed()
        cells = f"{len(self.right)} cells of [the record](results/h200/plan.jsonl)"
        right = f"In all {cells}," if all(self.right) else f"In {sum(self.right)} of {cells},"
        return f"""\
Milliseconds per frame, contacts included, with everything on the device: one {self.origin.partition(" of ")[0]}. Bounding volumes have k = 18 planes (6 make a box); *density* is the bodies' volume over that of their box.

{self._medians()}

Tiled is {ends([lead(scene).value for scene in self.scenes])} times as fast as the best other method ([intervals](results/h200/README.md)), and on boxes (k = 6), without contacts, {ends(cubql)} times as fast as NVIDIA's cuBQL. {right} pairs and contacts equal the reference's,
bit for bit. With vertices rounded to single precision, no colliding pair is missed: this is [proved](algorithms/bounds/README.md), and [tested](docs/user/accuracy.md) against the exact truth.

**The paper** reports that chunks take {low:.0f} to {high:.0f} times less time than gProximity. Most of that factor is gProximity's uploads of nearly empty queues. Against our gProximity, without these uploads and with all body pairs at once, the paper's schedule
{against_gproximity(schedule, "scenes")} The grouped schedule {against_gproximity(grouped, "scenes")}
[Each claim of the paper has a verdict](results/h200/paper/README.md)."""

    def factors(self):
        """Times of gProximity divided by those of chunked, by what is compared: in the paper, and here."""
        with open(FOLDER / "paper/claims.csv", newline="") as file:
            rows = [row for row in csv.DictReader(file) if row["value"]]
        of_claim = lambda claim: [float(row["value"]) for row in rows if row["claim"] == claim]
        at = lambda scene, method: self.cells[scene, "18", method]
        of_plan = lambda method: span(paired(at(s, "fair"), at(s, method)) for s in self.scenes)
        narrow, frame = "narrow phase as published", "whole frame, everything on the device, k = 18"
        return markdown.table(
            ["compared", "the paper's GPUs", "this GPU"],
            [
                [f"{narrow}, whole queue array", ends(claimed()), ends(of_claim("narrow-in-all-cases"))],
                [
                    f"{narrow}, without its upload",
                    ends(without_upload()),
                    ends(of_claim("narrow-small-array")),
                ],
                [f"{frame}: the paper's schedule", "", of_plan("paper")],
                [f"{frame}: the grouped schedule", "", of_plan("chunked")],
            ],
        ).rstrip("\n")

    def fastest(self, scene):
        """The drawn method that is told to be the fastest in a scene."""
        own = {METHODS[method]: self.cells[scene, "18", method] for method in DRAWN}
        best = min(own, key=lambda name: own[name].median_ms)
        is_clear = all(paired(cell, own[best]).low > 1 for name, cell in own.items() if name != best)
        return best if is_clear else "not told apart"

    def title(self):
        """The title of the chart: the fastest methods, and in how many scenes."""
        found = [self.fastest(scene) for scene in self.scenes]
        counts = sorted(((found.count(name), name) for name in set(found)), reverse=True)
        where = "in every scene" if len(counts) == 1 else f"in {counts[0][0]} of {len(found)} scenes"
        return f"Fastest with k = 18 {where}: {counts[0][1]}" + "".join(
            f"; in {count}: {name}" for count, name in counts[1:]
        )

    def _draw_row(self, ax, row, scene):
        """Draws medians with intervals of the methods in one scene."""
        for method, (colour, marker) in DRAWN.items():
            cell, name = self.cells[scene, "18", method], METHODS[method]
            ax.plot(
                median_interval(list(cell.total.values())), [row, row], color=colour, linewidth=3, alpha=0.6
            )
            ax.plot(cell.median_ms, row, marker, color=colour, markersize=7, label=name if row == 0 else None)
            if method == "tiled":
                place = {"xy": (cell.median_ms, row), "xytext": (0, 8), "textcoords": "offset points"}
                ax.annotate(
                    text(cell.median_ms), ha="center", color=colour, weight="bold", fontsize=8, **place
                )

    def draw(self, path):
        """Draws milliseconds per frame of each method with intervals, one row per scene."""
        import matplotlib

        matplotlib.use("svg")
        import matplotlib.pyplot as plt

        style = {
            "svg.hashsalt": "tandem",
            "font.size": 9,
            "axes.spines.top": False,
            "axes.spines.right": False,
        }
        with matplotlib.rc_context(style):
            figure, ax = plt.subplots(figsize=(7, 2.9), layout="constrained")
            for row, scene in enumerate(self.scenes):
                self._draw_row(ax, row, scene)
            ax.set_yticks(range(len(self.scenes)), self.scenes)
            ax.set_ylim(len(self.scenes) - 0.5, -0.7)
            label = "milliseconds per frame, contacts included, k = 18; bars: 95 % intervals\n" + self.origin
            ax.set(xscale="log", xlim=(0.05, 100), xlabel=label)
            ax.set_title(self.title(), loc="left", fontweight="bold", fontsize=10.5)
            ax.xaxis.set_major_formatter("{x:g}")
            ax.grid(axis="x", alpha=0.25)
            ax.legend(loc="upper right", frameon=False)
            figure.savefig(path, metadata={"Date": None})
            plt.close(figure)


def verdicts(path):
    """The verdict of each claim over all its scenes, or its only one."""
    with path.open() as file:
        return {row["claim"]: row["verdict"] for row in csv.DictReader(file)}


def verdict_lines(path):
    """How many claims have which verdict, and a table of some of them with the least and greatest value of their
    scenes."""
    with path.open() as file:
        rows = list(csv.DictReader(file))
    counts = collections.Counter(verdicts(path).values())
    listed = ", ".join(f"{count} {VERDICTS[verdict]}" for verdict, count in counts.most_common())
    table = []
    for claim, (says, unit) in SHOWN_CLAIMS.items():
        own = [row for row in rows if row["claim"] == claim]
        found = sorted((row for row in own if row["value"]), key=lambda row: float(row["value"]))
        factor = 100 if found[0]["unit"] == "%" else 1
        least, most = (
            f"{text(factor * float(row['value']))} ({row['scene']})" for row in (found[0], found[-1])
        )
        table.append([says, own[-1]["verdict"], f"{least if least == most else f'{least} to {most}'} {unit}"])
    heads = ["claim", "verdict", "least and greatest of the scenes"]
    return f"Of {counts.total()} claims, {listed}. Some of them:\n\n{markdown.table(heads, table)}".rstrip(
        "\n"
    )


def kernel_table(found):
    """The kernels that take at least 15 % of the time of their frame's kernels."""
    rows = []
    for record in found:
        name = METHODS[method_of(record)]
        for kernel in record["kernels"]:
            if kernel["share"] < 0.15:
                continue
            counters = kernel["counters"]
            rows.append(
                [
                    f"{scene_name(record['scene']['key'])}: {name}",
                    f"`{kernel['entry']}`",
                    text(kernel["device_ns"]["median"] / 1e3),
                    f"{100 * kernel['share']:.0f} %",
                    text(kernel["over_floor"]),
                    f"{counters['sm_percent']:.0f} %",
                    f"{counters['occupancy_percent']:.0f} %",
                    counters["top_stall"].replace("_", " "),
                ]
            )
    heads = "scene: method|kernel|us per frame|of the kernels|times its floor|issue slots|occupancy"
    return markdown.table([*heads.split("|"), "main stall"], rows).rstrip("\n")


def claimed():
    """The least and the greatest factor of the paper's Table 4 between times of the narrow phase."""
    with open(RESULTS / "paper/table4.csv", newline="") as file:
        factors = [float(row["narrow"]) for row in csv.DictReader(file)]
    return min(factors), max(factors)


def without_upload():
    """Ratios of gProximity's to chunked's times in the paper's Table 5, without column Write."""
    with open(RESULTS / "paper/table5.csv", newline="") as file:
        times = {(row["scene"], row["gpu"], row["algorithm"]): row for row in csv.DictReader(file)}
    seconds = lambda row: sum(
        float(row[name] or 0) for name in row if name.endswith("_s") and name != "write_s"
    )
    return [
        seconds(row) / seconds(times[scene, gpu, "chunked"])
        for (scene, gpu, algorithm), row in times.items()
        if algorithm == "gproximity"
    ]


def span(ratios):
    """Range of ratios with the intervals of its ends: "1.38 [1.37, 1.4] to 2.05 [2.03, 2.07]"."""
    ordered = sorted(ratios, key=lambda ratio: ratio.value)
    return " to ".join(map(with_interval, ordered[:1] + ordered[1:][-1:]))


def against_gproximity(ratios, noun):
    """One or two sentences on gProximity's times over those of a method: where it is faster, where slower."""
    wins = [ratio.value for ratio in ratios if ratio.value >= 1]
    loses = [inverse(ratio).value for ratio in ratios if ratio.value < 1]
    if not wins:
        return f"takes {ends(loses)} times as long as gProximity in all {noun}."
    where = f"{len(wins)} of {len(ratios)} {noun}" if loses else f"all {noun}"
    others = "others" if len(loses) > 1 else "other"
    rest = f" In the {others} it takes {ends(loses)} times as long." if loses else ""
    return f"is {ends(wins)} times as fast as gProximity in {where}.{rest}"


if __name__ == "__main__":
    answer = Answer()
    for page in PAGES:
        markdown.rewrite(page, "answer", answer.tables())
    answer.draw(FOLDER / "answer.svg")
