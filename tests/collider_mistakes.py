#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""collider_mistakes.py PROGRAM SOURCE: typical mistakes in calls of tandem.Collider each give one clear line;
meshes of other libraries; pickling; colliders after fork; warnings where nothing can meet; signals during a
run."""

import copy
import os
import pickle
import signal
import subprocess
import sys
import threading
import types
import unittest
import warnings

import meshio
import numpy

from collider_case import DEVICES, FOLDER, POSES, ColliderCase, tandem

FORK = """
import os, signal, sys
import tandem
corner = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]], [[0, 1, 2, 3]]
device = sys.argv[1]
collider = tandem.Collider([corner, corner], device=device)
answer = collider.run()
for name, use in (("run", collider.run), ("pairs", answer.pairs), ("new", lambda: tandem.Collider([corner], device=device).run()), ("host", tandem.Collider([corner] * 2).run),
                  ("devices", tandem.devices), ("repr", lambda: repr(collider))):
    sys.stdout.flush()
    child = os.fork()
    if child == 0:
        signal.alarm(60)  # ends a child that hangs
        try:
            use()
            print(name, "ok")
        except tandem.DeviceError as error:
            print(name, error)
        sys.exit(0)  # with the destructors of all objects
    print(name, "status", os.waitpid(child, 0)[1])
print("parent", collider.count(), len(answer.pairs()))
"""


def other_mesh(points, **cells):
    """An object as of meshio or PyVista."""
    return types.SimpleNamespace(
        points=points, cells_dict={10 if name == "VTK" else name: rows for name, rows in cells.items()}
    )


class Mistakes(ColliderCase):
    def mistakes(self):
        """Words of the message, kind of exception, and the call."""
        points, tets = self.meshes[0]
        poses = numpy.array(POSES)
        collider, soft = self.collider(), self.collider(deformable=True)
        masked = numpy.ma.masked_array(poses, mask=poses > 0.5)
        turned = numpy.tile(numpy.eye(4), (2, 1, 1))

        def changed(array, place, value):
            array = array.astype(float)
            array[place] = value
            return array

        return (
            ("poses: 1 rows for 2 bodies", ValueError, lambda: collider.run(poses[:1])),
            ("poses: shape (7,); expected (n, 7) or (n, 4, 4)", ValueError, lambda: collider.run(poses[0])),
            (
                "bodies: body 1 is of mesh 2 of 2; meshes are numbered from 0",
                ValueError,
                lambda: self.collider(bodies=[0, 2]),
            ),
            (
                "poses: row 1 is not finite",
                ValueError,
                lambda: collider.run(changed(poses, (1, 0), float("nan"))),
            ),
            (
                "body 1: vertex 3 is not finite",
                ValueError,
                lambda: soft.run(vertices=[points, changed(self.meshes[1][0], (3, 1), float("nan"))]),
            ),
            (
                "body 0 has a coordinate of 1e+37",
                ValueError,
                lambda: collider.run(changed(poses, (0, 1), 1e37)),
            ),
            ("poses: row 0 has no rotation", ValueError, lambda: collider.run(changed(poses, (0, 3), 0))),
            ("meshes[0]: no tetrahedra", ValueError, lambda: self.collider([(points, tets[:0])])),
            (
                "meshes[0]: has cells of type hexahedron; give linear tetrahedra only",
                ValueError,
                lambda: self.collider([other_mesh(points, hexahedron=tets, tetra=tets)]),
            ),
            (
                "meshes[0]: has no tetrahedra among its cells (triangle); fill the surface",
                ValueError,
                lambda: self.collider([other_mesh(points, triangle=tets[:, :3])]),
            ),
            (
                "meshes[0]: tetrahedron 0 names vertex",
                ValueError,
                lambda: self.collider([(points, tets + 1000)]),
            ),
            (
                "meshes[0]: tetrahedra: type float64; expected integers",
                TypeError,
                lambda: self.collider([(points, tets.astype(float))]),
            ),
            (
                "type Trimesh has faces, not tetrahedra",
                TypeError,
                lambda: self.collider([type("Trimesh", (), {"faces": [], "vertices": []})()]),
            ),
            (
                "poses: matrix 1 scales or shears",
                ValueError,
                lambda: collider.run(turned * [[[1]], [[2]]] - changed(turned * 0, (1, 3, 3), 1)),
            ),
            ("poses: matrix 0 mirrors", ValueError, lambda: collider.run(changed(turned, (0, 2, 2), -1))),
            (
                "poses: matrix 1 has another last row than 0 0 0 1",
                ValueError,
                lambda: collider.run(changed(turned, (1, 3, 0), 5)),
            ),
            ("poses: is a masked array, whose mask would be lost", ValueError, lambda: collider.run(masked)),
            (
                "meshes[1]: vertices: is a masked array",
                ValueError,
                lambda: self.collider([(points, tets), (numpy.ma.masked_array(points), tets)]),
            ),
            (
                "no body is deformable; make the collider with deformable=True",
                ValueError,
                lambda: collider.run(vertices=[points]),
            ),
            ("vertices: 1 arrays for 2 deformable bodies", ValueError, lambda: soft.run(vertices=[points])),
            (
                "vertices: 19 rows for body 0, whose mesh has 20 vertices",
                ValueError,
                lambda: soft.run(vertices={0: points[1:]}),
            ),
            (
                "meshes: type dict; expected a list",
                TypeError,
                lambda: self.collider({"a": self.meshes[0], "b": self.meshes[1]}),
            ),
            ("bodies: type dict; expected a list", TypeError, lambda: self.collider(bodies={0: 1})),
            ("meshes: type dict; expected a list", TypeError, lambda: self.written({"a": self.meshes[0]})),
            ("unknown setting of tiled 'kk'", ValueError, lambda: self.collider(kk=8)),
            (
                "a collider owns memory of devices and cannot be pickled",
                TypeError,
                lambda: pickle.dumps(collider),
            ),
        )

    def test_each_gives_one_line(self):
        mistakes = self.mistakes()
        self.assertGreaterEqual(len(mistakes), 19)
        for words, kind, call in mistakes:
            with self.subTest(words), self.assertRaises(kind) as caught:
                call()
            text = str(caught.exception)
            self.assertIs(type(caught.exception), kind, text)
            self.assertNotIn("\n", text)
            self.assertIn(words, text)

    def test_matrices_may_differ_from_rotations_by_rounding(self):
        """By 1e-4 of a length: a scale of all axes or of one, or an angle between two axes, also after a rotation."""
        collider, turn = self.collider(), numpy.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3
        expected = collider.count(numpy.tile(numpy.eye(4), (2, 1, 1)))
        stretched = lambda by: numpy.eye(3) * (1 + by)
        one_axis = lambda by: numpy.diag([1, 1 + by, 1])
        sheared = lambda by: numpy.eye(3) + by * numpy.array([[0, 1, 0], [1, 0, 0], [0, 0, 0]])
        for deformed in (stretched, one_axis, sheared):
            for sign in (-1, 1):
                for rotation in (numpy.eye(3), turn):
                    matrices = numpy.tile(numpy.eye(4), (2, 1, 1))
                    matrices[:, :3, :3] = rotation @ deformed(sign * 0.99e-4)
                    self.assertGreater(collider.count(matrices), expected // 2)
                    matrices[1, :3, :3] = rotation @ deformed(sign * 1.01e-4)
                    with self.assertRaisesRegex(ValueError, "^poses: matrix 1 scales or shears"):
                        collider.count(matrices)

    def written(self, meshes=None, **options):
        return tandem.write_frames(
            self.work / "refused", self.meshes if meshes is None else meshes, **options
        )

    def test_no_integer_is_a_bool(self):
        """A list of bools is a mask, which no argument takes; True alone is a flag."""
        points, poses, scene = self.meshes[1][0], numpy.array(POSES), tandem.make_scene("plates")
        collider, soft, many = self.collider(), self.collider(deformable=[1]), self.collider(worlds=2)
        for truth in (True, numpy.True_):
            word = f"type {type(truth).__name__}; expected "
            for words, call in (
                ("worlds: " + word + "the number of worlds", lambda: self.collider(worlds=truth)),
                ("bodies[0]: " + word + "the number of a mesh", lambda: self.collider(bodies=[truth, False])),
                (
                    "deformable[0]: " + word + "the number of a body",
                    lambda: self.collider(deformable=[truth, False]),
                ),
                (
                    "deformable[0]: " + word + "the number of a body",
                    lambda: self.collider(deformable=[truth] * 2),
                ),
                (
                    "body_groups[0]: " + word + "the number of a group",
                    lambda: self.collider(body_groups=[[truth], [1]]),
                ),
                ("meets[1]: " + word + "the number of a group", lambda: self.collider(meets=[None, [truth]])),
                (
                    "never_meet[0]: " + word + "the number of a body",
                    lambda: self.collider(never_meet=[(0, truth)]),
                ),
                ("stream: " + word + "a CUDA stream or its address", lambda: self.collider(stream=truth)),
                (
                    "body_pairs[0]: " + word + "the number of a body",
                    lambda: collider.run(poses, body_pairs=[(0, truth)]),
                ),
                (
                    "body_pairs[0]: " + word + "the number of a world",
                    lambda: many.run(numpy.array([poses, poses]), body_pairs=[(truth, 0, 1)]),
                ),
                ("vertices: " + word + "the number of a body", lambda: soft.run(vertices={truth: points})),
                ("poses: " + word + "the number of a body", lambda: collider.update({truth: poses[0]})),
                (
                    "bodies[0]: " + word + "the number of a mesh",
                    lambda: self.written(bodies=[truth], poses=[poses[:1]]),
                ),
                (
                    "deformable[0]: " + word + "the number of a body",
                    lambda: self.written(deformable=[truth], poses=[poses], vertices=[[points]]),
                ),
                (
                    "vertices[0]: " + word + "the number of a body",
                    lambda: self.written(deformable=[1], poses=[poses], vertices=[{truth: points}]),
                ),
                ("frame: type bool; expected the number of a frame", lambda: scene.poses(True)),
                ("frame: type bool; expected the number of a frame", lambda: scene.vertices(True)),
            ):
                with self.subTest(words, kind=type(truth).__name__), self.assertRaises(TypeError) as caught:
                    call()
                self.assertIn(words, str(caught.exception))
        self.assertEqual(
            self.collider(bodies=[numpy.int64(0), numpy.array(1)]).run(POSES).digest(),
            collider.run(POSES).digest(),
        )
        self.assertEqual(self.collider(deformable=numpy.True_).arguments["deformable"], [0, 1])

    def test_masked_arrays_of_every_kind(self):
        collider, soft = self.collider(), self.collider(deformable=[1])
        for poses in (numpy.ma.masked_array(POSES), [numpy.ma.masked_array(POSES[0]), POSES[1]]):
            with self.assertRaisesRegex(ValueError, "masked"):
                collider.run(poses)
        with self.assertRaisesRegex(ValueError, "vertices of body 1: is a masked array"):
            soft.run(vertices=[numpy.ma.masked_array(self.meshes[1][0])])
        self.assertEqual(
            collider.run(numpy.array(POSES).view(numpy.recarray)).digest(),
            collider.run(POSES).digest(),
            "other subclasses are taken",
        )


class Meshes(ColliderCase):
    def test_of_other_libraries(self):
        points, tets = self.meshes[0]
        expected = self.collider().pairs(POSES)
        for first in (
            other_mesh(points, tetra=tets),
            other_mesh(points, VTK=tets, triangle=tets[:, :3], vertex=tets[:, :1]),
            [points, tets],
            self.files[0].read_bytes(),
        ):
            with self.subTest(type(first).__name__):
                self.assertTrue((self.collider([first, self.files[1]]).pairs(POSES) == expected).all())

    def test_meshio(self):
        mesh = meshio.Mesh(
            self.meshes[0][0], [("triangle", self.meshes[0][1][:, :3]), ("tetra", self.meshes[0][1])]
        )
        self.assertTrue(
            (self.collider([mesh, self.files[1]]).pairs(POSES) == self.collider().pairs(POSES)).all()
        )

    def test_names_and_pickles(self):
        mesh = tandem.make_mesh(*self.meshes[0], "part")
        self.assertEqual(
            repr(mesh),
            f"<tandem.Mesh part: {len(mesh.vertices)} vertices, {len(mesh.tetrahedra)} tetrahedra>",
        )
        for twin in (pickle.loads(pickle.dumps(mesh)), copy.deepcopy(mesh)):
            self.assertEqual(twin.name, "part")
            self.assertTrue(
                (twin.vertices == mesh.vertices).all() and (twin.tetrahedra == mesh.tetrahedra).all()
            )
        collider = self.collider(
            deformable=[1],
            body_groups=[[0], [1]],
            meets=[None, {0}],
            never_meet=[(0, 0)],
            k=12,
            device="opencl:0",
        )
        self.assertEqual(repr(collider), "<tandem.Collider: 2 bodies, tiled on opencl:0>")
        arguments = pickle.loads(pickle.dumps(collider.arguments))
        twin = tandem.Collider(self.meshes, **arguments)
        self.assertEqual(
            (twin.settings, twin.devices, twin.arguments),
            (collider.settings, collider.devices, collider.arguments),
        )
        self.assertEqual(twin.run(POSES).digest(), collider.run(POSES).digest())
        self.assertEqual(pickle.loads(pickle.dumps(collider.settings)), collider.settings)
        for function in (copy.copy, copy.deepcopy):
            with self.assertRaisesRegex(TypeError, "cannot be pickled or copied"):
                function(collider)
        self.assertRegex(
            repr(tandem.make_scene("pile:bodies=3")), "<tandem.Scene pile:.*: 3 bodies, [0-9]+ frames>"
        )


class NothingMeets(ColliderCase):
    def warned_of(self, *arguments, **options):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            tandem.Collider(*arguments or [self.meshes], **options)
        for one in caught:
            self.assertEqual(
                (one.category, os.path.basename(one.filename)), (UserWarning, "collider_mistakes.py")
            )
        return [str(one.message) for one in caught]

    def test_gives_one_warning(self):
        one = [self.meshes[0]]
        for words, arguments, options in (
            (
                "there is one body, which setting self=off does not pair with itself; choose self=on, or add a body",
                [one],
                {},
            ),
            (
                "there is one body, which setting self=deformable does not pair with itself",
                [one],
                {"self_collision": "deformable"},
            ),
            ("there is one body, which setting self=off", [one], {"worlds": 3, "deformable": True}),
            ("there is one body, which setting self=off", [one], {"algorithm": "auto"}),
            ("groups, meets and never_meet keep all bodies apart", [], {"never_meet": [(0, 1), (1, 0)]}),
            (
                "groups, meets and never_meet keep all bodies apart",
                [],
                {"body_groups": [[0], [1]], "meets": [[0], [1]], "worlds": 2},
            ),
        ):
            with self.subTest(words, **options):
                (text,) = self.warned_of(*arguments, **options)
                self.assertTrue(text.startswith("nothing can meet: " + words), text)
        for arguments, options in (
            ([one], {"self_collision": True}),
            ([one], {"self_collision": "deformable", "deformable": True}),
            ([], {}),
            ([one], {"bodies": [0, 0]}),
            ([], {"never_meet": [(0, 0)]}),
            ([], {"worlds": 2}),
        ):
            self.assertEqual(self.warned_of(*arguments, **options), [])


class Signals(ColliderCase):
    """The thread that sends signals, and the work that doubles, make no demand on the speed of the machine."""

    many = {
        "algorithm": "gproximity",
        "groups": 8,
        "local_queue": 4,
        "initial_items": 1,
        "idle_limit": 1,
        "output": "digest",
        "contact_rule": "none",
    }

    def ends(self, collider, call):
        """Whether a signal's handler ran within call(), and its exception ended the call."""
        handled, done = [], threading.Event()

        def handler(number, stack):
            if handled:
                return
            try:
                collider.reset()
            except ValueError as error:
                handled.append(str(error))
                signal.default_int_handler(number, stack)

        def send():
            while not done.wait(0.01):
                os.kill(os.getpid(), signal.SIGINT)

        before = signal.signal(signal.SIGINT, handler)
        sender = threading.Thread(target=send)
        sender.start()
        try:
            call()
        except KeyboardInterrupt:
            self.assertIn("the collider is in a run that this signal interrupts", handled[0])
            return True
        finally:
            done.set()
            sender.join()
            signal.signal(signal.SIGINT, before)
        self.assertEqual(handled, [])
        return False

    def test_end_a_run_before_its_next_launch(self):
        pairs = [(a, b) for b in range(512) for a in range(b)]
        for device in DEVICES:
            collider = self.collider(bodies=[0] * 512, device=device, **self.many)
            few = collider.run(body_pairs=pairs[:1])
            for call in (collider.run, collider.update):
                with self.subTest(device=device, call=call.__name__):
                    counts = (2**i for i in range(6, 18))
                    self.assertTrue(
                        any(self.ends(collider, lambda: call(body_pairs=pairs[:count])) for count in counts)
                    )
                    self.assertEqual(
                        collider.run(body_pairs=pairs[:1]).digest(), few.digest(), "usable afterwards"
                    )

    def test_end_tune(self):
        collider = tandem.Collider(self.meshes, algorithm="auto")
        self.assertTrue(
            any(self.ends(collider, lambda: collider.tune(POSES, seconds=2.0**i)) for i in range(-3, 4))
        )
        self.assertEqual(
            collider.run(POSES).digest(),
            tandem.Collider(self.meshes, collider.algorithm, **collider.settings).run(POSES).digest(),
        )

    def test_answers_end_while_another_thread_runs(self):
        """A run waits for the interpreter's lock, which the thread has in which an answer ends."""
        pairs = [(a, b) for b in range(512) for a in range(b)]
        collider = self.collider(bodies=[0] * 512, **self.many)
        for count in (2**i for i in range(6, 15)):
            answers = [collider.run(body_pairs=pairs[:1]) for _ in range(3)]
            runner = threading.Thread(target=collider.run, kwargs={"body_pairs": pairs[:count]})
            runner.start()
            answers.clear()
            runner.join()


class Fork(ColliderCase):
    def test_children_get_an_exception(self):
        for device in DEVICES:
            with self.subTest(device=device):
                done = subprocess.run(
                    [sys.executable, "-c", FORK, device],
                    capture_output=True,
                    text=True,
                    env={**os.environ, "PYTHONPATH": FOLDER.name},
                )
                self.assertEqual(done.returncode, 0, done.stderr)
                lines = done.stdout.splitlines()
                self.assertEqual(
                    [line for line in lines if " status " in line],
                    [f"{name} status 0" for name in ("run", "pairs", "new", "host", "devices", "repr")],
                    done.stdout,
                )
                self.assertEqual(lines[-1].split()[::2], ["parent", "1"], done.stdout)
                refused = [
                    line.split()[0]
                    for line in lines
                    if "this process was forked after its parent had opened OpenCL or CUDA" in line
                ]
                self.assertEqual(refused, [] if device == "host" else ["run", "pairs", "new", "devices"])
                self.assertLessEqual({"host ok", "repr ok"}, set(lines))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
