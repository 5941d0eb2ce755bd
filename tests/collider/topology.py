# SPDX-License-Identifier: MIT
# test: cost=6 full=20 needs=TANDEM_BUILDS_PYTHON
"""Duplicates and weld in Python: the same answers and findings as of
--duplicates and --weld, on host and OpenCL, from files, arrays, bytes and objects of other libraries."""

import pickle
import warnings

import meshio
import numpy

from tests.collider.case import DEVICES, ColliderCase, run_tandem, tandem
from tests.program import bar, gmsh

POSES = [[0, 0, 0, 1, 0, 0, 0], [0.3, 0.2, 0.1, 1, 0, 0, 0]]


class Topology(ColliderCase):
    """A folded bar once, with each tetrahedron twice, and torn into tetrahedra of their own."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        points, tets = bar(4, (0, 0, 0))
        points = [(abs(x - 1.5), y + x / 16, z) for x, y, z in points]
        cls.whole = points, tets
        cls.twice = points, [*tets, *([d, b, a, c] for a, b, c, d in tets)]
        cls.torn = (
            [points[v] for tet in tets for v in tet],
            [list(range(4 * t, 4 * t + 4)) for t in range(len(tets))],
        )
        cls.paths = {
            name: gmsh(cls.work / f"{name}.msh", *getattr(cls, name)) for name in ("whole", "twice", "torn")
        }
        cls.more = 4 * len(tets) - len(points)

    def answer(self, mesh, device="host", **options):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            collider = self.collider([mesh, mesh], device=device, self_collision=True, **options)
        answer = collider.run(POSES)
        return answer.digest(), answer.contact_digest()

    def with_warnings(self, function, *arguments, **named):
        """Result and the texts of warnings, each at a line of this file."""
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            result = function(*arguments, **named)
        self.assertEqual({warning.filename for warning in caught} - {__file__}, set())
        return result, [str(warning.message) for warning in caught]

    def program(self, name, *options):
        pairs, out = self.work / "pairs.csv", self.work / "told.jsonl"
        out.unlink(missing_ok=True)
        placed = " ".join(f"--mesh {self.paths[name]} --pose '{' '.join(map(str, pose))}'" for pose in POSES)
        status, text, errors = run_tandem(
            f"run {placed} --set self=on --device host --algorithm tiled --dump-pairs {pairs} --out {out}",
            *options,
        )
        self.assertEqual(status, 0, text)
        (record,) = self.records(out)
        digests = tuple(
            (found["count"], int(found["a"], 16), int(found["b"], 16)) if isinstance(found, dict) else found
            for found in (record["agreement"]["digest"], record["agreement"]["contact_digest"])
        )
        return (
            digests,
            [line.removeprefix("tandem: ") for line in errors],
            len(pairs.read_text().splitlines()) - 1,
        )

    def test_answers_equal_the_programs(self):
        for name, options in (
            ("whole", {}),
            ("twice", {}),
            ("twice", {"duplicates": "keep"}),
            ("torn", {}),
            ("torn", {"weld": 0}),
            ("torn", {"weld": 1e-3}),
        ):
            words = [word for option, value in options.items() for word in (f"--{option}", value)]
            _, errors, count = self.program(name, *words)
            for device in DEVICES:
                with self.subTest(name, device=device, **options):
                    mesh, texts = self.with_warnings(tandem.read_mesh, self.paths[name], **options)
                    self.assertEqual(texts, [text.replace("--weld 0", "weld=0") for text in errors])
                    self.assertEqual(self.answer(mesh, device)[0].count, count)

    def test_every_kind_of_mesh_takes_them(self):
        right, kept = self.answer(self.whole), self.answer(self.twice, duplicates="keep")
        self.assertGreater(kept[0].count, right[0].count)
        self.assertNotEqual(self.answer(self.torn), right)
        arrays = lambda name: (numpy.array(getattr(self, name)[0]), numpy.array(getattr(self, name)[1]))
        for name, option, expected in (
            ("torn", {"weld": 0}, right),
            ("twice", {"duplicates": "keep"}, kept),
            ("twice", {}, right),
        ):
            forms = {
                "arrays": arrays(name),
                "path": self.paths[name],
                "bytes": self.paths[name].read_bytes(),
                "meshio": meshio.Mesh(arrays(name)[0], [("tetra", arrays(name)[1])]),
                "Mesh": self.with_warnings(tandem.make_mesh, *arrays(name), "a")[0],
            }
            for form, mesh in forms.items():
                with self.subTest(form, name=name, **option):
                    self.assertEqual(self.answer(mesh, **option), expected)

    def test_meshes_tell_what_they_are_and_keep_it(self):
        count = len(self.whole[1])
        twice, texts = self.with_warnings(tandem.make_mesh, *self.twice, "twice")
        self.assertEqual(
            texts, [f"mesh twice: {count} tetrahedra have the vertices of an earlier one and take no part"]
        )
        self.assertEqual(
            (twice.duplicates, twice.weld, twice.merged), ("merge", None, list(range(count, 2 * count)))
        )
        torn, texts = self.with_warnings(tandem.make_mesh, *self.torn, "torn", weld=0)
        self.assertEqual(texts, [f"mesh torn: {self.more} vertices are welded to an earlier one"])
        self.assertEqual(
            (torn.weld, len(torn.welded), int((torn.welded != numpy.arange(4 * count)).sum())),
            (0, 4 * count, self.more),
        )
        numpy.testing.assert_array_equal(torn.vertices, self.torn[0])
        collider, texts = self.with_warnings(tandem.Collider, [torn, twice], self_collision=True)
        self.assertEqual(texts, [], "what was told once")
        self.assertEqual((collider.arguments["duplicates"], collider.arguments["weld"]), (None, None))
        again, texts = self.with_warnings(pickle.loads, pickle.dumps([torn, twice]))
        self.assertEqual(texts, [])
        self.assertEqual(
            [(mesh.duplicates, mesh.weld, mesh.merged, mesh.welded.tolist()) for mesh in again],
            [(mesh.duplicates, mesh.weld, mesh.merged, mesh.welded.tolist()) for mesh in (torn, twice)],
        )
        collider, texts = self.with_warnings(tandem.Collider, [twice, self.paths["twice"]], duplicates="keep")
        self.assertEqual(
            [text.partition(": ")[2] for text in texts],
            [f"{count} tetrahedra have the vertices of an earlier one and are kept"] * 2,
        )
        self.assertEqual(collider.arguments["duplicates"], "keep")
        self.assertEqual(self.answer(torn), self.answer(self.whole), "the collider keeps what the mesh has")
        self.assertNotEqual(
            self.answer(tandem.make_mesh(*self.whole), weld=0.8),
            self.answer(self.whole),
            "a tolerance above the edges",
        )

    def test_scenes_take_them(self):
        scene = self.work / "scene.json"
        scene.write_text('{"meshes": {"m": {"file": "torn.msh"}}, "bodies": [{"mesh": "m"}], "frames": 1}')
        made, texts = self.with_warnings(tandem.make_scene, str(scene), weld=0)
        self.assertEqual(
            (texts, made.meshes[0].weld),
            ([f"mesh torn: {self.more} vertices are welded to an earlier one"], 0),
        )
        self.assertEqual(len(self.with_warnings(tandem.make_scene, str(scene))[1]), 1)

    def test_bad_arguments(self):
        text = f"{len(self.whole[1])} of {len(self.twice[1])} tetrahedra have the vertices of an earlier one, such as 24 those of 0"
        for kind, words, named in (
            (ValueError, "duplicates some: give merge, keep or reject", {"duplicates": "some"}),
            (TypeError, "duplicates: type int; expected merge, keep or reject", {"duplicates": 1}),
            (ValueError, "weld -1: give a finite tolerance of 0 or more", {"weld": -1}),
            (ValueError, "weld inf: give a finite", {"weld": float("inf")}),
            (ValueError, "weld nan: give", {"weld": float("nan")}),
            (TypeError, "weld: type bool; expected a tolerance", {"weld": True}),
            (ValueError, text, {"duplicates": "reject"}),
        ):
            for function, arguments in (
                (tandem.make_mesh, self.twice),
                (tandem.read_mesh, [self.paths["twice"]]),
                (tandem.Collider, [[self.twice]]),
            ):
                with self.subTest(words, function=function.__name__), self.assertRaises(kind) as caught:
                    function(*arguments, **named)
                self.assertIn(words, str(caught.exception))
                self.assertNotIn("\n", str(caught.exception))
