# SPDX-License-Identifier: MIT
# test: cost=4 full=20 needs=TANDEM_BUILDS_PYTHON
"""Frames that tandem.write_frames writes give the program the answers of
tandem.Collider, bit for bit; series of mesh files as motion in scene descriptions, and what is refused."""

import numpy

from tests.collider.case import POSES, ColliderCase, run_tandem, tandem
from tests.program import sets, write_json


class Frames(ColliderCase):
    def motion(self):
        """Three frames of body 0 at poses and body 1 with vertices that need all digits of double."""
        poses = [[[0.01 * i, 0, 0, 1, 0, 0, 0], POSES[0]] for i in range(3)]
        return poses, [
            [self.meshes[1][0] * (1 + i / 30) + numpy.array([0.01, 0, 1 / 70]) * i] for i in range(3)
        ]

    def test_the_program_takes_them(self):
        poses, vertices = self.motion()
        scene = tandem.write_frames(
            self.work / "soft", self.meshes, poses=poses, vertices=vertices, deformable=[1]
        )
        self.assertEqual(scene, self.work / "soft/scene.json")
        collider = self.collider(deformable=[1], precision="double")
        answers = []
        for frame in range(3):
            dumped = self.dumps(
                scene,
                f"--frames {frame} --algorithm tiled --device host",
                *sets({**self.small("tiled"), "precision": "double"}),
            )
            answer = collider.run(poses[frame], vertices[frame])
            self.expect_answer(answer, dumped)
            answers.append(answer.contact_digest())
        self.assertEqual(len(set(answers)), 3)
        read = tandem.make_scene(str(scene))
        self.assertEqual((read.frame_count, read.deformable, read.bodies), (3, [1], [0, 1]))
        self.assertTrue((read.vertices(2)[1] == vertices[2][0]).all())
        out = self.work / "soft.jsonl"
        self.output(
            "run", scene, "--algorithm", "tiled,chunked", "--device", "host", "--repeat", 1, "--out", out
        )

    def test_rigid_bodies_and_matrices(self):
        turned = numpy.tile(numpy.eye(4), (2, 2, 1, 1))
        turned[1, 1, :3, 3] = 0.25, 0.125, 0
        scene = tandem.write_frames(self.work / "rigid", self.meshes[:1], bodies=[0, 0], poses=turned)
        self.assertEqual(sorted(path.name for path in scene.parent.iterdir()), ["mesh0.vtu", "scene.json"])
        dumped = self.dumps(
            scene, "--frames", 1, "--algorithm", "tiled", "--device", "host", *sets(self.small("tiled"))
        )
        self.expect_answer(self.collider(self.meshes[:1], bodies=[0, 0]).run(turned[1]), dumped)

    def test_rotations_of_any_length(self):
        """The same numbers give the same answer in Python, as a scene file, as --pose and, scaled by a power
        of two, at any size."""
        numbers = numpy.array(
            [0.07765293774064505, -0.027510828999840038, -0.4278700823561289, -0.2928281956712715]
        )
        plain = None
        for power in (0, 700, -1000):
            rows = [[0, 0, 0, *(numbers * 2.0**power)], [0.125, 0, 0.0625, *(numbers * 2.0**-power)]]
            scene = tandem.write_frames(self.work / f"turned{power}", self.meshes, poses=[rows])
            common = (
                "--algorithm tiled --device host",
                *sets({**self.small("tiled"), "precision": "double"}),
            )
            dumped = self.dumps(scene, *common)
            posed = self.dumps(
                *(
                    word
                    for file, row in zip(self.files, rows)
                    for word in ("--mesh", file, "--pose", " ".join(map(repr, map(float, row))))
                ),
                *common,
            )
            answer = self.collider(precision="double").run(rows)
            self.expect_answer(answer, dumped)
            self.expect_answer(answer, posed)
            plain = plain or answer
            self.assertEqual(
                (answer.digest(), answer.contact_digest()), (plain.digest(), plain.contact_digest())
            )

    def test_bad_frames_write_nothing(self):
        poses, vertices = self.motion()
        bad = [[vertices[0][0][1:]], *vertices[1:]]
        nan = [[vertices[0][0] * float("nan")], *vertices[1:]]
        for named, words in (
            ({"poses": poses, "vertices": bad}, r"vertices\[0\]: .* rows for body 1, whose mesh has"),
            ({"poses": poses, "vertices": nan}, r"vertices\[0\] of body 1: is not finite"),
            ({"poses": poses[:2], "vertices": vertices}, "2 and 3 frames"),
            ({"poses": poses}, "3 and 0 frames"),
            ({"poses": poses, "vertices": [[], [], []]}, "needs one array"),
            (
                {"poses": [rows[:1] for rows in poses], "vertices": vertices},
                r"poses\[0\]: 1 rows for 2 bodies",
            ),
            ({"poses": [[[0] * 7] * 2], "vertices": vertices[:1]}, "has no rotation"),
            ({"poses": poses, "vertices": vertices, "bodies": [0, 2]}, "there are 2 meshes"),
        ):
            with self.subTest(words), self.assertRaisesRegex(ValueError, words):
                tandem.write_frames(self.work / "bad", self.meshes, deformable=[1], **named)
            self.assertFalse((self.work / "bad").exists())
        (self.work / "full").mkdir()
        with self.assertRaises(FileExistsError):
            tandem.write_frames(
                self.work / "full", self.meshes, poses=poses, vertices=vertices, deformable=[1]
            )


class Series(ColliderCase):
    def refused(self, words, bodies, frames=2, **more):
        file = self.work / "series.json"
        write_json(file, frames=frames, meshes={"a": {"file": self.files[0].name}}, bodies=bodies, **more)
        status, _, errors = run_tandem("run", file, "--device", "host", "--no-check")
        self.assertEqual((status, len(errors)), (2, 1), errors)
        self.assertIn(words, errors[0])

    def test_what_is_refused(self):
        own, other = self.files[0].name, self.files[1].name
        self.refused(
            "/bodies/0/series: must be one mesh file a frame, 2 in all", [{"mesh": "a", "series": [own]}]
        )
        self.refused("/bodies/0/series/1: must be", [{"mesh": "a", "series": [own, 3]}])
        self.refused(
            "has other tetrahedra or vertices than the mesh of its body",
            [{"mesh": "a", "series": [own, other]}],
        )
        self.refused("nowhere.vtu", [{"mesh": "a", "series": [own, "nowhere.vtu"]}])
        for name, value in (
            ("fixed", False),
            ("position", [0, 0, 0]),
            ("poses", [[0, 0, 0, 1, 0, 0, 0]] * 2),
        ):
            self.refused(
                f"/bodies/0/{name}: is replaced by series", [{"mesh": "a", "series": [own, own], name: value}]
            )
        self.refused(
            "/bodies/0/series: has no place beside dynamics",
            [{"mesh": "a", "series": [own]}],
            1,
            dynamics={"materials": {"wood": 700}},
        )

    def test_a_file_that_changes_is_named(self):
        folder = tandem.write_frames(
            self.work / "moving",
            self.meshes[:1],
            vertices=[[self.meshes[0][0]], [self.meshes[0][0] + 1]],
            deformable=[0],
        ).parent
        scene = tandem.make_scene(str(folder / "scene.json"))
        self.assertTrue((scene.vertices(1)[0] == self.meshes[0][0] + 1).all())
        (folder / "body0-000001.vtu").write_bytes((folder / "body0-000000.vtu").read_bytes())
        with self.assertRaisesRegex(ValueError, "body0-000001.vtu: has changed since the scene was loaded"):
            scene.vertices(1)
        self.assertNotEqual(tandem.make_scene(str(folder / "scene.json")).key, scene.key)
