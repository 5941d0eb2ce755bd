#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""collider_input.py PROGRAM SOURCE: bad input of tandem.Collider gives an error of one line, which equals the
program's where the program has the same."""

import sys
import unittest

import numpy

from collider_case import POSES, ColliderCase, OnDevice, run_tandem, tandem
from program import gmsh


class BadInput(ColliderCase):
    def expect(self, kind, words, function, *arguments, **named):
        with self.assertRaises(kind) as caught:
            function(*arguments, **named)
        text = str(caught.exception)
        self.assertIs(type(caught.exception), kind, text)
        self.assertNotIn("\n", text)
        self.assertIn(words, text)
        print(f"\n  {kind.__name__}: {text}", end="", file=sys.stderr)

    def test_meshes(self):
        points, tets = self.meshes[0]
        nan = points.copy()
        nan[2, 1] = float("nan")
        for kind, words, mesh in (
            (ValueError, "meshes[0]: vertices: shape (20, 2); expected (n, 3)", (points[:, :2], tets)),
            (ValueError, "meshes[0]: tetrahedra: shape (24, 3); expected (n, 4)", (points, tets[:, :3])),
            (
                TypeError,
                "meshes[0]: tetrahedra: type float64; expected integers",
                (points, tets.astype(float)),
            ),
            (
                TypeError,
                "meshes[0]: vertices: type complex128; expected real numbers",
                (points.astype(complex), tets),
            ),
            (
                ValueError,
                "meshes[0]: vertices: is not an array; give rows of equal lengths",
                ([[0, 0, 0], [1, 2]], tets),
            ),
            (ValueError, "numbers from -1 to", (points, tets - 1)),
            (ValueError, "meshes[0]: tetrahedron 0 names vertex", (points, tets + 1000)),
            (ValueError, "meshes[0]: vertex 2 is not finite", (nan, tets)),
            (ValueError, "meshes[0]: no tetrahedra", (points, tets[:0])),
            (ValueError, "nowhere.msh: No such file or directory", "nowhere.msh"),
            (
                ValueError,
                "is in CUDA's memory; copy it to the host's memory (.cpu() or .get())",
                (OnDevice(), tets),
            ),
            (
                TypeError,
                "meshes[0]: type int; expected a tandem.Mesh, a path, (vertices, tetrahedra), or an object with points and cells_dict",
                7,
            ),
        ):
            with self.subTest(words):
                self.expect(kind, words, tandem.Collider, [mesh, self.files[1]])
        self.expect(TypeError, "meshes: type str; expected a list", tandem.Collider, "a.msh")
        self.expect(ValueError, "has no bodies", tandem.Collider, [])
        self.expect(
            ValueError, "bodies: body 1 is of mesh 5 of 2", tandem.Collider, self.meshes, bodies=[0, 5]
        )
        self.expect(
            ValueError, "bodies[0]: -1 is not the number of a mesh", tandem.Collider, self.meshes, bodies=[-1]
        )
        self.expect(TypeError, "bodies[0]: type float", tandem.Collider, self.meshes, bodies=[0.5])
        self.expect(
            ValueError,
            "deformable[0]: 2 is not the number of a body; there are 2",
            tandem.Collider,
            self.meshes,
            deformable=[2],
        )
        self.expect(
            ValueError,
            "broken.msh",
            tandem.read_mesh,
            gmsh(self.work / "broken.msh", [(0, 0, 0)] * 3, [[0, 1, 2, 9]]),
        )

    def test_errors_of_settings_equal_the_programs(self):
        for words, options in (
            ("unknown setting of tiled 'kk'", {"kk": 8}),
            ("unknown algorithm 'tild'", {"algorithm": "tild"}),
            ("unknown device 'hst'", {"device": "hst"}),
            ("k=7", {"k": 7}),
            ("rounding=directed is impossible on host", {"rounding": "directed"}),
            ("unknown preset of tiled 'fairest'", {"preset": "fairest"}),
            ("named twice", {"device": "host+host"}),
            ("device=all", {"device": "all"}),
        ):
            with self.subTest(words):
                self.expect(ValueError, words, tandem.Collider, self.meshes, **options)
        self.expect(
            TypeError,
            "setting k: type float; expected a word or an integer",
            tandem.Collider,
            self.meshes,
            k=8.0,
        )
        self.expect(TypeError, "device: type int; expected a name", tandem.Collider, self.meshes, device=0)
        for options, words in (
            ({"k": 7}, ("--set", "k=7")),
            ({"device": "cuda:9"}, ("--device", "cuda:9")),
            ({"rounding": "directed"}, ("--set", "rounding=directed")),
        ):
            with self.assertRaises(ValueError) as caught:
                tandem.Collider(self.meshes, **options)
            defaults = {"--algorithm": "tiled", "--device": "host", words[0]: words[1]}
            errors = run_tandem("run", "plates", *(word for pair in defaults.items() for word in pair))[2]
            self.assertEqual([f"tandem: {caught.exception}"], errors)

    def test_frames(self):
        collider, soft = self.collider(), self.collider(deformable=[1])
        points = self.meshes[1][0]
        poses = numpy.array(POSES)
        for kind, words, value in (
            (ValueError, "poses: shape (2, 6); expected (n, 7)", poses[:, :6]),
            (ValueError, "poses: shape (7,); expected (n, 7)", poses[0]),
            (ValueError, "poses: 1 rows for 2 bodies", poses[:1]),
            (TypeError, "poses: type bool", poses > 0),
            (TypeError, "poses: type <U", [["identity"] * 7] * 2),
            (TypeError, "poses: type object", [[None] * 7] * 2),
            (ValueError, "poses: row 1 has no rotation", poses * [[1], [0]]),
            (ValueError, "poses: row 0 is not finite", poses + [float("inf"), 0, 0, 0, 0, 0, 0]),
            (ValueError, "poses: row 0 has no rotation", poses + [0, 0, 0, float("nan"), 0, 0, 0]),
            (ValueError, "precision=float takes at most 1e+36", poses + [1e37, 0, 0, 0, 0, 0, 0]),
            (ValueError, "is in CUDA's memory", OnDevice()),
        ):
            with self.subTest(words):
                self.expect(kind, words, collider.pairs, value)
        bad = points.copy()
        bad[3, 2] = float("nan")
        for kind, words, value in (
            (ValueError, "vertices: 2 arrays for 1 deformable bodies", [points, points]),
            (ValueError, "vertices: 0 is not a deformable body (those are: 1)", {0: points}),
            (ValueError, "vertices of body 1: shape (16, 2)", [points[:, :2]]),
            (ValueError, "vertices: 15 rows for body 1, whose mesh has 16 vertices", [points[1:]]),
            (ValueError, "body 1: vertex 3 is not finite", [bad]),
            (TypeError, "vertices of body 1: type complex128", [points.astype(complex)]),
            (TypeError, "vertices: type int; expected a list", 5),
        ):
            with self.subTest(words):
                self.expect(kind, words, soft.pairs, vertices=value)
        self.expect(
            ValueError,
            "no body is deformable; make the collider with deformable=True",
            collider.pairs,
            vertices=[points],
        )
        self.assertTrue(
            (collider.pairs(POSES) == self.collider().pairs(POSES)).all(), "goes on after bad input"
        )

    def test_successors(self):
        still, swept = self.collider(), self.collider(deformable=[1], motion="linear", contact_rule="none")
        points, poses = self.meshes[1][0], numpy.array(POSES)
        bad = points.copy()
        bad[3, 2] = float("nan")
        for run in (
            swept.run,
            tandem.Collider(self.meshes, "auto", motion="linear", contact_rule="none").run,
        ):
            self.expect(
                ValueError,
                "setting motion=linear needs the frame's successor; give next_poses or next_vertices",
                run,
                POSES,
            )
        for run in (still.run, still.count, tandem.Collider(self.meshes, "auto").tune):
            self.expect(
                ValueError,
                "next_poses and next_vertices are for setting motion=linear",
                run,
                POSES,
                next_poses=POSES,
            )
        for kind, words, named in (
            (ValueError, "next_poses: shape (2, 6); expected (n, 7)", {"next_poses": poses[:, :6]}),
            (ValueError, "next_poses: 1 rows for 2 bodies", {"next_poses": poses[:1]}),
            (TypeError, "next_poses: type bool", {"next_poses": poses > 0}),
            (
                ValueError,
                "successor: poses: row 0 is not finite",
                {"next_poses": poses + [float("inf"), 0, 0, 0, 0, 0, 0]},
            ),
            (
                ValueError,
                "successor: body 0 has a coordinate of 1e+37, and precision=float",
                {"next_poses": poses + [1e37, 0, 0, 0, 0, 0, 0]},
            ),
            (
                ValueError,
                "next_vertices: 2 arrays for 1 deformable bodies",
                {"next_vertices": [points, points]},
            ),
            (ValueError, "next_vertices: 0 is not a deformable body", {"next_vertices": {0: points}}),
            (ValueError, "next_vertices of body 1: shape (16, 2)", {"next_vertices": [points[:, :2]]}),
            (ValueError, "next_vertices: 15 rows for body 1", {"next_vertices": [points[1:]]}),
            (ValueError, "successor: body 1: vertex 3 is not finite", {"next_vertices": [bad]}),
            (TypeError, "next_vertices: type int; expected a list", {"next_vertices": 5}),
        ):
            with self.subTest(words):
                self.expect(kind, words, swept.run, POSES, **named)
        self.expect(
            ValueError,
            "next_vertices: no body is deformable",
            self.collider(motion="linear", contact_rule="none").run,
            next_vertices=[points],
        )
        self.expect(
            ValueError,
            "choose decision=exact or contact_rule=none",
            self.collider,
            motion="linear",
            decision="recheck",
        )
        self.assertEqual(self.collider(motion="linear").settings["decision"], "exact")
        self.assertEqual(
            swept.digest(POSES, next_poses=POSES).count,
            self.collider(deformable=[1]).count(POSES),
            "goes on after bad input",
        )

    def test_answers_that_were_not_stored(self):
        counted = self.collider(output="count").run(POSES)
        self.assertEqual(counted.count, self.collider().count(POSES))
        for ask in (counted.pairs, counted.contacts, lambda: counted.pairs(on_device=True)):
            self.expect(ValueError, "output=count keeps no pairs", ask)
        self.expect(
            ValueError,
            "contact_rule=none makes no contacts",
            self.collider(contact_rule="none").run(POSES).contacts,
        )
        self.expect(
            ValueError,
            "no array library takes OpenCL's memory by DLPack",
            self.collider(device="opencl:0").run(POSES).pairs,
            on_device=True,
        )
        self.expect(
            tandem.DeviceError,
            "host: the pairs are in 2 parts",
            self.collider(device="host+opencl:0").run(POSES).pairs,
            on_device=True,
        )

    def test_failures_of_devices(self):
        self.assertTrue(
            issubclass(tandem.DeviceError, RuntimeError)
            and issubclass(tandem.OutOfMemory, tandem.DeviceError)
        )
        self.expect(
            tandem.OutOfMemory,
            "bytes",
            tandem.Collider,
            self.meshes,
            **{**self.small("gproximity"), "algorithm": "gproximity", "queue_bytes": 1 << 39},
        )


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
