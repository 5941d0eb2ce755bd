# SPDX-License-Identifier: MIT
# test: full=60 needs=TANDEM_BUILDS_PYTHON
"""Distances of random pairs of tetrahedra are those of Coal (BSD-3, https://github.com/coal-library/coal), which
finds them by GJK and EPA. Installs Coal from PyPI into a folder of its own."""

import subprocess
import sys

import numpy

from tests.collider.case import DEVICES, ColliderCase, tandem
from tests.program import SOURCE

COAL = "coal==3.0.3"
PAIRS = 50000


class Coal(ColliderCase):
    def pairs(self):
        """Half of the pairs anywhere near each other; of the others, B is a small way above a face of A."""
        random = numpy.random.default_rng(5)
        a, b = random.uniform(-1, 1, (2, PAIRS, 4, 3))
        b[::2] += random.uniform(-2, 2, (len(b[::2]), 1, 3))
        normal = numpy.cross(a[1::2, 1] - a[1::2, 0], a[1::2, 2] - a[1::2, 0])
        normal /= numpy.linalg.norm(normal, axis=1)[:, None]
        up = lambda points: numpy.einsum("nij,nj->ni", points - a[1::2, :1], normal)
        normal *= -numpy.sign(up(a[1::2])[:, 3])[:, None]
        gap = 10 ** random.uniform(-5, 0, len(normal)) - up(b[1::2]).min(axis=1)
        b[1::2] += (gap[:, None] * normal)[:, None]
        return a, b

    def test_distances_are_those_of_coal(self):
        subprocess.run([sys.executable, "-m", "venv", self.work / "coal"], check=True)
        subprocess.run(
            [self.work / "coal/bin/pip", "install", "--quiet", "--disable-pip-version-check", COAL],
            check=True,
        )
        a, b = self.pairs()
        numpy.savez(self.work / "pairs.npz", a=a, b=b)
        script = SOURCE / "tests/collider/coal_measured.py"
        subprocess.run(
            [self.work / "coal/bin/python", script, self.work / "pairs.npz", self.work / "measured.npz"],
            check=True,
        )
        right = numpy.load(self.work / "measured.npz")
        mesh = (a[0], numpy.array([[0, 1, 2, 3]]))
        for device in DEVICES:
            collider = tandem.Collider(
                [mesh, mesh],
                device=device,
                deformable=True,
                worlds=PAIRS,
                margin=20,
                contact_rule="distance",
                decision="exact",
                precision="double",
            )
            found = collider.run(vertices=[a, b]).distances()
            self.assertEqual(found.pairs[:, 0].tolist(), list(range(PAIRS)))
            self.assertLess(abs(found.distances - right["distances"]).max(), 1e-9)
            apart = found.distances > 1e-3  # points of two that are closer are less certain in Coal
            self.assertGreater(apart.sum(), PAIRS / 2)
            self.assertGreater((found.distances < 0).sum(), PAIRS / 100)
            between = right["points_b"][apart] - right["points_a"][apart]
            along = numpy.einsum("ni,ni->n", found.normals[apart], between)
            self.assertLess(abs(along - found.distances[apart]).max(), 1e-7, "normals are theirs")
