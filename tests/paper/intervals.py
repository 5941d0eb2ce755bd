# SPDX-License-Identifier: MIT
# test: cost=3
"""Intervals of composed values and of steps of a simulation hold the noise of every part, and nothing is
composed with an upload of its own frames."""

import pathlib
import tempfile
import unittest

import numpy

from tests.paper import records as made
from tandem import resampling
from tandem.paper import comparison_tables, composed
from tandem.paper.folder import Folder
from tandem.paper.measures import Declared
from tandem.paper import claims
from tandem.paper.quantities import NotMeasured
from tandem.paper.rules import NOT_SETTLED, UNTESTED

SCALE = 10**9
MEAN = lambda rows: rows[0].mean(axis=-1)


def width(found):
    return found[2] - found[1]


class Resampled(unittest.TestCase):
    def test_ratios_of_sums(self):
        before = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
        self.assertEqual(
            resampling.ratio_of_sums(before, [2 * value for value in before]), (2, 2, 2, len(before))
        )
        value, low, high, _ = resampling.ratio_of_sums(before, [2.2, 3.6, 6.6, 7.2, 11.0, 10.8])
        self.assertAlmostEqual(value, 41.4 / 21)
        self.assertTrue(1.8 - 1e-9 < low < value < high < 2.2 + 1e-9, (low, high))
        ends = resampling.ratio_of_sums([0.0] * 5 + [1.0], [1.0] * 6)
        self.assertTrue(numpy.isfinite(ends).all(), ends)

    def test_blocks_are_as_long_as_steps_depend_on_each_other(self):
        noise = numpy.random.default_rng(1).normal(size=400)
        slow = numpy.convolve(noise, numpy.ones(30), "valid")
        self.assertEqual(resampling.block_length(noise), 8, "the cube root")
        self.assertTrue(15 <= resampling.block_length(slow) <= len(slow) // 4)
        self.assertGreaterEqual(resampling.block_length([noise[: len(slow)], slow]), 15, "the longest row's")
        self.assertEqual(resampling.block_length(numpy.arange(400.0)), 100, "four blocks are left")
        self.assertEqual([resampling.block_length([1.0] * count) for count in (1, 3, 12)], [1, 1, 3])

    def test_blocks_widen_the_interval_of_dependent_steps(self):
        slow = numpy.convolve(numpy.random.default_rng(2).normal(size=400), numpy.ones(30), "valid")
        alone, blocks = (
            resampling.of_parts(MEAN, [resampling.part(slow, in_order=in_order)])
            for in_order in (False, True)
        )
        self.assertGreater(width(blocks), 3 * width(alone))
        self.assertEqual(alone[3], len(slow))
        self.assertLess(blocks[3], 30)

    def test_every_part_widens_the_interval(self):
        exact, noisy = resampling.part([1.0] * 6), resampling.part([0.8, 0.9, 1.0, 1.0, 1.1, 1.2])
        both = lambda one, other: one[0].mean(axis=-1) + other[0].mean(axis=-1)
        widths = [
            width(resampling.of_parts(both, parts))
            for parts in ([exact, exact], [exact, noisy], [noisy, exact], [noisy, noisy])
        ]
        self.assertEqual(widths[0], 0)
        self.assertTrue(0 < widths[1] < widths[3] and 0 < widths[2] < widths[3], widths)
        self.assertEqual(resampling.of_parts(both, [noisy, resampling.part([1.0])])[3], 1, "one sample")


class Composed(unittest.TestCase):
    """Frames of 1 s with 500 batches, one upload of 0.1 s for each, and a bounded array."""

    def setUp(self):
        work = tempfile.TemporaryDirectory(prefix="tandem-intervals")
        self.addCleanup(work.cleanup)
        self.work, self.count = pathlib.Path(work.name), 0

    def folder(self, files):
        self.count += 1
        return Folder(made.write_folder(self.work / str(self.count), files))

    def cell(self, scene, algorithm, seconds, what="frame", **settings):
        wanted = {"algorithm": algorithm, "preset": "published", "k": "8", **settings}
        one = made.record(scene, wanted, len(seconds))
        made.set_quantity(one, "frame", [SCALE] * len(seconds))
        made.set_quantity(one, what, [SCALE * value for value in seconds])
        return one

    def ratio(self, other, own, upload, digest="elsewhere", array_bytes=0):
        array = self.cell("plates", "gproximity", [50 * value for value in upload], "stages:write")
        array["scene"]["digest"] = digest
        array["stages"]["write"]["bytes"] = array_bytes
        folder = self.folder(
            {
                "cells-plates": [
                    self.cell("plates", "gproximity", other),
                    self.cell("plates", "chunked", own),
                ],
                "array": [array],
            }
        )
        cases = {case.algorithm: case for case in folder.cases("cells-plates")}
        return composed.ratio_with_array(
            cases["gproximity"], "frame", cases["chunked"], "frame", folder.cases("array")
        )

    def test_the_noise_of_each_part_is_in_the_interval(self):
        calm, noisy = [1.0] * 6, [0.7, 0.8, 0.9, 1.1, 1.2, 1.3]
        widths = []
        for parts in ((calm, calm, calm), (noisy, calm, calm), (calm, noisy, calm), (calm, calm, noisy)):
            found = self.ratio(*parts)
            self.assertAlmostEqual(found.value, 51, delta=6)
            self.assertEqual(found.samples, 6)
            widths.append(found.high - found.low)
        self.assertEqual(widths[0], 0)
        self.assertTrue(all(own > 0.1 for own in widths[1:]), widths)

    def test_the_bounded_array_is_not_uploaded_twice(self):
        """Half of the whole array is already in the frame: half of the upload is added."""
        whole = 2 * 67108864
        found = self.ratio([1.0] * 3, [1.0] * 3, [1.0] * 3, array_bytes=whole * made.FULL_STEPS)
        self.assertAlmostEqual(found.value, 26)

    def test_frames_with_one_round_are_the_samples(self):
        """Six frames, one round of each: the interval is that of blocks of frames, and batches go with
        them."""
        records = []
        for frame, seconds in enumerate((1, 2, 1, 2, 1, 2)):
            for algorithm, factor in (("gproximity", 1), ("chunked", 2)):
                one = self.cell("plates", algorithm, [factor * seconds])
                one["frames"], one["key"] = {"first": frame, "last": frame}, f"{algorithm} {frame}"
                one["total_ns"]["frames"] = [[factor * seconds * SCALE]]
                one["work"]["body_pairs"] = [seconds]
                records.append(one)
        array = self.cell("tower", "gproximity", [3.0 * made.FULL_STEPS] * 3, "stages:write")
        folder = self.folder({"cells-plates": records, "array": [array]})
        other, own = sorted(folder.cases("cells-plates"), key=lambda case: case.algorithm, reverse=True)
        found = composed.ratio_with_array(other, "frame", own, "frame", folder.cases("array"))
        self.assertEqual((found.value, found.low, found.high, found.samples), (2, 2, 2, 3))
        self.assertIn("frames, uploads", found.basis)

    def test_nothing_is_composed_with_an_upload_of_its_own_frames(self):
        with self.assertRaisesRegex(NotMeasured, "in a frame that it would be added to"):
            self.ratio([1.0] * 3, [1.0] * 3, [1.0] * 3, digest="plates")
        fields = {one["id"]: one for one in claims.declared()}["write"]
        cells = [
            made.record("plates", Declared(fields).wanted(fields[side], "8"), 3)
            for side in ("above", "below")
        ]
        for one in cells:
            made.set_quantity(one, "write", [SCALE] * 3)
        line = claims.line_of(
            Declared(fields), self.folder({"cells-plates": cells, "array": cells[:1]}), "plates", "8"
        )
        self.assertEqual(line.verdict, UNTESTED)
        self.assertIn("in a frame that it would be added to", line.reason)

    def test_steps_of_a_simulation_are_drawn_in_blocks(self):
        """A solver that slowly takes longer, beside frames; and times that slowly grow with contacts."""
        fields = {one["id"]: one for one in claims.declared()}
        steps = [
            made.step(
                i, contacts_found=1, host={"solve": 10**6 * (1 + i), "assemble": 0, "reduce": 0, "move": 0}
            )
            for i in range(made.FULL_STEPS)
        ]
        own, other = self.cell("funnel", "chunked", [1.0] * 3), self.cell("funnel", "gproximity", [1.0] * 3)
        array = self.cell("plates", "gproximity", [500.0] * 3, "stages:write")
        folder = self.folder(
            {
                "cells-funnel": [other, own],
                "array": [array],
                "solver-funnel": made.simulation("funnel", steps),
            }
        )
        cases = {case.algorithm: case for case in folder.cases("cells-funnel")}
        run = folder.simulation("solver-funnel")
        rest = composed.Rest(run, cases["chunked"], ["solve"])
        found = composed.ratio_with_array(
            cases["gproximity"], "frame", cases["chunked"], "frame", folder.cases("array"), rest
        )
        solver = sum(range(1, 501)) / 1e3
        self.assertAlmostEqual(found.value, (501 + solver) / (1 + solver))
        self.assertIn("blocks of 125 steps", found.basis)
        self.assertTrue(found.low < 0.9 * found.value < 1.1 * found.value < found.high)
        growing = [
            made.step(i, stages={"traverse": 1000 + 50 * i}, contacts_found=10 * (i + 1)) for i in range(60)
        ]
        folder = self.folder({"solver-funnel": made.simulation("funnel", growing)})
        line = claims.line_of(Declared(fields["grows-with-contacts"]), folder, "funnel", "8")
        self.assertEqual((line.measured.samples, line.measured.basis), (4, "blocks of 15 neighbouring steps"))

    def test_disturbed_uploads_settle_nothing(self):
        fields = {one["id"]: one for one in claims.declared()}["write"]
        cells = [
            made.record("plates", Declared(fields).wanted(fields[side], "8"), 3)
            for side in ("above", "below", "array")
        ]
        for one in cells:
            made.set_quantity(one, "write", [SCALE] * 3)
        cells[2]["scene"]["digest"] = "elsewhere"
        cells[2]["conditions"] = {"disturbed": [{"round": number, "why": "load"} for number in range(3)]}
        line = claims.line_of(
            Declared(fields), self.folder({"cells-plates": cells[:2], "array": cells[2:]}), "plates", "8"
        )
        self.assertEqual((line.verdict, line.reason), (NOT_SETTLED, "disturbed samples only"))

    def test_table_4_has_the_papers_k40c_beside_ours(self):
        """A narrow phase of 1 + 500 * 0.1 s over 0.5 s is 102: 102 / 60.8 of the paper's in plates."""
        preset = {"algorithm": "gproximity", "preset": "published-k40c", "k": "8"}
        own = self.cell("plates", "chunked", [0.49, 0.5, 0.51], "narrow")
        other, array = made.record("plates", preset, 3), made.record("tower", preset, 3)
        for what in ("frame", "narrow"):
            made.set_quantity(other, what, [SCALE] * 3)
        made.set_quantity(array, "stages:write", [50 * SCALE] * 3)
        folder = self.folder({"cells-plates": [own], "gpus-plates": [other], "array-k40c": [array]})
        rows = [row for row in comparison_tables.table4(folder).rows if row.get("paper_narrow")]
        self.assertEqual(len(rows), 1)
        [row] = rows
        self.assertIn("published-k40c, whole array (composed)", row["method"])
        self.assertEqual((row["paper_narrow"], row["paper_low"]), (60.8, 60.75))
        self.assertAlmostEqual(row["narrow"], 102)
        self.assertTrue(row["narrow_low"] < 102 < row["narrow_high"])
        self.assertAlmostEqual(row["narrow_over_paper"], 102 / 60.8)
        self.assertAlmostEqual(row["over_paper_low"], row["narrow_low"] / 60.85)
        self.assertAlmostEqual(row["over_paper_high"], row["narrow_high"] / 60.75)
        del own["phases"]
        old = self.folder({"cells-plates": [own], "gpus-plates": [other], "array-k40c": [array]})
        self.assertFalse([row for row in comparison_tables.table4(old).rows if row.get("paper_narrow")])
