# SPDX-License-Identifier: MIT
"""Helpers shared by tests of tandem.Collider: the package `tandem`, installed into an empty folder when this
is imported; colliders and answers of the program; arrays of other libraries."""

import csv
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy

from tests.program import PROGRAM, SMALL, Case, bar, gmsh, tandem as run_tandem

FOLDER = tempfile.TemporaryDirectory(prefix="tandem-collider")
subprocess.run(
    ["cmake", "--install", PROGRAM.parent, "--component", "python", "--prefix", FOLDER.name],
    check=True,
    capture_output=True,
)
sys.path.insert(0, FOLDER.name)
import tandem

assert pathlib.Path(tandem.__file__).is_relative_to(FOLDER.name)

DEVICES = ("host", "opencl:0")
POSES = [[0, 0, 0, 1, 0, 0, 0], [0.125, 0, 0.0625, 0.98, 0.1, 0.05, 0.15]]


def address(array):
    return array.__array_interface__["data"][0]


class OnDevice:
    """An array that reports device memory, as those of GPU libraries do."""

    def __dlpack_device__(self):
        return 2, 0

    def __dlpack__(self, **_):
        raise AssertionError("asked for its memory")


class ByDlpack:
    """An array in host memory that is not a NumPy array."""

    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **options):
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


class ColliderCase(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.parts = [bar(4, (0, 0, 0)), bar(3, (0.5, 0.25, 0.375))]
        cls.files = [gmsh(cls.work / f"part{i}.msh", *part) for i, part in enumerate(cls.parts)]
        cls.meshes = [(numpy.array(points), numpy.array(tets)) for points, tets in cls.parts]
        bodies = zip(cls.files, (" ".join(map(str, pose)) for pose in POSES))
        cls.placed = " ".join(f"--mesh {file} --pose '{pose}'" for file, pose in bodies)

    def collider(self, meshes=None, **options):
        return tandem.Collider(
            self.meshes if meshes is None else meshes,
            **{**self.small(options.get("algorithm", "tiled")), **options},
        )

    def small(self, algorithm):
        """Capacities of few rows, for those that the algorithm has."""
        (listed,) = json.loads(run_tandem("algorithms", algorithm, "--json")[1])
        return {
            name: SMALL[name]
            for name in SMALL
            if name in {parameter["name"] for parameter in listed["parameters"]}
        }

    def dumps(self, *arguments):
        """Pairs, pairs of contacts, and points, normals and depths from a run of the program over one frame,
        with Python's default contacts."""
        paths = self.work / "pairs.csv", self.work / "contacts.csv"
        words = " ".join(str(argument) for argument in arguments)
        contacts = [
            f"{name}={value}"
            for name, value in (("contact_rule", "sat"), ("decision", "usual"))
            if f"{name}=" not in words
        ]
        self.output(
            "run",
            *arguments,
            *(word for one in contacts for word in ("--set", one)),
            "--no-check --no-count --dump-pairs",
            paths[0],
            "--dump-contacts",
            paths[1],
        )
        pairs, contacts = (
            numpy.array(list(csv.reader(path.read_text().splitlines()))[1:], dtype=float).reshape(-1, columns)
            for path, columns in zip(paths, (5, 12))
        )
        return pairs[:, 1:].astype(int), contacts[:, 1:5].astype(int), contacts[:, 5:]

    def expect_answer(self, answer, dumped):
        pairs, ids, values = dumped
        self.assertGreater(len(ids), 10)
        mine = answer.pairs()
        self.assertEqual((mine.dtype, mine.shape), (numpy.int32, (answer.count, 4)))
        self.assertTrue((mine == pairs).all())
        contacts = answer.contacts()
        self.assertEqual(answer.contact_count, len(contacts.pairs))
        self.assertTrue((contacts.pairs == ids).all())
        self.assertTrue(
            (numpy.column_stack((contacts.points, contacts.normals, contacts.depths)) == values).all()
        )
        self.assertEqual(contacts.features.shape, contacts.depths.shape)

    def expect_mistakes(self, table, names):
        """Every row of the table, which has an exception, words of its message and a call with these names, gives
        the exception, of one line."""
        kinds = (ValueError, TypeError, tandem.DeviceError, tandem.OutOfMemory)
        for row in filter(None, table.splitlines()):
            name, words, call = re.split(r" +\| +", row)
            (kind,) = (kind for kind in kinds if kind.__name__ == name)
            with self.subTest(row), self.assertRaises(kind) as caught:
                eval(call, names)
            text = str(caught.exception)
            self.assertIs(type(caught.exception), kind, text)
            self.assertNotIn("\n", text)
            self.assertIn(words, text)
