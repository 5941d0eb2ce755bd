# SPDX-License-Identifier: MIT
# test: cost=4 full=20 needs=TANDEM_BUILDS_PYTHON
"""tandem.Collider with settings that enlarge bounds: pairs of a frame and its successor, and within a margin."""

import json

import numpy

from tests.collider.case import DEVICES, POSES, ColliderCase, tandem
from tests.program import sets


class Swept(ColliderCase):
    def passing(self):
        """Poses of two frames without pairs, between which body 1 passes through body 0; and their scene for
        the program."""
        frames = [
            [POSES[0], [x, 0.125, 0.0625, *turn]]
            for x, turn in ((-20.0, [1, 0, 0, 0]), (20.0, [0.98, 0.1, 0.05, 0.15]))
        ]
        meshes = {f"part{i}": {"file": file.name} for i, file in enumerate(self.files)}
        bodies = [{"mesh": f"part{i}", "poses": [frame[i] for frame in frames]} for i in range(2)]
        file = self.work / "passing.json"
        file.write_text(json.dumps({"name": "passing", "frames": 2, "meshes": meshes, "bodies": bodies}))
        return frames, file

    def test_a_body_passes_through_another(self):
        (before, after), file = self.passing()
        for device in DEVICES:
            for algorithm, settings in (("tiled", {}), ("chunked", {"k": 8})):
                with self.subTest(device=device, algorithm=algorithm):
                    given = {**self.small(algorithm), **settings, "motion": "linear", "decision": "exact"}
                    pairs, contacts, _ = self.dumps(
                        file, "--frames", 0, "--algorithm", algorithm, "--device", device, *sets(given)
                    )
                    self.assertGreater(len(pairs), 10)
                    collider = tandem.Collider(self.meshes, algorithm, device, **given)
                    for _ in range(2):  # the next frame is as good
                        answer = collider.run(before, next_poses=after)
                        self.assertTrue((answer.pairs() == pairs).all())
                        self.assertEqual((answer.contact_count, len(contacts)), (0, 0))
                    self.assertEqual(
                        [collider.count(frame, next_poses=frame) for frame in (before, after)], [0, 0]
                    )
                    self.assertEqual(collider.digest(before, next_poses=after), answer.digest())
                    self.assertTrue((collider.pairs(before, next_poses=after) == pairs).all())
                    contacts = self.collider(algorithm=algorithm, decision="exact").contacts(POSES).pairs
                    self.assertGreater(len(contacts), 10)
                    self.assertTrue(
                        (collider.contacts(POSES, next_poses=after).pairs == contacts).all(),
                        "those of the frame",
                    )

    def test_a_margin_is_a_number_or_its_text(self):
        vertices = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
        mesh = (vertices, numpy.array([[0, 1, 2, 3]]))
        poses = [[0, 0, 0, 1, 0, 0, 0], [1.25, 0, 0, 1, 0, 0, 0]]  # 0.25 apart
        for device in DEVICES:
            for margin, count in (
                (0.25, 1),
                ("0.25", 1),
                (numpy.float32(0.25), 1),
                (1, 1),
                (0.24, 0),
                (0, 0),
            ):
                with self.subTest(device=device, margin=margin):
                    collider = tandem.Collider(
                        [mesh, mesh], device=device, margin=margin, contact_rule="none"
                    )
                    self.assertEqual(collider.count(poses), count)
                    self.assertEqual(float(collider.settings["margin"]), float(margin))

    def test_distances(self):
        vertices = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
        mesh = (vertices, numpy.array([[0, 1, 2, 3]]))
        rows = [[0, 0, 0, 1, 0, 0, 0], [1.25, 0, 0, 1, 0, 0, 0], [0.75, 2, 0, 1, 0, 0, 0]]
        for device in DEVICES:
            for output, given in (("pairs", {"contact_rule": "distance"}), ("distances", {})):
                with self.subTest(device=device, output=output):
                    collider = tandem.Collider([mesh] * 3, device=device, margin=2, output=output, **given)
                    found = collider.distances(rows)
                    self.assertEqual(found.pairs.tolist(), [[0, 0, 1, 0], [0, 0, 2, 0], [1, 0, 2, 0]])
                    self.assertEqual(found.points_a[0].tolist(), [1, 0, 0])
                    self.assertEqual(found.points_b[0].tolist(), [1.25, 0, 0])
                    self.assertEqual((found.distances[0], found.normals[0].tolist()), (0.25, [1, 0, 0]))
                    self.assertEqual(found.features[0], 0b10 | 1 << 4)  # corner 1 of a, corner 0 of b
                    self.assertEqual(found.points_a[1:].tolist(), [[0, 1, 0], [1.25, 1, 0]])
                    between = numpy.linalg.norm(found.points_b - found.points_a, axis=1)
                    self.assertLess(abs(between - found.distances).max(), 1e-6)
                    apart = collider.run(rows)
                    with self.assertRaisesRegex(ValueError, "makes distances, not contacts; call distances"):
                        apart.contacts()
            with self.assertRaisesRegex(ValueError, "contact_rule=sat makes no distances"):
                tandem.Collider([mesh] * 3, device=device, margin=2).distances(rows)
            meeting = tandem.Collider([mesh] * 2, device=device, contact_rule="distance").distances(
                [rows[0], [0.75, 0, 0, 1, 0, 0, 0]]
            )
            self.assertAlmostEqual(meeting.distances[0], -0.25 / 3**0.5, 6)  # along the sloping face
            self.assertLess(meeting.normals[0] @ (meeting.points_b - meeting.points_a)[0], 0)

    def test_deformable_bodies(self):
        scene = tandem.make_scene("plates")
        given = {"motion": "linear", "decision": "exact"}
        for device in DEVICES:
            collider = self.collider(
                scene.meshes, bodies=scene.bodies, deformable=scene.deformable, device=device, **given
            )
            dumped = self.dumps(
                "plates",
                f"--frames 40 --algorithm tiled --device {device}",
                *sets({**self.small("tiled"), **given}),
            )
            poses, vertices = (
                [scene.poses(frame) for frame in (40, 41)],
                [scene.vertices(frame) for frame in (40, 41)],
            )
            self.expect_answer(
                collider.run(poses[0], vertices[0], next_poses=poses[1], next_vertices=vertices[1]), dumped
            )
            self.expect_answer(
                collider.run(vertices=vertices[0], next_vertices=tuple(vertices[1].values())), dumped
            )
            self.assertNotEqual(
                len(dumped[0]), collider.count(vertices=vertices[0], next_vertices=vertices[0])
            )

    def test_what_is_left_out_of_a_successor_is_at_rest(self):
        given = {"motion": "linear", "contact_rule": "none"}
        first, second = (numpy.array(points) for points, _ in self.parts)
        moved = second + [0.5, 0.25, 0]
        soft, mixed = self.collider(deformable=True, **given), self.collider(deformable=[1], **given)
        whole = soft.digest(vertices=[first + 1, moved], next_vertices=[first, moved])
        self.assertNotEqual(soft.digest(vertices=[first + 1, moved], next_vertices=[first + 1, moved]), whole)
        self.assertEqual(
            soft.digest(vertices=[first + 1, moved], next_vertices={1: moved}),
            whole,
            "not the last successor's",
        )
        poses, still = [[3, 0, 0, 1, 0, 0, 0], POSES[0]], [POSES[0]] * 2
        whole = mixed.digest(poses, [moved], next_poses=still, next_vertices=[second])
        for other in ({"next_poses": poses}, {"next_poses": still, "next_vertices": [moved]}):
            self.assertNotEqual(mixed.digest(poses, [moved], **other), whole)
            for given in ({"next_poses": still}, {"next_vertices": [second]}):
                self.assertEqual(mixed.digest(poses, [moved], **given), whole)

    def test_auto_chooses_between_two_frames(self):
        (before, after), _ = self.passing()
        given = {"motion": "linear", "contact_rule": "none"}
        right = self.collider(**given).digest(before, next_poses=after)
        self.assertGreater(right.count, 10)
        auto = [
            tandem.Collider(self.meshes, "auto", pair_capacity=65536, queue_bytes=65536, **given)
            for _ in range(2)
        ]
        self.assertGreater(len(auto[0].tune(before, seconds=0.3, next_poses=after)), 3)
        for collider in auto:
            self.assertEqual(collider.digest(before, next_poses=after), right)
            self.assertEqual(
                (collider.algorithm in tandem.algorithms(), collider.settings["motion"]), (True, "linear")
            )
        soft = tandem.Collider(
            self.meshes, "auto", deformable=True, pair_capacity=65536, queue_bytes=65536, **given
        )
        parts = tuple(points for points, _ in self.meshes)
        self.assertGreater(len(soft.tune(vertices=parts, seconds=0.3, next_vertices=parts)), 3)
