# SPDX-License-Identifier: MIT
# test: cost=6 full=20 needs=TANDEM_BUILDS_PYTHON
"""The tetrahedra that meet, among the candidate pairs of tandem.Collider,
equal the exact truth of tandem run; body pairs of the caller; poses as matrices; scenes far from the world's
origin."""

import json

import numpy

from tests.collider.case import DEVICES, POSES, ColliderCase, tandem
from tests.program import sets

TETRAHEDRON = (numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]]), numpy.array([[0, 1, 2, 3]]))
IDENTITY = [0, 0, 0, 1, 0, 0, 0]


def matrices(poses):
    """4 x 4 matrices of rows tx ty tz qw qx qy qz."""
    made = numpy.tile(numpy.eye(4), (len(poses), 1, 1))
    for matrix, (*move, w, x, y, z) in zip(made, poses):
        n = w * w + x * x + y * y + z * z
        skew = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        matrix[:3, :3] = numpy.eye(3) + 2 / n * (w * skew + skew @ skew)
        matrix[:3, 3] = move
    return made


class Meeting(ColliderCase):
    def test_equals_the_exact_truth(self):
        for device in DEVICES:
            for settings in ({"k": 6}, {"k": 18}, {"k": 6, "precision": "double"}):
                with self.subTest(device=device, **settings):
                    out = self.work / "truth.jsonl"
                    out.unlink(missing_ok=True)
                    self.output(
                        f"run {self.placed} --algorithm tiled --device {device} --truth pairs --repeat 1 --out {out}",
                        *sets({**self.small("tiled"), **settings}),
                    )
                    truth = json.loads(out.read_text().splitlines()[0])["error"]["truth"]
                    answer = self.collider(device=device, **settings).run(POSES)
                    meeting = answer.meeting()
                    self.assertEqual(
                        (meeting.dtype, meeting.shape),
                        (numpy.int32, (truth["touching"] + truth["overlapping"], 4)),
                    )
                    self.assertEqual(answer.count, truth["candidates"])
                    self.assertLess(len(meeting), answer.count, "some candidates do not meet")
                    rows = [tuple(row) for row in meeting]
                    self.assertEqual(rows, sorted(set(rows)))
                    self.assertLessEqual(set(rows), set(map(tuple, answer.pairs())))
                    self.assertLessEqual(set(map(tuple, answer.contacts().pairs)), set(rows))
        self.assertTrue(
            (self.collider().meeting(POSES) == self.collider(k=6).meeting(POSES)).all(), "independent of k"
        )

    def test_one_inside_another_touching_and_apart(self):
        """A body wholly inside another has contacts by the default rule and none by the paper's; bounds that
        overlap need not meet."""
        cells = 3
        steps = numpy.arange(cells + 1.0)
        grid = numpy.array([(x, y, z) for x in steps for y in steps for z in steps])
        corners = [((a * 4 + b) * 4 + c) for a in range(cells) for b in range(cells) for c in range(cells)]
        cube = [
            (0, 16, 20, 21),
            (0, 16, 17, 21),
            (0, 1, 17, 21),
            (0, 1, 5, 21),
            (0, 4, 5, 21),
            (0, 4, 20, 21),
        ]
        block = (
            grid,
            numpy.array(
                [[corner + offset for offset in tetrahedron] for corner in corners for tetrahedron in cube]
            ),
        )
        small = (TETRAHEDRON[0] / 4, TETRAHEDRON[1])
        inside = self.collider([block, small]).run([IDENTITY, [1.25, 1.5, 1.375, 1, 0, 0, 0]])
        self.assertGreater(len(inside.contacts().pairs), 0)
        self.assertGreater(len(inside.meeting()), 0)
        opposing = self.collider([block, small], contact_rule="opposing").run(
            [IDENTITY, [1.25, 1.5, 1.375, 1, 0, 0, 0]]
        )
        self.assertEqual((len(opposing.contacts().pairs), opposing.count), (0, inside.count))
        two = self.collider([TETRAHEDRON] * 2, k=6)
        for move, meets in (
            ([1, 0, 0], True),
            ([0.5, 0.5, 0], True),
            ([numpy.nextafter(numpy.float32(1), numpy.float32(2)), 0, 0], False),
            ([0.75, 0.75, 0], False),
        ):
            with self.subTest(move=move):
                answer = two.run([IDENTITY, [*move, 1, 0, 0, 0]])
                self.assertEqual(answer.meeting().tolist(), [[0, 0, 1, 0]] if meets else [])
        self.assertEqual(two.run([IDENTITY, [0.75, 0.75, 0, 1, 0, 0, 0]]).count, 1, "a candidate")

    def test_older_answers_keep_their_frame(self):
        collider = self.collider(deformable=[1])
        away = self.meshes[1][0] + 100
        answers = [
            collider.run(POSES[:1] * 2, [vertices])
            for vertices in (self.meshes[1][0], away, away, self.meshes[1][0] + [0.25, 0, 0])
        ]
        numbers = [len(answer.meeting()) for answer in answers]
        self.assertGreater(min(numbers[0], numbers[3]), 10)
        self.assertEqual(numbers[1:3], [0, 0])
        self.assertTrue((answers[0].meeting() == self.collider(deformable=[1]).meeting()).all())

    def test_needs_pairs_and_the_frame(self):
        with self.assertRaisesRegex(ValueError, "output=count keeps no pairs"):
            self.collider(output="count").run(POSES).meeting()
        with self.assertRaisesRegex(ValueError, "placement=exact"):
            self.collider(placement="exact").run(POSES).meeting()

    def test_frames_in_memory_of_the_device(self):
        """Read back from what the kernels had, so that arrays can be overwritten after run(). The code path
        of GPU arrays, on host arrays."""
        random = numpy.random.default_rng(11)
        for device in DEVICES:
            for settings in (
                {},
                {"precision": "double"},
                {"algorithm": "leaf_query", "builder": "sah"},
                {"motion": "linear", "contact_rule": "none"},
                {"origin": "auto"},
            ):
                with self.subTest(device=device, **settings):
                    mine, other = (self.collider(device=device, deformable=[1], **settings) for _ in range(2))
                    for dtype in (float, numpy.float32):
                        poses = numpy.array(
                            [[*random.uniform(-0.1, 0.1, 3), 1, *random.uniform(-0.2, 0.2, 3)], POSES[1]],
                            dtype,
                        )
                        vertices = (self.meshes[1][0] + random.uniform(-0.1, 0.1, 3)).astype(dtype)
                        following = (
                            ((poses, [None, vertices]), {"next_poses": poses})
                            if "motion" in settings
                            else ((), {})
                        )
                        right = other.run(
                            poses,
                            [vertices],
                            **following[1],
                            **({"next_vertices": [vertices]} if following[1] else {}),
                        ).meeting()
                        answer = tandem.Answer(
                            mine._core.run_device_input(poses, [None, vertices], *following[0])
                        )
                        poses[:] = numpy.nan
                        vertices[:] = numpy.nan
                        self.assertEqual(answer.meeting().tolist(), right.tolist())
                        self.assertLess(len(right), answer.count)
                        self.assertGreater(len(right), 5)
                    later = mine._core.run_device_input(
                        *(numpy.array(POSES), [None, self.meshes[1][0]]),
                        *((numpy.array(POSES), [None, self.meshes[1][0]]) if following[0] else ()),
                    )
                    self.assertGreater(len(later.meeting()), 10)
                    with self.assertRaisesRegex(
                        ValueError, r"overwritten by a later run; call meeting\(\) before the next run"
                    ):
                        answer.meeting()
        collider = self.collider()
        answer = tandem.Answer(collider._core.run_device_input(numpy.array(POSES), []))
        collider.reset()
        with self.assertRaises(ValueError):
            collider.run(numpy.array(POSES) + 1e38)
        far = numpy.array(POSES) + [2.0**20, 0, 0, 0, 0, 0, 0]
        collider.run(far)
        with self.assertRaisesRegex(ValueError, "overwritten by a later run"):
            answer.meeting()

    def test_meshes_with_map_coordinates(self):
        """Millions of cells from their own origin. Single precision cannot represent such vertices, but it
        represents the centred mesh."""
        far = numpy.array([6452399.0, 1872182.375, 0])
        shifted = [(points + far, tetrahedra) for points, tetrahedra in self.meshes]
        right = self.collider(precision="double").meeting(POSES[:1] * 2).tolist()
        self.assertGreater(len(right), 50)
        turned = [[0, 0, 0, 0.5, 0.5, 0.5, 0.5]] * 2
        for device in DEVICES:
            for name, meshes, poses, options in (
                ("mesh", shifted, POSES[:1] * 2, {}),
                ("mesh, turned", shifted, turned, {}),
                ("mesh, and back by the pose", shifted, [[*-far, 1, 0, 0, 0]] * 2, {}),
                ("pose", self.meshes, [[*far, 1, 0, 0, 0]] * 2, {}),
                ("deformable", shifted, None, {"deformable": True}),
            ):
                with self.subTest(device=device, far=name):
                    collider = self.collider(
                        meshes,
                        device=device,
                        origin="auto",
                        contact_rule="sat",
                        decision="recheck",
                        **options,
                    )
                    answer = collider.run(poses)
                    self.assertEqual(answer.meeting().tolist(), right)
                    self.assertEqual(
                        {tuple(pair) for pair in answer.contacts().pairs}, set(map(tuple, right))
                    )
                    if not options:
                        self.assertEqual(
                            tandem.Answer(collider._core.run_device_input(numpy.array(poses, float), []))
                            .meeting()
                            .tolist(),
                            right,
                        )
        self.assertNotEqual(
            self.collider(shifted, origin="world").meeting(POSES[:1] * 2).tolist(),
            right,
            "vertices are rounded where they are",
        )

    def test_body_pairs_of_the_caller(self):
        three = [self.meshes[0], self.meshes[1], self.meshes[0]]
        poses = [*POSES, [0.25, 0, 0, 1, 0, 0, 0]]
        for device in DEVICES:
            for broad in ("tight", "device"):
                collider = self.collider(three, device=device, broad=broad)
                whole = collider.pairs(poses)
                of = whole[:, [0, 2]]
                for body_pairs in ([(1, 0)], [(0, 1), (1, 0), (2, 1)], numpy.array([[0, 2]]), []):
                    with self.subTest(device=device, broad=broad, body_pairs=str(body_pairs)):
                        kept = {tuple(sorted(map(int, pair))) for pair in body_pairs}
                        expected = whole[[tuple(pair) in kept for pair in of.tolist()]]
                        answer = collider.run(poses, body_pairs=body_pairs)
                        self.assertEqual(answer.body_pairs, len(kept))
                        self.assertEqual(answer.pairs().tolist(), expected.tolist())
        for body_pairs, kind, words in (
            ([(0, 3)], ValueError, r"body_pairs\[0\]: expected two bodies of 3"),
            ([(0, 1, 2)], ValueError, "expected two"),
            ([(0, 0.5)], TypeError, "number of a body"),
            (5, TypeError, "body_pairs: type int"),
            ([(1, 1)], ValueError, "pair of body 1 with itself"),
        ):
            with self.assertRaisesRegex(kind, words):
                collider.run(poses, body_pairs=body_pairs)


class Poses(ColliderCase):
    def test_matrices(self):
        quarter = [
            [0, 0, 0, 1, 0, 0, 0],
            [0.5, 0.25, 0, 1, 0, 0, 1],
            [0.25, 0, 0.125, 1, 1, 1, 1],
            [0.125, 0, 0, 0, 1, 0, 0],
        ]  # exact in matrices
        meshes = [self.meshes[i % 2] for i in range(4)]
        collider = self.collider(meshes)
        right = collider.run(quarter)
        self.assertGreater(right.count, 100)
        for given in (
            matrices(quarter),
            matrices(quarter).tolist(),
            list(matrices(quarter).astype(numpy.float32)),
        ):
            self.assertEqual(collider.run(given).contact_digest(), right.contact_digest())
        self.assertEqual(collider.run(matrices(quarter)).digest(), right.digest())
        turned = matrices(POSES)
        both = self.collider(precision="double")
        points = [both.contacts(poses) for poses in (POSES, turned)]
        self.assertTrue((points[0].pairs == points[1].pairs).all())
        self.assertLess(abs(points[0].points - points[1].points).max(), 1e-14)

    def test_every_rotation_keeps_its_digits(self):
        from tandem.arrays import host_array

        random = numpy.random.default_rng(7)
        poses = random.normal(size=(2000, 7))
        poses[:, 3:] *= 10.0 ** random.integers(
            -9, 1, size=(2000, 4)
        )  # one component can be far larger than the others
        poses[:, 3:] /= numpy.linalg.norm(poses[:, 3:], axis=1, keepdims=True)
        rows = host_array(matrices(poses), "poses", 7)
        signs = numpy.sign((rows[:, 3:] * poses[:, 3:]).sum(axis=1, keepdims=True))
        self.assertLess(abs(rows[:, 3:] * signs - poses[:, 3:]).max(), 1e-15)
        self.assertTrue((rows[:, :3] == poses[:, :3]).all())

    def test_far_from_the_origin(self):
        """By default coordinates count from the middle of the first frame, not from that of the meshes."""
        shift = 2.0**20
        far = numpy.array(POSES) + [shift, 0, -shift, 0, 0, 0, 0]
        for device in DEVICES:
            with self.subTest(device=device):
                near = self.collider(device=device).run(POSES)
                collider = self.collider(device=device)
                for _ in range(2):
                    answer = collider.run(far)
                    self.assertEqual(answer.digest(), near.digest())
                    self.assertTrue((answer.contacts().depths == near.contacts().depths).all())
                    self.assertTrue(
                        (answer.contacts().points == near.contacts().points + [shift, 0, -shift]).all()
                    )
                    self.assertTrue((answer.meeting() == near.meeting()).all())
                self.assertFalse(
                    (
                        self.collider(device=device, origin="world").run(far).contacts().depths[:3]
                        == near.contacts().depths[:3]
                    ).all(),
                    "the world's origin loses digits",
                )
                collider.reset()
                self.assertEqual(
                    collider.run(POSES).contact_digest(),
                    self.collider(device=device).run(POSES).contact_digest(),
                )
                soft = self.collider(device=device, deformable=True)
                moved = [points + [shift, 0, 0] for points, _ in self.meshes]
                self.assertTrue(
                    (
                        soft.contacts(vertices=moved).depths == self.collider(device=device).contacts().depths
                    ).all()
                )
        held = self.collider()
        device_answer = tandem.Answer(held._core.run_device_input(numpy.array(far), []))
        self.assertTrue((device_answer.contacts().depths == near.contacts().depths).all())
