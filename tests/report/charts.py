# SPDX-License-Identifier: MIT
# test: cost=12
"""Charts of `tandem report` in Chromium: colours and order of stages, axes
with 0, names of points and kernels, warnings, titles."""

import json
import re

import numpy
from tests.program import SOURCE
from tests.report.case import RECORDS, ReportCase


# SIGHTS: colour blindness as matrices on linear RGB, of severity 1: Machado, Oliveira and Fernandes, A
# Physiologically-based Model for Simulation of Color Vision Deficiency, IEEE TVCG 15(6), 2009.
def matrix(text):
    return numpy.array(text.split(), float).reshape(3, 3)


SIGHTS = {
    "all colours": numpy.eye(3),
    "protanopia": matrix(
        "0.152286 1.052583 -0.204868 0.114503 0.786281 0.099216 -0.003882 -0.048116 1.051998"
    ),
    "deuteranopia": matrix(
        "0.367322 0.860646 -0.227968 0.280085 0.672501 0.047413 -0.011820 0.042940 0.968881"
    ),
    "tritanopia": matrix(
        "1.255528 -0.076749 -0.178779 -0.078411 0.930809 0.147602 0.004733 0.691367 0.303900"
    ),
}
XYZ = matrix("0.4124564 0.3575761 0.1804375 0.2126729 0.7151522 0.0721750 0.0193339 0.1191920 0.9503041")
LEAST_DISTANCE = 20  # of CIE 1976 L*a*b*; 2.3 is just noticeable
LEAST_CONTRAST = 3  # WCAG 2.1, 1.4.11


def linear(text):
    """Linear red, green and blue of "#rrggbb"."""
    parts = numpy.array([int(text[i : i + 2], 16) / 255 for i in (1, 3, 5)])
    return numpy.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)


def lab(rgb):
    x, y, z = (
        value ** (1 / 3) if value > 0.008856 else 7.787 * value + 16 / 116
        for value in XYZ @ rgb / (0.95047, 1, 1.08883)
    )
    return numpy.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def distances(colours):
    """(distance, sight, colour, colour) of all pairs, for each kind of sight."""
    for sight, matrix in SIGHTS.items():
        seen = [lab(numpy.clip(matrix @ linear(colour), 0, 1)) for colour in colours]
        for i, first in enumerate(seen):
            yield from (
                (numpy.linalg.norm(first - second), sight, colours[i], colours[j])
                for j, second in enumerate(seen[:i])
            )


def contrast(a, b):
    low, high = sorted(float(XYZ[1] @ linear(colour)) for colour in (a, b))
    return (high + 0.05) / (low + 0.05)


class Charts(ReportCase):
    def chart(self, figure, script):
        """The value of an expression of `chart`, the drawn chart of a figure."""
        return self.browser.run(
            f"(() => {{ const chart = Chart.getChart(document.querySelector('#{figure} canvas')); return {script}; }})()"
        )

    def ticks(self, figure):
        return self.chart(figure, "chart.scales.x.ticks.map(tick => tick.label)")

    def opened_with(self, *records):
        self.opened(self.report(self.write("some.jsonl", records)))

    def assert_title(self, figure, beginning):
        self.assertEqual(self.text(f"#{figure} h3")[: len(beginning)], beginning)

    def staged(self, **stages):
        """A record with these milliseconds of its stages."""
        record = json.loads(json.dumps(self.plan[0]))
        frames = record["frames"]["last"] - record["frames"]["first"] + 1
        one = next(iter(record["stages"].values()))
        median = lambda ms: {"device_ns": {**one["device_ns"], "median": ms * 1e6 * frames}}
        return record | {"stages": {name: one | median(ms) for name, ms in stages.items()}}

    def test_every_stage_has_one_fill(self):
        self.opened_with(self.plan[0])
        header = (SOURCE / "backends/trace.h").read_text()
        stages = sorted(re.findall(r'"(\w+)"', header[header.index("stage_names{") :]))
        order, colours, striped = (
            self.browser.run(f"tandem.{name}") for name in ("stageOrder", "stageColours", "stripedStages")
        )
        self.assertEqual((sorted(order), sorted([*colours, *striped])), (stages, stages))
        self.assertEqual((len(colours), len(set(striped.values()))), (10, len(striped)))
        for dark in (False, True):
            self.browser.dark(dark)
            ground = self.browser.run("tandem.ofStyle('--ground')")
            shown = [pair[dark] for pair in colours.values()]
            self.assertGreater(min(distances(shown)), (LEAST_DISTANCE,))
            self.assertGreaterEqual(min((contrast(one, ground), one) for one in shown), (LEAST_CONTRAST,))

    def test_stages_are_in_order_and_small_ones_are_folded(self):
        self.opened_with(self.staged(read=0.02, contact=0.3, traverse=0.5, seed=0.01, refit=0.2, made_up=0.1))
        shown = ["refit", "traverse", "contact", "made_up"]
        self.assertEqual(
            self.chart("stages", "chart.data.datasets.map(one => one.label)"), [*shown, "small stages"]
        )
        self.assertAlmostEqual(self.chart("stages", "chart.data.datasets[4].data[0]"), 0.03, 5)
        self.assertEqual(
            self.text("#stages .quiet"), "Small stages, each below 3 % of every bar: seed, read."
        )
        self.assertEqual(self.texts("#stages th"), ["cell", *shown, "seed", "read"])
        self.assert_title("stages", "Stage traverse takes 44 % of the time of ")

    def test_a_colour_does_not_depend_on_other_stages(self):
        fill = "chart.data.datasets.find(one => one.label === 'traverse').backgroundColor"
        for stages in ({"refit": 1, "traverse": 1}, {"balance": 1, "contact": 1, "traverse": 1, "seed": 0.5}):
            self.opened_with(self.staged(**stages))
            self.assertEqual(self.chart("stages", fill), self.browser.run("tandem.stageColours.traverse[0]"))

    def swept(self, values):
        """The first cell with these values of a setting, each slower than the one before."""
        for i, value in enumerate(values):
            record = json.loads(json.dumps(self.plan[0]))
            record["settings"]["seed_threshold"], record["key"] = str(value), f"{record['key']}|{value}"
            record["total_ns"]["samples"] = [ns * (1 + i) for ns in record["total_ns"]["samples"]]
            yield record

    def test_a_sweep_is_logarithmic_with_a_tick_at_0(self):
        self.opened_with(*self.swept([1000, 0, 10, 100000, 1]))
        self.assertEqual(self.ticks("sweeps"), ["0", "1", "10", "1,000", "100,000"])
        places = self.chart("sweeps", "chart.getDatasetMeta(0).data.map(point => point.x)")
        gaps = [after - before for before, after in zip(places, places[1:])]
        self.assertAlmostEqual(gaps[2], 2 * gaps[1], delta=1)
        self.assertAlmostEqual(gaps[3], gaps[2], delta=1)
        self.assertGreater(gaps[0], 20)
        label = (
            "chart.options.plugins.tooltip.callbacks.label({dataset: chart.data.datasets[0], dataIndex: 0})"
        )
        self.assertIn("seed_threshold = 0: ", self.chart("sweeps", label))
        self.assertRegex(
            self.text("#sweeps h3"),
            r"^seed_threshold = 1000 is fastest: \d[\d.]* ms per frame, 2\.00 times as fast as seed_threshold = 0 \[",
        )

    def test_one_round_has_the_same_words_everywhere(self):
        records = list(self.swept([0, 1, 2]))
        for record in records:
            total = record["total_ns"]
            total.update({name: total[name][:1] for name in ("samples", "rounds", "frames")})
        self.opened_with(*records)
        rows = [f"#{part} tbody tr{end}" for part in ("overview", "sweeps") for end in ("", ":last-child")]
        for where in (*rows, "#cells .sorts tbody tr"):
            self.assertIn("one round: no interval", self.text(where), where)
        for figure in ("overview", "sweeps"):
            self.assertIn(" took the least time, in fewer than 5 rounds: ", self.text(f"#{figure} h3"))
        self.assertNotIn("is fastest", self.text("#results") + self.text("#charts"))

    def test_errors_have_names_and_an_axis_of_powers(self):
        self.opened(self.report(SOURCE / "tests/records/accuracy.jsonl"))
        self.assertRegex(" ".join(self.ticks("error")), r"^10⁻¹⁶ 10⁻¹⁴ .* 0\.01 1$")
        drawn = self.chart("error", "chart.namesDrawn")
        unbeaten = self.chart("error", "chart.data.datasets[0].names")
        self.assertGreaterEqual(len(set(drawn) & set(unbeaten)), 3)
        self.assertGreater(len(drawn), len(unbeaten))
        self.assert_title(
            "error",
            "sat fp64 safe double has the least error, and takes 2.13 times as long as opposing fp32 safe float",
        )
        for values, first in (("0, 1e-7, 0.002, 1", ["0", "10⁻⁷"]), ("1e-7, 0.002, 1", ["10⁻⁷"])):
            ticks = self.browser.run(f"tandem.logScale('', [{values}], false).ticks.map(tick => tick.text)")
            self.assertEqual((ticks[: len(first)], ticks[-1]), (first, "1"))

    def test_kernels_in_words_and_warnings(self):
        record = json.loads((RECORDS / "profile.jsonl").read_text().splitlines()[0])
        self.opened_with(record)
        self.assertEqual(self.texts("#roofline .bad"), [])
        share = f"{100 * record['kernels'][0]['share']:.0f} %"
        title = f"The kernel that generates contacts takes {share} of the kernels' time"
        self.assert_title("roofline", title)
        date = record["ceilings"]["date"]
        conditions = (
            rf"Ceilings: measured before the kernels in the same run, {date}; that of cached bytes "
            r"with 16,777,216 bytes\. .*GPU at 1980 MHz, \d\d(?: to \d\d)? °C"
        )
        self.assertRegex(self.text("#roofline .quiet"), conditions)
        self.assertIn("walk leaf tiles", self.chart("roofline", "chart.data.datasets.map(one => one.label)"))
        record["kernels"][1]["of_operations"], record["ceilings"]["from"] = 1.25, "some/ceilings.jsonl"
        self.opened_with(record)
        warning = "Warning: the kernel that walks leaf tiles reaches 125 % of the ceiling of comparisons. "
        self.assertIn(warning, self.text("#roofline .bad"))
        self.assertIn(f"from ceilings.jsonl, measured {date[:10]}", self.text("#roofline .quiet"))

    def test_entries_of_all_kernels_become_sentences(self):
        """All entries begin with a verb of which the third person is known."""
        texts = (path.read_text() for path in SOURCE.glob("algorithms/**/*.cl"))
        entries = sorted({one for text in texts for one in re.findall(r"^KERNEL void (\w+)\(", text, re.M)})
        self.assertGreater(len(entries), 50)
        self.opened_with(self.plan[0])
        does = dict(zip(entries, self.browser.run(f"{json.dumps(entries)}.map(tandem.kernelDoes)")))
        for entry, words in (
            ("certify_pairs", "certifies pairs"),
            ("copy_leaf_bounds", "copies leaf bounds"),
            ("query_leaves", "queries leaves"),
            ("traverse_in_groups", "traverses in groups"),
            ("refit_strips", "refits strips"),
        ):
            self.assertEqual(does[entry], words)
        self.assertEqual([one for one in does.values() if "_" in one or not re.match(r"[a-z]+s\b", one)], [])
