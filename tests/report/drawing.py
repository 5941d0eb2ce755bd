# SPDX-License-Identifier: MIT
# test: cost=10
"""Figures of the Python package, from its wheel alone: they name the best cells, and mark cells that cannot be
told apart."""

import dataclasses
import json
import tempfile
import unittest
import warnings

import matplotlib
import pandas

from tests.program import SOURCE
from tests.report.wheel import package

matplotlib.use("agg")
H200 = SOURCE / "results/h200"


def setUpModule():
    global tandem
    tandem = package()


class Drawing(unittest.TestCase):
    def setUp(self):
        records = tandem.read(H200 / "plan.jsonl")
        cells = records.cells
        self.all = records
        self.plates = records.of(cells["scene"].str.startswith("plates") & (cells["set_k"] == 18))

    def tearDown(self):
        matplotlib.pyplot.close("all")

    def test_all_cells_are_drawn_and_the_first_is_named(self):
        axes = tandem.plot_cells(self.plates)
        names = [text.get_text() for text in axes.get_yticklabels()]
        self.assertEqual(len(names), len(self.plates.cells))
        self.assertEqual(len(set(names)), len(names), "told apart")
        title = " ".join(axes.get_title("left").split())
        self.assertIn(f"{names[0]} is fastest: ", title)
        self.assertTrue(names[0].startswith("tiled"), names)

    def test_indistinguishable_cells_are_marked(self):
        changed = []
        for number, index in enumerate(self.plates.cells.index):
            record = json.loads(json.dumps(self.plates.cell_of[index].record))
            total = record["total_ns"]
            total["samples"] = [10**6 + 10**5 * ((n + number) % 2) for n in range(len(total["rounds"]))]
            changed.append(record)
        with tempfile.NamedTemporaryFile("w", suffix=".jsonl") as file:
            file.write("".join(json.dumps(record) + "\n" for record in changed))
            file.flush()
            records = tandem.read(file.name)
        self.assertEqual(len(records.verdict().leaders()), len(records.cells))
        self.assertIn("cannot be told apart", " ".join(tandem.plot_cells(records).get_title("left").split()))

    def test_wrong_cells_are_never_drawn(self):
        cells = self.plates.cells.copy()
        first = cells["ms"].idxmin()
        cells["status"] = cells["status"].astype(str)
        cells.loc[first, "status"] = "wrong"
        records = dataclasses.replace(self.plates, cells=cells)
        for draw in (
            tandem.plot_cells,
            tandem.plot_stages,
            tandem.plot_frames,
            lambda r: tandem.plot_sweep(r, "k"),
        ):
            with self.assertWarnsRegex(UserWarning, "1 of .* cells failed, are wrong"):
                draw(records)
        with warnings.catch_warnings(), self.assertRaisesRegex(ValueError, "nothing can be drawn"):
            warnings.simplefilter("ignore")
            tandem.plot_cells(records.of([first]))

    def test_stages_and_frames_equal_the_records(self):
        axes = tandem.plot_stages(self.plates)
        drawn = sum(patch.get_width() for patch in axes.patches)
        stages = self.plates.cells.filter(like="stage_").fillna(0).to_numpy().sum()
        self.assertAlmostEqual(drawn / stages, 1, delta=0.01)
        axes = tandem.plot_frames(self.plates, "contacts")
        self.assertEqual(len(axes.lines), len(self.plates.cells))
        self.assertEqual(list(axes.lines[0].get_xdata()), list(range(20, 122)))

    def test_sweeps_name_the_best_value(self):
        records = tandem.read(H200 / "paper/records/thresholds.jsonl")
        axes = tandem.plot_sweep(records, "seed_threshold")
        best = records.cells.loc[records.cells["ms"].idxmin(), "set_seed_threshold"]
        self.assertIn(str(best), axes.get_title("left"))
        self.assertEqual(sum(len(line.get_xdata()) for line in axes.lines), len(records.cells))
        self.assertEqual(axes.get_yscale(), "log", "some cells take 4,000 times as long as others")
        published = records.cells["preset"] == "published"
        self.assertEqual(tandem.plot_sweep(records.of(~published), "seed_threshold").get_yscale(), "linear")

    def test_errors_name_the_cells_that_none_beats(self):
        records = tandem.read(SOURCE / "tests/records/accuracy.jsonl")
        scene = records.cells["scene"].str.startswith("plates") & (records.cells["device"] == "cuda:0")
        plates = records.of(scene & (records.cells["set_k"] == 18))
        written = [
            json.loads(line) for line in (SOURCE / "tests/records/accuracy.jsonl").read_text().splitlines()
        ]
        points = {}
        for cell in plates.cells.index:
            record = written[cell]
            spread = record["error"]["truth"]["contacts"]["hausdorff"]
            if spread is not None:
                points[cell] = (record["total_ns"]["median"], spread["p99"])
        named = [
            cell
            for cell, (ns, error) in points.items()
            if not any(a <= ns and b <= error and (a, b) != (ns, error) for a, b in points.values())
        ]
        self.assertTrue(0 < len(named) < len(points) > 4, points)
        axes = tandem.plot_errors(plates, "hausdorff", "p99")
        places = sorted(text.xy for text in axes.texts)
        self.assertEqual(
            [error for _, error in sorted((points[cell][1], points[cell][1]) for cell in named)],
            [x for x, _ in places],
        )
        self.assertEqual(len(axes.lines), 2 * len(points))
        self.assertRegex(
            " ".join(axes.get_title("left").split()),
            "has the least error and takes [0-9.]+ times as long as the fastest|is the fastest and has the least",
        )

    def test_zero_errors_are_drawn(self):
        errors = self.plates.cells.index[:3]
        table = pandas.DataFrame(
            {"cell": errors, "error": "false_share", "median": [0.0, 0.5, 0.25], "p99": None, "max": None}
        )
        axes = tandem.plot_errors(dataclasses.replace(self.plates, errors=table), "false_share")
        self.assertAlmostEqual(min(line.get_xdata()[0] for line in axes.lines), 0.025)
        with self.assertRaisesRegex(
            ValueError, "no such error in these records; there are none: measure with --truth"
        ):
            tandem.plot_errors(self.plates)
        with self.assertRaisesRegex(
            ValueError, "volume: no such error in these records; there are false_share"
        ):
            tandem.plot_errors(dataclasses.replace(self.plates, errors=table), "volume")

    def test_records_that_cannot_be_drawn(self):
        with self.assertRaisesRegex(
            ValueError, "no such setting in these records; there are .*seed_threshold"
        ):
            tandem.plot_sweep(self.plates, "seed_treshold")
        with self.assertRaisesRegex(ValueError, "combinations of scene, frames and device"):
            tandem.plot_cells(self.all)
        with self.assertRaisesRegex(ValueError, "no such column"):
            tandem.plot_frames(self.plates, "pairs")
