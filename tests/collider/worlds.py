# SPDX-License-Identifier: MIT
# test: cost=8 full=20 needs=TANDEM_BUILDS_PYTHON
"""One run of several worlds gives the answers of as many runs of one world
each, on every device, with filters, deformable bodies, updates and arrays of the device; wrong shapes and
numbers give one clear line."""

import pickle
import subprocess
import sys

import numpy

from tests.collider.case import DEVICES, FOLDER, ColliderCase, tandem
from tests.collider.meeting import matrices
from tests.program import LONG

# For ColliderCase.expect_mistakes.
MISTAKES = """
ValueError | poses: shape (2, 2, 7); expected (3, 2, 7) or (3, 2, 4, 4)  | together.run(poses[:2])
ValueError | poses: shape (6, 7); expected (3, 2, 7)                     | together.run(poses.reshape(6, 7))
TypeError  | poses: is a mapping of some bodies                          | together.run({0: poses[0, 0]})
ValueError | vertices of body 0: shape (2, 20, 3); expected (3, n, 3)    | soft.run(vertices=[points[0][:2], points[1]])
ValueError | vertices: 1 arrays for 2 deformable bodies                  | soft.run(vertices=points[:1])
TypeError  | poses: 1; expected (world, body)                            | together.update({1: poses[0, 0]})
ValueError | poses: 3 is not the number of a world; there are 3          | together.update({(3, 0): poses[0, 0]})
ValueError | poses: 2 is not the number of a body; there are 2           | together.update({(0, 2): poses[0, 0]})
ValueError | poses of body 1 of world 2: shape (6,)                      | together.update({(2, 1): poses[0, 0, :6]})
ValueError | body_pairs[0]: 2 numbers; expected (world, body, body)      | together.run(poses, body_pairs=[(0, 1)])
ValueError | body_pairs[0]: 2 is not the number of a body                | together.run(poses, body_pairs=[(0, 1, 2)])
ValueError | worlds: 0 with 2 bodies each; give 1 or more                | make(worlds=0)
TypeError  | worlds: type str; expected the number                       | make(worlds="3")
ValueError | worlds: -1 with 2 bodies each; give 1 or more               | make(worlds=-1)
"""


class Worlds(ColliderCase):
    def setUp(self):
        self.random = numpy.random.default_rng(5)

    def poses(self, worlds, bodies):
        poses = self.random.uniform(-0.3, 0.3, size=(worlds, bodies, 7))
        poses[..., 3] = 1
        return poses

    def expect_worlds(self, answer, alone):
        """Compares an answer with those of the worlds alone, which are made one after another."""
        rows, meeting, contacts = [], [], []
        for world, one in enumerate(alone):
            kept = one.contacts()
            for all_rows, mine in (
                (rows, one.pairs()),
                (meeting, one.meeting()),
                (
                    contacts,
                    numpy.column_stack((kept.pairs, kept.features, kept.points, kept.normals, kept.depths)),
                ),
            ):
                all_rows.append(numpy.column_stack((numpy.full(len(mine), world), mine)))
        found = answer.contacts()
        self.assertEqual(answer.pairs().dtype, numpy.int32)
        self.assertEqual(answer.pairs().tolist(), numpy.concatenate(rows).tolist())
        self.assertEqual(answer.meeting().tolist(), numpy.concatenate(meeting).tolist())
        self.assertEqual(
            numpy.column_stack(
                (found.pairs, found.features, found.points, found.normals, found.depths)
            ).tolist(),
            numpy.concatenate(contacts).tolist(),
        )
        self.assertEqual((answer.count, answer.contact_count), (sum(map(len, rows)), sum(map(len, contacts))))
        self.assertGreater(min(map(len, contacts)), 10, "every world has contacts")

    def test_equals_runs_of_one_world_each(self):
        meshes, worlds = [self.meshes[i % 2] for i in range(4)], 3
        for device in DEVICES:
            for named in (
                {},
                {"broad": "device"},
                {"algorithm": "leaf_query"},
                {"algorithm": "chunked"},
                {
                    "never_meet": [(0, 1)],
                    "body_groups": [[0], [1], [0], [1]],
                    "meets": [None, None, [0], None],
                },
            ):
                with self.subTest(device=device, **named):
                    poses = self.poses(worlds, 4)
                    alone = self.collider(meshes, device=device, **named)
                    together = self.collider(meshes, device=device, worlds=worlds, **named)
                    self.expect_worlds(together.run(poses), (alone.run(rows) for rows in poses))
                    # Worlds in one place must not meet each other.
                    same = numpy.repeat(poses[:1], worlds, axis=0)
                    self.expect_worlds(together.run(same), (alone.run(poses[0]) for _ in same))
                    turned = numpy.stack([matrices(rows) for rows in poses])
                    self.assertEqual(together.count(turned), sum(alone.count(rows) for rows in turned))
                    self.assertEqual(together.count(), worlds * alone.count())

    def test_a_ladder_of_worlds(self):
        """Numbers of worlds at which tiles of bodies and groups turn, with pairs of one body and with
        filters, by every algorithm: each world has the pairs of one alone."""
        poses = self.poses(1, 3)
        powers = (1, 2, 4, 8, 16, 32, 64, 128, *((256, 512, 1000) if LONG else ()))
        between = [round(factor * power) for power in powers for factor in (1.2, 1.44, 1.7)]
        sizes = sorted({power + more for power in powers for more in (-1, 0, 1)}.union(between) - {0})
        for named in ({"self_collision": True}, {"body_groups": [[0], [1], [0]], "meets": [[1], None, [1]]}):
            meshes = [self.meshes[1], self.meshes[0], self.meshes[1]]
            alone = self.collider(meshes, contact_rule="none", **named).run(poses[0]).pairs()
            self.assertGreater(len(alone), 10)
            for number, worlds in enumerate(sizes):
                algorithm = ("tiled", "chunked", "gproximity", "leaf_query")[number % 4]
                for name in ("tiled", "chunked", "gproximity", "leaf_query") if LONG else (algorithm,):
                    with self.subTest(algorithm=name, worlds=worlds, **named):
                        rows = (
                            self.collider(meshes, algorithm=name, worlds=worlds, contact_rule="none", **named)
                            .run(numpy.repeat(poses, worlds, axis=0))
                            .pairs()
                        )
                        right = numpy.column_stack(
                            (numpy.repeat(numpy.arange(worlds), len(alone)), numpy.tile(alone, (worlds, 1)))
                        )
                        self.assertTrue(numpy.array_equal(rows, right))

    def test_deformable_bodies_and_updates(self):
        for device in DEVICES:
            for self_collision in (False, "deformable"):
                with self.subTest(device=device, self_collision=self_collision):
                    named = {"device": device, "deformable": [1], "self_collision": self_collision}
                    alone, together = self.collider(**named), self.collider(worlds=3, **named)
                    poses = self.poses(3, 2)
                    vertices = self.meshes[1][0] + self.random.uniform(-0.1, 0.1, size=(3, 1, 3))
                    for form in ([vertices], {1: vertices}, [vertices.tolist()]):
                        self.expect_worlds(
                            together.run(poses, form), (alone.run(poses[i], [vertices[i]]) for i in range(3))
                        )
                    poses[2, 0, :3] = 0.125
                    vertices[0] *= 1.125
                    self.expect_worlds(
                        together.update({(2, 0): poses[2, 0]}, {(0, 1): vertices[0]}),
                        (alone.run(poses[i], [vertices[i]]) for i in range(3)),
                    )

    def test_other_forms(self):
        poses = self.poses(3, 2)
        alone, together = self.collider(), self.collider(worlds=3)
        part = together.run(poses, body_pairs=[(2, 1, 0), (0, 0, 1), (2, 0, 1)])
        whole = together.run(poses).pairs()
        self.assertEqual(part.pairs().tolist(), whole[whole[:, 0] != 1].tolist())
        device_rows = numpy.from_dlpack(together.run(poses).pairs(on_device=True))
        self.assertEqual(
            device_rows.tolist(),
            numpy.column_stack(
                (whole[:, 0] * 2 + whole[:, 1], whole[:, 2], whole[:, 0] * 2 + whole[:, 3], whole[:, 4])
            ).tolist(),
        )
        self.assertEqual(repr(together), "<tandem.Collider: 3 worlds of 2 bodies, tiled on host>")
        twin = tandem.Collider(self.meshes, **pickle.loads(pickle.dumps(together.arguments)))
        self.assertEqual(twin.run(poses).digest(), together.run(poses).digest())
        one = self.collider(worlds=1)
        self.assertEqual(one.pairs(poses[:1])[:, 1:].tolist(), alone.pairs(poses[0]).tolist())
        tuned = tandem.Collider(self.meshes, algorithm="auto", worlds=3)
        tuned.tune(poses, seconds=0.01)
        self.assertEqual(tuned.pairs(poses).tolist(), whole.tolist())
        swept = {"motion": "linear", "contact_rule": "none"}
        later = self.poses(3, 2)
        self.assertEqual(
            self.collider(worlds=3, **swept).count(poses, next_poses=later),
            sum(self.collider(**swept).count(poses[i], next_poses=later[i]) for i in range(3)),
        )

    def test_arrays_of_the_device(self):
        """The code path of GPU arrays, on host arrays."""
        poses = self.poses(3, 2)
        for device in DEVICES:
            for named in ({}, {"motion": "linear", "contact_rule": "none"}):
                together = self.collider(device=device, worlds=3, **named)
                given = {} if not named else {"next_poses": self.poses(3, 2)}
                mine = together._core.run_device_input(
                    poses.reshape(6, 7), [], *(rows.reshape(6, 7) for rows in given.values())
                )
                self.assertEqual(mine.digest(), tuple(together.digest(poses, **given)))
                wrong = poses.reshape(6, 7).copy()
                wrong[4, 1] = float("nan")
                with self.assertRaisesRegex(ValueError, "poses: row 4 is not finite"):
                    together._core.run_device_input(
                        wrong, [], *(rows.reshape(6, 7) for rows in given.values())
                    )

    def test_more_worlds_than_memory(self):
        """One line in little time, instead of an end by the system."""
        code = """
import resource
import tandem
corner = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]], [[0, 1, 2, 3]]
resource.setrlimit(resource.RLIMIT_AS, (1 << 33, 1 << 33))
try:
    tandem.Collider([corner, corner], worlds=100_000_000)
except ValueError as error:
    print(error)
"""
        done = subprocess.run([sys.executable, "-c", code], cwd=FOLDER.name, capture_output=True, text=True)
        self.assertEqual(done.stderr, "")
        self.assertRegex(
            done.stdout, r"^200000000 bodies take at least 51.20 GB, and \S+ GB are free; use fewer "
        )

    def test_mistakes(self):
        poses = self.poses(3, 2)
        together, soft = self.collider(worlds=3), self.collider(worlds=3, deformable=True)
        together.run(poses)
        points = [numpy.repeat(vertices[None], 3, axis=0) for vertices, _ in self.meshes]
        names = {"together": together, "soft": soft, "poses": poses, "points": points, "make": self.collider}
        self.expect_mistakes(MISTAKES, names)
