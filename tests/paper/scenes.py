# SPDX-License-Identifier: MIT
# test: cost=1
"""Claims of 'tandem paper' that exported meshes and counts of simulations decide."""

import csv
import pathlib
import tempfile
import unittest

from tests.paper import records as made
from tandem.paper import claims
from tandem.paper.folder import Folder
from tandem.paper.measures import Declared
from tandem.paper.rules import AGREES, BY_CONSTRUCTION, DIFFERS, UNTESTED

CORNERS = {"o": (0, 0, 0), "x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1), "-z": (0, 0, -1)}
COLUMNS = ["mesh", "chunk", "super_chunk", *(f"{axis}{i}" for i in range(4) for axis in "xyz")]


class Scenes(unittest.TestCase):
    def setUp(self):
        work = tempfile.TemporaryDirectory(prefix="tandem-scenes")
        self.addCleanup(work.cleanup)
        self.work, self.count = pathlib.Path(work.name), 0
        self.fields = {one["id"]: one for one in claims.declared()}

    def folder(self, files, chunks=()):
        """chunks: {order: [(chunk, scale, names of four corners)]}."""
        self.count += 1
        names = [f"chunks-{order}" for order in chunks]
        path = made.write_folder(self.work / str(self.count), {**files, **dict.fromkeys(names, [])})
        for order, rows in dict(chunks).items():
            with open(path / f"chunks-{order}.csv", "w", newline="") as file:
                writer = csv.writer(file)
                writer.writerow(COLUMNS)
                for chunk, (x, y, z), names in rows:
                    corners = [(x * a, y * b, z * c) for a, b, c in (CORNERS[name] for name in names)]
                    writer.writerow([0, chunk, 0, *(value for corner in corners for value in corner)])
        return Folder(path)

    def line(self, claim, scene, folder):
        return claims.line_of(Declared(self.fields[claim]), folder, scene, "8")

    def test_faces_of_one_tetrahedron_are_the_boundary(self):
        """Two tetrahedra with a common face have six faces outside."""
        two = [(0, (1, 1, 1), ("o", "x", "y", "z")), (0, (1, 1, 1), ("o", "x", "-z", "y"))]
        found = self.line("surface-meshes", "", self.folder({}, {"morton": two}))
        self.assertEqual((found.verdict, found.measured.value), (DIFFERS, 2 / 6))
        inside = {**self.fields["surface-meshes"], "rule": {"at_least": 0.3}}
        folder = self.folder({}, {"morton": two})
        self.assertEqual(claims.line_of(Declared(inside), folder, "", "8").verdict, BY_CONSTRUCTION)
        self.assertEqual(self.line("surface-meshes", "", self.folder({})).verdict, UNTESTED)

    def test_few_chunks_have_no_median(self):
        """Chunks of one tetrahedron each, cubes and slabs of a quarter of their height."""
        rows = lambda height, count: [(i, (1, 1, height), ("o", "x", "y", "z")) for i in range(count)]
        line = lambda count: self.line(
            "z-order-fat",
            "",
            self.folder({}, {"morton-8000": rows(1, count), "breadth-8000": rows(0.25, count)}),
        )
        self.assertEqual((line(8).verdict, line(8).measured.value), (AGREES, 4))
        self.assertEqual(
            (line(7).verdict, line(7).reason), (UNTESTED, "the mesh has 7 chunks, too few for a median")
        )

    def test_contacts_of_the_same_steps_of_two_simulations(self):
        """Three times as many in steps 20 to 121, and none in the others."""

        def line(times, steps=made.FULL_STEPS):
            run = lambda scene, count: made.simulation(
                scene, [made.step(i, contacts_kept=count if 20 <= i <= 121 else 0) for i in range(steps)]
            )
            files = {"solver-glasses": run("glasses", 10 * times), "solver-funnel": run("funnel", 10)}
            return self.line("contacts-of-glasses", "glasses", self.folder(files))

        self.assertEqual((line(3).verdict, line(3).measured.value), (AGREES, 3))
        self.assertEqual(line(1).verdict, DIFFERS)
        self.assertEqual(
            (line(3, 100).verdict, line(3, 100).reason),
            (UNTESTED, "not all of the steps 20 to 121 were simulated"),
        )

    def test_scenes_of_captions_are_inputs(self):
        run = made.simulation("meteor", [made.step(0)])
        for bodies, verdict in ((1082, BY_CONSTRUCTION), (1081, DIFFERS)):
            run[-1]["scene"]["bodies"] = bodies
            found = self.line("meteor-bodies", "meteor", self.folder({"solver-meteor": run}))
            self.assertEqual(found.verdict, verdict, bodies)
