# SPDX-License-Identifier: MIT
# test: cost=2
"""The paper's columns and our records are tied in one table: every column has a quantity, phases are the
release's regions, and what the release does not time is in no column."""

import csv
import lzma
import pathlib
import tempfile
import unittest

from tests.program import SOURCE

from tests.paper import records as made
from tandem.lines import RecordError
from tandem.paper import claims, comparison_tables, simulation_tables
from tandem.paper.folder import Folder
from tandem.paper.measures import Declared
from tandem.paper.methods import columns_of, timers
from tandem.paper.quantities import NotMeasured, is_time, resolved
from tandem.paper.ratios import ratio_of
from tandem.paper.rules import AGREES, UNTESTED

SCALE = 10**9
PUBLISHED = {"algorithm": "chunked", "preset": "published", "k": "8", "residency": "published"}
NO_TIMES = {"scene", "gpu", "algorithm"}


def columns_in(table):
    with open(SOURCE / f"results/paper/table{table}.csv", newline="") as file:
        return set(next(csv.reader(file)))


class Timers(unittest.TestCase):
    def setUp(self):
        work = tempfile.TemporaryDirectory(prefix="tandem-timers")
        self.addCleanup(work.cleanup)
        self.work, self.count = pathlib.Path(work.name), 0

    def folder(self, files):
        self.count += 1
        return Folder(made.write_folder(self.work / str(self.count), files))

    def line(self, claim, files, scene="funnel"):
        fields = {one["id"]: one for one in claims.declared()}[claim]
        return claims.line_of(Declared(fields), self.folder(files), scene, "8")

    def test_every_column_of_the_paper_has_one_quantity(self):
        for table in (3, 4, 5, 6, 7):
            shares = {name for name in columns_in(table) if table == 6 and name.endswith("_percent")}
            columns = list(columns_of(table).values())
            self.assertEqual(sorted(columns), sorted(columns_in(table) - NO_TIMES - shares), table)
        for name, timer in timers().items():
            self.assertTrue(timer["release"] and ("ours" in timer or "step" in timer), name)
        with self.assertRaisesRegex(NotMeasured, "solver"):
            resolved("solver")
        self.assertEqual(
            [is_time(name) for name in ("narrow", "sum:read+write", "release launches")], [1, 1, 0]
        )

    def test_narrow_phase_and_initialization_are_phases(self):
        """Claims about the narrow phase divide phases, not frames; records without them are untested."""
        fields = {one["id"]: one for one in claims.declared()}["narrow-small-array"]
        other, own = (
            made.record("plates", Declared(fields).wanted(fields[side], "8"), 3)
            for side in ("above", "below")
        )
        made.set_quantity(other, "narrow", [40 * SCALE] * 3)
        made.set_quantity(own, "narrow", [SCALE] * 3)
        found = self.line("narrow-small-array", {"cells-plates": [other, own]}, "plates")
        self.assertEqual((found.verdict, found.measured.value), (AGREES, 40))
        for one in (other, own):
            one["phases"] = {}
        found = self.line("narrow-small-array", {"cells-plates": [other, own]}, "plates")
        self.assertEqual(
            (found.verdict, found.reason),
            (UNTESTED, "records of an older program, without the phases that the release times"),
        )
        narrow = [one for one in claims.declared() if one["id"].startswith("narrow-") and "measure" in one]
        self.assertEqual(len(narrow), 6)
        self.assertEqual({one["above"]["quantity"] for one in narrow}, {"narrow"})

    def test_preprocess_has_copies_and_neither_seeds_nor_the_array(self):
        cell = made.record("funnel", PUBLISHED, 3)
        work = {
            "convert bodies": 1,
            "flatten trees": 2,
            "copy sub trees": 4,
            "make seeds": 8,
            "queue array": 16,
        }
        for name, seconds in (work | {"store trees": 32, "sort contacts": 64}).items():
            made.set_quantity(cell, f"host work:{name}", [seconds * SCALE] * 3)
        made.set_quantity(cell, "stages:preprocess", [31 * SCALE] * 3)
        made.set_quantity(cell, "frame", [SCALE] * 3)
        folder = self.folder({"cells-funnel": [cell]})
        [case] = folder.cases("cells-funnel")
        seconds = lambda name: round(ratio_of(case, name, case, "frame").value, 9)
        self.assertEqual([seconds(name) for name in ("preprocess", "postprocess")], [7, 96])
        self.assertEqual(
            [seconds("sum:preprocess+postprocess"), seconds("largest:preprocess+postprocess")], [103, 96]
        )
        [row] = [row for row in comparison_tables.table5(folder).rows if row["source"] == "ours"]
        scale = 102 / made.FULL_STEPS
        for column, value in (
            ("preprocess_s", 7),
            ("postprocess_s", 96),
            ("make_seeds_s", 8),
            ("queue_array_s", 16),
            ("narrow_s", None),
        ):
            self.assertEqual(row[column] and round(row[column] / scale, 9), value, column)

    def test_composed_steps_have_the_phases(self):
        """Table 3 of a composed simulation: 2 ms of initialization and 5 of narrow phase in a frame of 8 ms,
        beside 12 ms of solver."""

        def percent(phases):
            cell = made.record("funnel", PUBLISHED, 1)
            for name, ms in (("frame", 8), *phases):
                made.set_quantity(cell, name, [ms * 10**6 * made.FULL_STEPS])
            steps = [
                made.step(
                    i, contacts_found=1, host={"solve": 12 * 10**6, "assemble": 0, "reduce": 0, "move": 0}
                )
                for i in range(made.FULL_STEPS)
            ]
            folder = self.folder({"steps-funnel": [cell], "solver-funnel": made.simulation("funnel", steps)})
            rows = simulation_tables.table3(folder).rows
            [row] = [row for row in rows if "composed" in row.get("data_path", "")]
            return [round(row[f"{name}_percent"], 9) for name in ("solver", "initialization", "narrow")]

        self.assertEqual(percent([("initialization", 2), ("narrow", 5)]), [60, 10, 25])
        self.assertEqual(percent([]), [60, 0, 40], "without phases: transform and refit on the device")

    def test_simulations_may_be_compressed(self):
        steps = [made.step(i, contacts_kept=1_276_800) for i in range(made.FULL_STEPS)]
        files = {"solver-funnel": made.simulation("funnel", steps)}
        folder = self.folder(files)
        plain = folder.path / "records/solver-funnel.jsonl"
        data, packed = plain.read_bytes(), plain.with_name("solver-funnel.jsonl.xz")
        packed.write_bytes(lzma.compress(data))
        plain.unlink()
        run = folder.simulation("solver-funnel")
        self.assertEqual((len(run.steps), run.location), (500, "records/solver-funnel.jsonl.xz"))
        for broken in (lzma.compress(data)[:-20], b"no xz"):
            packed.write_bytes(broken)
            with self.assertRaisesRegex(RecordError, "is not a whole file of xz"):
                folder.simulation("solver-funnel")
