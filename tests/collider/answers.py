# SPDX-License-Identifier: MIT
# test: cost=8 full=20 needs=TANDEM_BUILDS_PYTHON
"""Answers of tandem.Collider of Python, as installed beside the program, equal
those of tandem run on every device, also with vertices, with arrays in memory of the device, and with algorithm auto."""

import json
import sys

import numpy

from tests.collider.case import DEVICES, POSES, ByDlpack, ColliderCase, address, run_tandem, tandem
from tests.program import bar, gmsh, sets


class Answers(ColliderCase):
    def test_equal_those_of_the_program(self):
        for device in DEVICES:
            for algorithm, settings in (
                ("tiled", {}),
                ("chunked", {"k": 8}),
                ("gproximity", {"precision": "double"}),
            ):
                with self.subTest(device=device, algorithm=algorithm):
                    settings = {**self.small(algorithm), **settings}
                    dumped = self.dumps(
                        self.placed, f"--algorithm {algorithm} --device {device}", *sets(settings)
                    )
                    collider = tandem.Collider(self.meshes, algorithm, device, **settings)
                    self.assertEqual(collider.devices, [device])
                    self.assertEqual(collider.settings["k"], str(settings.get("k", 18)))
                    for _ in range(2):  # the next frame is as good
                        self.expect_answer(collider.run(POSES), dumped)
                    self.assertEqual(collider.count(POSES), len(dumped[0]))
                    self.assertTrue((collider.pairs(POSES) == dumped[0]).all())
                    self.assertTrue((collider.contacts(POSES).pairs == dumped[1]).all())

    def test_digests_do_not_depend_on_the_device(self):
        answers = [self.collider(device=device).run(POSES) for device in DEVICES]
        self.assertEqual(answers[0].digest(), answers[1].digest())
        self.assertEqual(answers[0].contact_digest(), answers[1].contact_digest())
        self.assertEqual(answers[0].digest().count, answers[0].count)
        self.assertEqual(self.collider(output="digest").digest(POSES), answers[0].digest())
        self.assertEqual(self.collider(device="host+opencl:0").run(POSES).digest(), answers[0].digest())

    def test_contacts_do_not_need_interior_tetrahedra(self):
        whole, answer = self.collider().run(POSES), self.collider(output="contacts").run(POSES)
        self.assertGreater(len(answer.contacts()), 0)
        self.assertEqual(answer.contact_digest(), whole.contact_digest())
        self.assertTrue((answer.contacts().points == whole.contacts().points).all())
        self.assertTrue(set(map(tuple, answer.pairs())) <= set(map(tuple, whole.pairs())))

    def test_self_collision(self):
        points, tets = bar(6, (0, 0, 0))
        folded = [[abs(x - 2.25), y, z + 0.0625 * x] for x, y, z in points]
        file = gmsh(self.work / "folded.msh", folded, tets)
        mesh = (numpy.array(folded), numpy.array(tets))
        for device in DEVICES:
            dumped = self.dumps("--mesh", file, "--device", device, "--set", "self=on")
            answer = self.collider([mesh], device=device, self_collision=True).run()
            self.expect_answer(answer, dumped)
            self.assertTrue((dumped[0][:, 1] < dumped[0][:, 3]).all())
        self.assertEqual(self.collider([mesh]).count(), 0)
        self.assertEqual(self.collider([mesh], self_collision="deformable").count(), 0)
        self.assertEqual(
            self.collider([mesh], deformable=True, self_collision="deformable").digest(), answer.digest()
        )
        with self.assertRaisesRegex(ValueError, "self_collision and setting self are the same"):
            tandem.Collider([mesh], self_collision=True, self="on")
        with self.assertRaisesRegex(ValueError, "self"):
            self.collider([mesh], self_collision="yes")

    def test_every_setting_can_be_given(self):
        """No setting has the name of another argument, and those of a collider make an equal one."""
        for algorithm in tandem.algorithms():
            with self.subTest(algorithm):
                first = self.collider(algorithm=algorithm)
                twin = tandem.Collider(self.meshes, algorithm, **first.settings)
                self.assertEqual(twin.settings, first.settings)
                self.assertEqual(tandem.Collider(self.meshes, **twin.arguments).settings, first.settings)
                self.assertEqual(twin.run(POSES).digest(), first.run(POSES).digest())
        self.assertEqual(
            self.collider(algorithm="gproximity", groups=3, body_groups=[[1], [2]]).settings["groups"], "3"
        )

    def test_filters(self):
        expected = self.collider().pairs(POSES)
        self.assertGreater(len(expected), 10)
        for device in DEVICES:
            for broad in ("tight", "device"):
                with self.subTest(device=device, broad=broad):
                    options = {"device": device, "broad": broad}
                    self.assertEqual(self.collider(never_meet=[(1, 0)], **options).count(POSES), 0)
                    self.assertEqual(
                        self.collider(never_meet=[(1, 1)], **options).count(POSES), len(expected)
                    )
                    self.assertEqual(
                        self.collider(body_groups=[[0], [3, 31]], meets=[[3], [1]], **options).count(POSES), 0
                    )
                    self.assertEqual(
                        self.collider(body_groups=[[0], [3, 31]], meets=[[31], None], **options).count(POSES),
                        len(expected),
                    )
        for options, message in (
            ({"body_groups": [[0]]}, "body_groups: 1 lists for 2 bodies"),
            ({"body_groups": [[0], [32]]}, r"body_groups\[1\]: 32 is not the number of a group"),
            ({"meets": [[-1], None]}, r"meets\[0\]: -1 is not"),
            ({"never_meet": [(0, 2)]}, r"never_meet\[0\]: expected two bodies of 2"),
            ({"never_meet": [(0, 1, 1)]}, r"never_meet\[0\]: expected two"),
        ):
            with self.assertRaisesRegex(ValueError, message):
                self.collider(**options)

    def test_meshes_of_every_kind(self):
        expected = self.collider().pairs(POSES)
        self.assertGreater(len(expected), 10)
        for first in (
            str(self.files[0]),
            self.files[0],
            tandem.read_mesh(self.files[0]),
            tandem.make_mesh(*self.parts[0]),
            self.parts[0],
            tuple(ByDlpack(array) for array in self.meshes[0]),
        ):
            with self.subTest(type=type(first).__name__):
                self.assertTrue((self.collider([first, self.files[1]]).pairs(POSES) == expected).all())

    def test_bodies_share_a_mesh(self):
        one = self.collider(self.meshes[:1], bodies=[0, 0])
        two = self.collider([self.meshes[0]] * 2)
        self.assertTrue((one.pairs(POSES) == two.pairs(POSES)).all())
        self.assertGreater(one.count(POSES), 0)
        self.assertEqual(one.run(POSES).body_pairs, 1)

    def test_without_poses_bodies_are_at_their_meshes(self):
        identities = [POSES[0], POSES[0]]
        collider = self.collider()
        collider.pairs(POSES)
        self.assertTrue((collider.pairs() == collider.pairs(identities)).all())

    def test_vertices_are_used_as_given(self):
        """The program's answer for a mesh with these vertices."""
        moved = [
            numpy.array(points) * [1.0, 0.75, 1.25] + [0.125 * i, 0, 0]
            for i, (points, _) in enumerate(self.parts)
        ]
        files = [
            gmsh(self.work / f"moved{i}.msh", points.tolist(), self.parts[i][1])
            for i, points in enumerate(moved)
        ]
        for device in DEVICES:
            with self.subTest(device=device):
                dumped = self.dumps(
                    f"--mesh {files[0]} --mesh {files[1]}",
                    f"--algorithm tiled --device {device}",
                    *sets(self.small("tiled")),
                )
                collider = self.collider(device=device, deformable=True)
                self.assertNotEqual(collider.count(), len(dumped[0]))
                self.expect_answer(collider.run(vertices=moved), dumped)
                self.expect_answer(
                    collider.run(vertices={1: ByDlpack(moved[1]), 0: moved[0].astype(">f8")}), dumped
                )
                mixed = self.collider(
                    [(moved[0], self.meshes[0][1]), self.meshes[1]], device=device, deformable=[1]
                )
                self.expect_answer(mixed.run(POSES[:1] * 2, [moved[1]]), dumped)
                self.assertEqual(
                    mixed.run(POSES).count,
                    self.collider([(moved[0], self.meshes[0][1]), self.meshes[1]]).count(),
                )

    def test_scenes_of_the_laboratory(self):
        for name, frame in (("plates", 40), ("pile:bodies=20", 0)):
            scene = tandem.make_scene(name)
            self.assertEqual(len(scene.deformable), 3 if name == "plates" else 0)
            collider = self.collider(scene.meshes, bodies=scene.bodies, deformable=scene.deformable)
            dumped = self.dumps(name, "--frames", frame, "--algorithm", "tiled", "--device", "host")
            self.expect_answer(collider.run(scene.poses(frame), scene.vertices(frame) or None), dumped)
        with self.assertRaisesRegex(IndexError, "numbered from 0"):
            scene.poses(scene.frame_count)

    def test_devices_equal_those_of_the_program(self):
        listed = {
            device["id"]: {**device, "backend": backend["backend"]}
            for backend in json.loads(run_tandem("devices", "--json")[1])
            for device in backend["devices"]
        }
        mine = tandem.devices()
        self.assertEqual([device["id"] for device in mine], list(listed))
        for device in mine:
            self.assertEqual(device, {name: listed[device["id"]][name] for name in device})
        self.assertIn("tiled", tandem.algorithms())


class Auto(ColliderCase):
    def test_keeps_the_fastest_and_names_it(self):
        collider = tandem.Collider(
            self.meshes,
            "auto",
            precision="double",
            pair_capacity=65536,
            contact_capacity=65536,
            queue_bytes=65536,
        )
        self.assertEqual((collider.algorithm, collider.settings), ("auto", {}))
        collider.reset()
        trials = collider.tune(POSES, seconds=0.3)
        self.assertGreater(len(trials), 3)
        self.assertEqual(
            [trial.seconds for trial in trials[:1]], [min(trial.seconds for trial in trials[:2])]
        )
        self.assertIn(collider.algorithm, tandem.algorithms())
        self.assertEqual(
            (collider.algorithm, collider.settings["precision"]), (trials[0].algorithm, "double")
        )
        for name, value in trials[0].changes.items():
            self.assertEqual(collider.settings[name], "recheck" if value == "usual" else value)
        self.assertEqual(collider.digest(POSES), self.collider(precision="double").digest(POSES))
        print(f"\n  auto: {trials[0]} of {len(trials)}", end="", file=sys.stderr)

    def test_presets_that_reproduce_other_programs_keep_their_contacts(self):
        for algorithm, preset, rule in (
            ("chunked", "paper", "opposing"),
            ("gproximity", "unc2010", "opposing"),
            ("chunked", "grouped", "sat"),
        ):
            self.assertEqual(self.collider(algorithm=algorithm, preset=preset).settings["contact_rule"], rule)
            chosen = tandem.Collider(self.meshes, "auto", preset=preset)
            chosen.tune(POSES, seconds=0.01)
            self.assertEqual((chosen.algorithm, chosen.settings["contact_rule"]), (algorithm, rule))

    def test_compares_k_where_it_changes_no_contact(self):
        given = {"output": "contacts", "decision": "exact"}
        collider = tandem.Collider(
            self.meshes, "auto", pair_capacity=65536, contact_capacity=65536, queue_bytes=65536, **given
        )
        trials = collider.tune(POSES, seconds=60)  # enough to try all candidates also on a loaded machine
        self.assertEqual({trial.changes.get("k", "18") for trial in trials}, {"6", "18"})
        for k in (6, 18):
            self.assertEqual(
                collider.run(POSES).contact_digest(), self.collider(k=k, **given).run(POSES).contact_digest()
            )

    def test_a_first_frame_chooses(self):
        soft = tandem.Collider(
            self.meshes, "auto", deformable=True, output="count", pair_capacity=65536, queue_bytes=65536
        )
        self.assertEqual(soft.count(), self.collider(deformable=True, output="count").count())
        self.assertNotEqual(soft.algorithm, "auto")

    def test_refused_settings(self):
        for words, options in (
            ("unknown setting 'kk'", {"kk": 8}),
            ("k=7", {"k": 7}),
            ("unknown preset 'fairest'", {"preset": "fairest"}),
        ):
            with self.subTest(words), self.assertRaisesRegex(ValueError, words):
                tandem.Collider(self.meshes, "auto", **options)
        with self.assertRaisesRegex(
            ValueError, "tune: algorithm tiled was named; make the collider with algorithm=auto"
        ):
            self.collider().tune(POSES)
        undecided = tandem.Collider(self.meshes, "auto")
        with self.assertRaisesRegex(ValueError, "poses: 1 rows for 2 bodies"):
            undecided.run(POSES[:1])
        self.assertEqual(undecided.algorithm, "auto")


class DeviceInput(ColliderCase):
    """The code path of GPU arrays, run on host arrays, which are in memory of device host and are copied to other
    devices."""

    def test_frames_have_the_answers_of_host_memory(self):
        moved = [
            numpy.array(points) * [1.0, 0.75, 1.25] + [0.125 * i, 0, 0]
            for i, (points, _) in enumerate(self.parts)
        ]
        for device in DEVICES:
            with self.subTest(device=device):
                collider, soft = self.collider(device=device), self.collider(device=device, deformable=True)
                mixed = self.collider(device=device, deformable=[1])
                for dtype in (float, numpy.float32):
                    rows, points = numpy.array(POSES, dtype), [part.astype(dtype) for part in moved]
                    for mine, expected in (
                        (collider._core.run_device_input(rows, []), collider.run(rows)),
                        (soft._core.run_device_input(None, points), soft.run(vertices=points)),
                        (
                            soft._core.run_device_input(None, [None, points[1]]),
                            soft.run(vertices={1: points[1]}),
                        ),
                        (mixed._core.run_device_input(rows, [None, points[1]]), mixed.run(rows, [points[1]])),
                    ):
                        self.assertGreater(expected.contact_count, 10)
                        self.assertEqual(mine.digest(), tuple(expected.digest()))
                        self.assertEqual(mine.contact_digest(), tuple(expected.contact_digest()))
                        self.assertTrue((mine.pairs() == expected.pairs()).all())
                    if device == "host":
                        self.assertEqual(mixed._core.addresses, [address(rows), address(points[1])])

    def test_two_frames_have_the_answers_of_host_memory(self):
        given = {"motion": "linear", "contact_rule": "none"}
        points = [self.meshes[1][0] + [shift, 0, 0] for shift in (-9.0, 9.0)]
        rows = [numpy.array(POSES) + [0, shift, 0, 0, 0, 0, 0] for shift in (0, 0.25)]
        for device in DEVICES:
            mixed = self.collider(device=device, deformable=[1], **given)
            right = mixed.run(rows[0], [points[0]], next_poses=rows[1], next_vertices=[points[1]])
            self.assertGreater(right.count, 10)
            for _ in range(2):
                mine = mixed._core.run_device_input(rows[0], [None, points[0]], rows[1], [None, points[1]])
                self.assertEqual(mine.digest(), tuple(right.digest()))
            if device == "host":
                self.assertEqual(
                    mixed._core.addresses,
                    [address(array) for array in (rows[0], points[0], rows[1], points[1])],
                )
            still = mixed._core.run_device_input(rows[0], [None, points[0]], None, [None, points[0]])
            self.assertEqual(
                still.digest(), tuple(mixed.digest(rows[0], [points[0]], next_vertices=[points[0]]))
            )

    def test_values_out_of_range_give_the_same_error(self):
        collider, soft = self.collider(), self.collider(deformable=[1])
        swept = self.collider(motion="linear", contact_rule="none")
        for at, value in (((0, 0), numpy.inf), ((1, 3), numpy.nan), ((1, slice(3, 7)), 0), ((1, 2), -1e37)):
            rows = numpy.array(POSES)
            rows[at] = value
            messages = []
            for run in (
                collider.run,
                lambda given: collider._core.run_device_input(given, []),
                lambda given: swept.run(POSES, next_poses=given),
                lambda given: swept._core.run_device_input(numpy.array(POSES, float), [], given),
            ):
                with self.assertRaises(ValueError) as caught:
                    run(rows)
                messages.append(str(caught.exception))
            self.assertEqual(messages, [messages[0]] * 2 + ["successor: " + messages[0]] * 2)
        points = self.meshes[1][0].copy()
        points[3, 2] = numpy.nan
        with self.assertRaisesRegex(ValueError, "body 1: vertex 3 is not finite"):
            soft._core.run_device_input(None, [None, points])
        self.assertEqual(
            soft._core.run_device_input(None, [None, self.meshes[1][0]]).digest(), tuple(soft.digest())
        )
