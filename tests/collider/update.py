# SPDX-License-Identifier: MIT
# test: cost=8 full=20 needs=TANDEM_BUILDS_PYTHON
"""tandem.Collider.update() gives the answers of run() for the whole frame,
and refuses changes that are wrong or have no frame."""

import numpy

from tests.collider.case import DEVICES, POSES, ColliderCase, tandem
from tests.collider.meeting import matrices

# For ColliderCase.expect_mistakes.
REFUSED = """
ValueError | poses: 2 is not the number of a body; there are 2, numbered from 0 | update({2: POSES[0]})
ValueError | poses: -1 is not the number of a body                     | update({-1: POSES[0]})
TypeError  | poses: type str; expected the number of a body            | update({"0": POSES[0]})
ValueError | poses: body 1 is deformable and has no pose               | update({1: POSES[0]})
ValueError | poses of body 0: shape (6,); expected (7,) or (4, 4)      | update({0: POSES[0][:6]})
ValueError | poses of body 0: shape (2, 7)                             | update({0: POSES})
ValueError | poses: row 0 has no rotation                              | update({0: [0] * 7})
ValueError | poses: row 0 is not finite                                | update({0: [0, numpy.nan, 0, 1, 0, 0, 0]})
ValueError | body 0 has a coordinate of 1e                             | update({0: [1e37, 0, 0, 1, 0, 0, 0]})
ValueError | poses of body 0: matrix 0 has another last row            | update({0: 2 * numpy.eye(4)})
TypeError  | poses: type list; expected a mapping {body: array}        | update(POSES)
TypeError  | vertices: type list; expected a mapping                   | update(None, [vertices])
ValueError | vertices: body 0 is not deformable                        | update(None, {0: vertices})
ValueError | rows for body 1, whose mesh has                           | update(None, {1: vertices[1:]})
ValueError | body 1: vertex 3 is not finite                            | update(None, {1: nan})
ValueError | vertices of body 1: shape (                               | update(None, {1: vertices[:, :2]})
ValueError | vertex 3 is not finite                                    | update({0: [5, 0, 0, 1, 0, 0, 0]}, {1: nan})
"""


class Update(ColliderCase):
    def setUp(self):
        self.random = numpy.random.default_rng(3)

    def poses(self, bodies):
        poses = self.random.uniform(-0.25, 0.25, size=(bodies, 7))
        poses[:, 3] = 1
        return poses

    def expect_equal(self, answer, whole):
        self.assertEqual((answer.digest(), answer.contact_digest()), (whole.digest(), whole.contact_digest()))
        self.assertEqual(answer.meeting().tolist(), whole.meeting().tolist())

    def test_equals_the_whole_frame(self):
        meshes = [self.meshes[i % 2] for i in range(5)]
        for device in DEVICES:
            for origin in ("world", "auto"):
                mine, other = (
                    self.collider(meshes, device=device, deformable=[1, 4], origin=origin) for _ in range(2)
                )
                poses, vertices = self.poses(5), {1: meshes[1][0] + 0.125, 4: meshes[4][0] * 1.25}
                first = mine.run(poses, vertices)
                self.expect_equal(first, other.run(poses, vertices))
                answers = set()
                for changed, moved in (([0], []), ([], [4]), ([3, 2], [1]), ([0, 2, 3], [4, 1]), ([], [])):
                    with self.subTest(device=device, origin=origin, changed=changed, moved=moved):
                        poses, vertices = poses.copy(), dict(vertices)
                        poses[changed] = self.poses(len(changed))
                        vertices.update(
                            {body: vertices[body] + self.random.uniform(-0.1, 0.1, size=3) for body in moved}
                        )
                        answer = mine.update(
                            {body: poses[body] for body in changed}, {body: vertices[body] for body in moved}
                        )
                        self.assertGreater(answer.contact_count, 10)
                        self.expect_equal(answer, other.run(poses, vertices))
                        answers.add(answer.contact_digest())
                self.assertEqual(len(answers), 4, "the last update changes nothing")
                self.assertGreater(len(first.meeting()), 10, "an older answer keeps its frame")

    def test_forms_of_poses(self):
        mine, whole = self.collider(), self.collider()
        mine.run()
        right = whole.run([[0, 0, 0, 1, 0, 0, 0], POSES[1]])
        matrix = matrices(POSES[1:])[0]
        for pose in (POSES[1], numpy.array(POSES[1], numpy.float64), tuple(POSES[1])):
            self.expect_equal(mine.update({1: pose}), right)
        self.assertEqual(
            mine.update({numpy.int64(1): matrix}).digest(), whole.run([numpy.eye(4), matrix]).digest()
        )
        self.assertEqual(
            mine.update({0: POSES[0], 1: matrix}).digest(), whole.run([numpy.eye(4), matrix]).digest()
        )
        self.expect_equal(mine.update({}), whole.run([numpy.eye(4), matrix]))
        self.assertEqual(mine.update({1: POSES[1]}, body_pairs=[]).count, 0)
        self.assertEqual(mine.update(body_pairs=[(1, 0)]).digest(), right.digest())
        mine.reset()
        self.expect_equal(mine.update(), right)

    def test_after_tune(self):
        tuned, whole = tandem.Collider(self.meshes, algorithm="auto"), self.collider()
        tuned.tune(POSES, seconds=0.01)
        self.assertEqual(
            tuned.update({0: [0.125, 0, 0, 1, 0, 0, 0]}).count,
            whole.count([[0.125, 0, 0, 1, 0, 0, 0], POSES[1]]),
        )

    def test_successors_start_from_the_frame(self):
        mine, other = (self.collider(deformable=[1], motion="linear", contact_rule="none") for _ in range(2))
        vertices = self.meshes[1][0]
        mine.run(POSES, [vertices], next_poses=POSES[::-1], next_vertices=[vertices + 50])
        row, shifted = [0.125, 0, 0, 1, 0, 0, 0], vertices + [0, 0.25, 0]
        for given, expected in (
            (
                {"next_vertices": {1: vertices + 9}},
                {"next_vertices": [vertices + 9], "next_poses": [row] * 2},
            ),
            ({"next_poses": {0: POSES[1]}}, {"next_vertices": [shifted], "next_poses": POSES[::-1]}),
            ({"next_poses": {}}, {"next_vertices": [shifted], "next_poses": [row] * 2}),
        ):
            answer, whole = (
                mine.update({0: row}, {1: shifted}, **given),
                other.run([row] * 2, [shifted], **expected),
            )
            self.assertGreater(whole.count, 10)
            self.assertEqual(answer.digest(), whole.digest())
        with self.assertRaisesRegex(ValueError, "motion=linear needs the frame's successor"):
            mine.update({0: row})

    def test_refused_changes_leave_the_frame(self):
        collider = self.collider(deformable=[1])
        with self.assertRaisesRegex(
            ValueError, r"^update\(\) has no frame to change; give run\(\) the first frame, of all bodies$"
        ):
            collider.update({0: POSES[0]})
        with self.assertRaises(ValueError):
            collider.run([[float("nan")] * 7] * 2)
        with self.assertRaisesRegex(ValueError, "has no frame to change"):
            collider.update()
        vertices = self.meshes[1][0] + 0.125
        right = collider.run(POSES, [vertices])
        nan = vertices.copy()
        nan[3, 1] = float("nan")
        names = {"update": collider.update, "POSES": POSES, "vertices": vertices, "nan": nan, "numpy": numpy}
        for row in filter(None, REFUSED.splitlines()):
            self.expect_mistakes(row, names)
            self.expect_equal(collider.update(), right)
        for call in (
            lambda: collider.run({0: POSES[0]}),
            lambda: tandem.Collider(self.meshes, algorithm="auto").tune({0: POSES[0]}),
        ):
            with self.assertRaisesRegex(
                TypeError, r"poses: is a mapping of some bodies, which update\(\) takes; give all bodies"
            ):
                call()

    def test_frames_of_the_device_are_refused(self):
        collider = self.collider()
        collider.run(POSES)
        collider._core.run_device_input(numpy.array(POSES), [])
        with self.assertRaisesRegex(
            ValueError,
            r"arrays of the last run were on the device; write the changes there, and give the arrays to run\(\)",
        ):
            collider.update({0: POSES[0]})
        right = collider.run(POSES)
        self.expect_equal(collider.update(), right)
