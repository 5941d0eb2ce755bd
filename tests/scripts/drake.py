# SPDX-License-Identifier: MIT
# test: cost=2 full=90
"""The rational polygons of scripts/drake on tetrahedra whose polygon is known. The long form compares the program
with Drake, where `scripts/drake setup` has fetched it."""

import importlib
import os
import pathlib
import subprocess
import unittest

from tests.program import LONG, PROGRAM, SOURCE
from tests.script_case import ScriptCase

exact = importlib.import_module("hydroelastic.exact")
ENVIRONMENT = pathlib.Path(os.environ.get("TANDEM_DRAKE_ENV", SOURCE / "build/drake"))
CORNER = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
STANDS = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
TURNED = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0)  # half a turn about z, by a quaternion of length 3
LARGER = tuple(tuple(4 * value - 1 for value in corner) for corner in CORNER)


def pair(pressures_of_a, pressures_of_b, b=LARGER, tolerance=1e-12):
    corners = exact.placed(CORNER, STANDS), exact.placed(b, STANDS)
    return exact.Pair(corners[0], pressures_of_a, corners[1], pressures_of_b, tolerance)


class ExactPolygons(ScriptCase):
    def test_plane_across_three_edges(self):
        found = pair((0.0, 0.0, 0.0, 2.0), (1.0, 1.0, 1.0, 1.0))  # z = 1/2
        self.assertEqual(exact.area(found.polygon()), 0.125)
        self.assertEqual(found.reason(1.0), "unexplained")

    def test_other_body_cuts(self):
        half = ((0.25, 0.0, 0.0), (4.0, 0.0, 0.0), (0.25, 4.0, 0.0), (0.25, 0.0, 4.0))
        found = pair((0.0, 0.0, 0.0, 2.0), (1.0, 1.0, 1.0, 1.0), half)
        self.assertEqual(exact.area(found.polygon()), 0.125 / 4)

    def test_poses_do_not_round(self):
        moved = exact.placed(CORNER, TURNED)
        self.assertEqual([[-x, -y, z] for x, y, z in CORNER], moved)

    def test_reasons(self):
        same = (0.0, 1.0, 0.0, 0.0)
        of_larger = (-0.0, 4.0, 0.0, 0.0)  # the same gradient
        self.assertEqual(pair(same, of_larger).reason(1.0), "of equal gradients")
        self.assertEqual(
            pair((0.0, 0.0, 0.0, 1.0), (0.0,) * 4).reason(1.0), "in a boundary face, at pressure 0"
        )
        self.assertEqual(pair((1.0, 1.0, 1.0, 2.0), (1.0,) * 4).reason(1.0), "in a face")
        self.assertEqual(pair((0.0, 0.0, 0.0, 2.0), (1.0,) * 4).reason(1e13), "small")


@unittest.skipUnless(LONG, "only in the long form")
@unittest.skipUnless(
    (ENVIRONMENT / "bin/python").exists(), f"no Drake in {ENVIRONMENT}; run scripts/drake setup"
)
class Compared(ScriptCase):
    def test_program_and_drake(self):
        command = [SOURCE / "scripts/drake", "compare", "--poses", "20", "--program", PROGRAM]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
