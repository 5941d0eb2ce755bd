# SPDX-License-Identifier: MIT
# test: cost=3
"""scripts/external culbvh on generated files of its formats, against all pairs tested one by one."""

import numpy

from tests.program import PROGRAM
from tests.script_case import ScriptCase, script

HEAD = (
    "frame,time,mesh_count,collider_count,collider_build_time,mesh_build_time,query_time,self_query_time,"
    "query_contacts,self_query_contacts,query_matches_ground_truth,self_query_matches_ground_truth"
)
COLLIDER, MESH = 120, 200


def boxes(random, count):
    lo = random.random((count, 3)).astype("f4")
    return lo, lo + (random.random((count, 3)) * 0.2).astype("f4")


def overlapping(a, b):
    """How many boxes overlap, touching included."""
    return int(((a[0][:, None] <= b[1][None]) & (b[0][None] <= a[1][:, None])).all(2).sum())


class Culbvh(ScriptCase):
    def setUp(self):
        """Frames 0, 50 and 100 of data set fall, of which 100 has a count only."""
        self.asset = self.work / self.id()
        (self.asset / "fall").mkdir(parents=True)
        (self.asset / "statistic").mkdir()
        self.counts = {number: self.write_frame(number) for number in (0, 50)}
        self.write_table("fall", {**self.counts, 100: (1, 1)})
        self.write_table("fall_lite", {0: (0, 0)})  # without boxes

    def path(self, what, number):
        return self.asset / f"fall/{what}_triangle_aabb_frame_{number:06}.bin"

    def write_frame(self, number):
        """Its counts between both and within the mesh."""
        random = numpy.random.default_rng(number)
        collider, mesh = boxes(random, COLLIDER), boxes(random, MESH)
        for what, (lo, hi) in (("moving_collider", collider), ("mesh", mesh)):
            self.path(what, number).write_bytes(numpy.concatenate([lo, hi], 1).astype("<f4").tobytes())
        return overlapping(collider, mesh), (overlapping(mesh, mesh) - MESH) // 2

    def write_table(self, name, counts, collider=COLLIDER):
        rows = (
            f"{number},0.00,{MESH},{collider},1.0,1.0,1.0,1.0,{between},{within},true,true"
            for number, (between, within) in counts.items()
        )
        (self.asset / f"statistic/{name}.csv").write_text("\n".join([HEAD, *rows]) + "\n")

    def lines(self, *options, code=0):
        """Lines of the output without times."""
        status, text, errors = script("external", "culbvh", self.asset, "--program", PROGRAM, *options)
        self.assertEqual((status, errors), (code, []), text)
        return [line.rpartition(", ")[0] if line.endswith(" s") else line for line in text.splitlines()]

    def equal(self, number):
        between, within = self.counts[number]
        return f"fall {number}: between {between:,}, within {within:,}: equal"

    def test_a_line_for_each_frame(self):
        for between, within in self.counts.values():
            self.assertGreater(min(between, within), 20)
        self.assertEqual(
            self.lines(), [self.equal(0), self.equal(50), "fall: 2 of 2 frames are equal; 3 are published"]
        )

    def test_frames_are_chosen(self):
        for chosen in ("50", "1:99"):
            self.assertEqual(
                self.lines("--frames", chosen),
                [self.equal(50), "fall: 1 of 1 frames are equal; 3 are published"],
            )

    def test_other_counts_than_published(self):
        (between, within), other = self.counts[0], self.counts[50]
        self.write_table("fall", {0: (between + 1, within), 50: other})
        first, second, summary = self.lines(code=1)
        wrong = f"{between:,} pairs; published: {between + 1:,}"
        self.assertIn(f"DIFFERENT: between, sweep: {wrong}; between, tiled on host, ", first)
        self.assertTrue(first.endswith(f" s with files: {wrong}"), first)
        self.assertEqual(second, self.equal(50))
        self.assertEqual(summary, "fall: 1 of 2 frames are equal; 2 are published")

    def test_other_boxes_than_published(self):
        self.write_table("fall", self.counts, collider=COLLIDER + 1)
        first, _, summary = self.lines(code=1)
        self.assertIn(f"between: ({COLLIDER}, {MESH}) boxes, published: ({COLLIDER + 1}, {MESH})", first)
        self.assertEqual(summary, "fall: 0 of 2 frames are equal; 2 are published")

    def test_bad_use_and_input(self):
        culbvh = ("culbvh", self.asset)
        for expected, *arguments in (
            ("expected NAME A B, or culbvh FOLDER", *culbvh, self.asset),
            ("expected NAME A B, or culbvh FOLDER", "dance", self.asset),
            ("culbvh has tables of its counts", *culbvh, "--expect", "1,2"),
            ("unknown pairs 'edge-edge'", *culbvh, "--pairs", "edge-edge"),
            ("--frames is of culbvh", "-", "a.ply", "b.ply", "--frames", "1"),
            ("expected FIRST:LAST or a number, not '5:3'", *culbvh, "--frames", "5:3"),
            ("has no statistic/NAME.csv with a folder NAME", "culbvh", self.work),
        ):
            self.refused("external", expected, *arguments)
        self.path("moving_collider", 0).unlink()
        self.refused("external", "frame_000000.bin: No such file", *culbvh)
        table = self.asset / "statistic/fall.csv"
        table.write_text(table.read_text().replace("query_contacts", "contacts"))
        self.refused("external", "fall.csv: is no table with integers in columns frame,", *culbvh)

    def test_no_frame(self):
        status, text, errors = script(
            "external", "culbvh", self.asset, "--frames", "7:9", "--program", PROGRAM
        )
        self.assertEqual((status, text), (2, "fall: 0 of 0 frames are equal; 3 are published\n"))
        self.assertIn("--frames leaves out all", errors[0])
