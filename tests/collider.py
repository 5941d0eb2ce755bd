#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""collider.py PROGRAM SOURCE: tandem.Collider of Python, as installed beside the program. Its answers equal those of
tandem run on every device, also with vertices; memory is shared where documented, checked by pointer; the
interpreter's lock is released; bad input gives one line. Prints the cost of a call next to the program's frame."""
import ast
import csv
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import unittest.mock

import numpy

from program import LONG, PROGRAM, SMALL, SOURCE, Case, bar, gmsh, sets, tandem as run_tandem

DEVICES = ("host", "opencl:0")
POSES = [[0, 0, 0, 1, 0, 0, 0], [0.125, 0, 0.0625, 0.98, 0.1, 0.05, 0.15]]


def setUpModule():
    """Installs the package into an empty folder and imports it from it."""
    global tandem, FOLDER
    FOLDER = tempfile.TemporaryDirectory(prefix="tandem-collider")
    subprocess.run(["cmake", "--install", PROGRAM.parent, "--component", "python", "--prefix", FOLDER.name], check=True, capture_output=True)
    sys.path.insert(0, FOLDER.name)
    import tandem
    assert pathlib.Path(tandem.__file__).is_relative_to(FOLDER.name)


def tearDownModule():
    FOLDER.cleanup()


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

    def collider(self, meshes=None, **options):
        return tandem.Collider(self.meshes if meshes is None else meshes, **{**self.small(options.get("algorithm", "tiled")), **options})

    def small(self, algorithm):
        """Capacities of few rows, for those that the algorithm has."""
        listed, = json.loads(run_tandem("algorithms", algorithm, "--json")[1])
        return {name: SMALL[name] for name in SMALL if name in {parameter["name"] for parameter in listed["parameters"]}}

    def dumps(self, *arguments):
        """Pairs, pairs of contacts, and points, normals and depths from a run of the program over one frame."""
        paths = self.work / "pairs.csv", self.work / "contacts.csv"
        status, text, errors = run_tandem("run", *arguments, "--no-check", "--no-count", "--dump-pairs", paths[0], "--dump-contacts", paths[1])
        self.assertEqual((status, errors), (0, []), text)
        pairs, contacts = (numpy.array(list(csv.reader(path.read_text().splitlines()))[1:], dtype=float) for path in paths)
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
        self.assertTrue((numpy.column_stack((contacts.points, contacts.normals, contacts.depths)) == values).all())
        self.assertEqual(contacts.features.shape, contacts.depths.shape)


class Answers(ColliderCase):
    def test_equal_those_of_the_program(self):
        texts = [" ".join(map(str, pose)) for pose in POSES]
        for device in DEVICES:
            for algorithm, settings in (("tiled", {}), ("chunked", {"k": 8}), ("gproximity", {"precision": "double"})):
                with self.subTest(device=device, algorithm=algorithm):
                    settings = {**self.small(algorithm), **settings}
                    dumped = self.dumps("--mesh", self.files[0], "--mesh", self.files[1], "--pose", texts[0], "--pose", texts[1], "--algorithm", algorithm,
                                        "--device", device, *sets(settings))
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

    def test_meshes_of_every_kind(self):
        expected = self.collider().pairs(POSES)
        self.assertGreater(len(expected), 10)
        for first in (str(self.files[0]), self.files[0], tandem.read_mesh(self.files[0]), tandem.make_mesh(*self.parts[0]), self.parts[0],
                      tuple(ByDlpack(array) for array in self.meshes[0])):
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
        moved = [numpy.array(points) * [1.0, 0.75, 1.25] + [0.125 * i, 0, 0] for i, (points, _) in enumerate(self.parts)]
        files = [gmsh(self.work / f"moved{i}.msh", points.tolist(), self.parts[i][1]) for i, points in enumerate(moved)]
        for device in DEVICES:
            with self.subTest(device=device):
                dumped = self.dumps("--mesh", files[0], "--mesh", files[1], "--algorithm", "tiled", "--device", device, *sets(self.small("tiled")))
                collider = self.collider(device=device, deformable=True)
                self.assertNotEqual(collider.count(), len(dumped[0]))
                self.expect_answer(collider.run(vertices=moved), dumped)
                self.expect_answer(collider.run(vertices={1: ByDlpack(moved[1]), 0: moved[0].astype(">f8")}), dumped)
                mixed = self.collider([(moved[0], self.meshes[0][1]), self.meshes[1]], device=device, deformable=[1])
                self.expect_answer(mixed.run(POSES[:1] * 2, [moved[1]]), dumped)
                self.assertEqual(mixed.run(POSES).count, self.collider([(moved[0], self.meshes[0][1]), self.meshes[1]]).count())

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
        listed = {device["id"]: {**device, "backend": backend["backend"]} for backend in json.loads(run_tandem("devices", "--json")[1])
                  for device in backend["devices"]}
        mine = tandem.devices()
        self.assertEqual([device["id"] for device in mine], list(listed))
        for device in mine:
            self.assertEqual(device, {name: listed[device["id"]][name] for name in device})
        self.assertIn("tiled", tandem.algorithms())


class Auto(ColliderCase):
    def test_keeps_the_fastest_and_names_it(self):
        collider = tandem.Collider(self.meshes, "auto", precision="double", pair_capacity=65536, contact_capacity=65536, queue_bytes=65536)
        self.assertEqual((collider.algorithm, collider.settings), ("auto", {}))
        collider.reset()
        trials = collider.tune(POSES, seconds=0.3)
        self.assertGreater(len(trials), 3)
        self.assertEqual([trial.seconds for trial in trials[:1]], [min(trial.seconds for trial in trials[:2])])
        self.assertIn(collider.algorithm, tandem.algorithms())
        self.assertEqual((collider.algorithm, collider.settings["precision"]), (trials[0].algorithm, "double"))
        for name, value in trials[0].changes.items():
            self.assertEqual(collider.settings[name], value)
        self.assertEqual(collider.digest(POSES), self.collider(precision="double").digest(POSES))
        print(f"\n  auto: {trials[0]} of {len(trials)}", end="", file=sys.stderr)

    def test_a_first_frame_chooses(self):
        soft = tandem.Collider(self.meshes, "auto", deformable=True, output="count", pair_capacity=65536, queue_bytes=65536)
        self.assertEqual(soft.count(), self.collider(deformable=True, output="count").count())
        self.assertNotEqual(soft.algorithm, "auto")

    def test_refused_settings(self):
        for words, options in (("unknown setting 'kk'", {"kk": 8}), ("k=7", {"k": 7}), ("unknown preset 'fairest'", {"preset": "fairest"})):
            with self.subTest(words), self.assertRaisesRegex(ValueError, words):
                tandem.Collider(self.meshes, "auto", **options)
        with self.assertRaisesRegex(ValueError, "tune: algorithm tiled was named; make the collider with algorithm=auto"):
            self.collider().tune(POSES)
        undecided = tandem.Collider(self.meshes, "auto")
        with self.assertRaisesRegex(ValueError, "poses: 1 rows for 2 bodies"):
            undecided.run(POSES[:1])
        self.assertEqual(undecided.algorithm, "auto")


class DeviceInput(ColliderCase):
    """The code path of GPU arrays, run on host arrays, which are in memory of device host and are copied to other
    devices."""
    def test_frames_have_the_answers_of_host_memory(self):
        moved = [numpy.array(points) * [1.0, 0.75, 1.25] + [0.125 * i, 0, 0] for i, (points, _) in enumerate(self.parts)]
        for device in DEVICES:
            with self.subTest(device=device):
                collider, soft = self.collider(device=device), self.collider(device=device, deformable=True)
                mixed = self.collider(device=device, deformable=[1])
                for dtype in (float, numpy.float32):
                    rows, points = numpy.array(POSES, dtype), [part.astype(dtype) for part in moved]
                    for mine, expected in ((collider._core.run_device_input(rows, []), collider.run(rows)), (soft._core.run_device_input(None, points), soft.run(vertices=points)),
                                       (soft._core.run_device_input(None, [None, points[1]]), soft.run(vertices={1: points[1]})),
                                       (mixed._core.run_device_input(rows, [None, points[1]]), mixed.run(rows, [points[1]]))):
                        self.assertGreater(expected.contact_count, 10)
                        self.assertEqual(mine.digest(), tuple(expected.digest()))
                        self.assertEqual(mine.contact_digest(), tuple(expected.contact_digest()))
                        self.assertTrue((mine.pairs() == expected.pairs()).all())
                    if device == "host":
                        self.assertEqual(mixed._core.addresses, [address(rows), address(points[1])])

    def test_values_out_of_range_give_the_same_error(self):
        collider, soft = self.collider(), self.collider(deformable=[1])
        for at, value in (((0, 0), numpy.inf), ((1, 3), numpy.nan), ((1, slice(3, 7)), 0), ((1, 2), -1e37)):
            rows = numpy.array(POSES)
            rows[at] = value
            messages = []
            for run in (collider.run, lambda given: collider._core.run_device_input(given, [])):
                with self.assertRaises(ValueError) as caught:
                    run(rows)
                messages.append(str(caught.exception))
            self.assertEqual(messages[0], messages[1])
        points = self.meshes[1][0].copy()
        points[3, 2] = numpy.nan
        with self.assertRaisesRegex(ValueError, "body 1: vertex 3 is not finite"):
            soft._core.run_device_input(None, [None, points])
        self.assertEqual(soft._core.run_device_input(None, [None, self.meshes[1][0]]).digest(), tuple(soft.digest()))


class Memory(ColliderCase):
    def test_pairs_on_the_device_are_no_copy(self):
        collider = self.collider()
        answer = collider.run(POSES)
        given = answer.pairs(on_device=True)
        self.assertEqual(tuple(map(int, given.__dlpack_device__())), (1, 0))
        first, second = numpy.from_dlpack(given), numpy.from_dlpack(answer.pairs(on_device=True))
        self.assertEqual(address(first), address(second))
        self.assertEqual((first.dtype, first.shape), (numpy.int32, (answer.count, 4)))
        self.assertEqual(sorted(map(tuple, first)), list(map(tuple, answer.pairs())))
        kept = first.copy()
        del collider, answer, given, second  # the remaining arrays keep the memory alive
        other = self.collider()
        for _ in range(5):
            other.pairs(POSES[::-1], on_device=True)
        self.assertTrue((first == kept).all())

    def test_no_pairs_are_an_empty_array(self):
        far = [POSES[0], [100, 0, 0, 1, 0, 0, 0]]
        answer = self.collider().run(far)
        self.assertEqual((answer.count, answer.pairs().shape, numpy.from_dlpack(answer.pairs(on_device=True)).shape), (0, (0, 4), (0, 4)))
        self.assertEqual([column.shape for column in answer.contacts()], [(0, 4), (0,), (0, 3), (0, 3), (0,)])

    def test_contacts_are_columns_of_one_array(self):
        contacts = self.collider().contacts(POSES)
        places = [address(column) for column in contacts]
        self.assertLess(max(places) - min(places), contacts.pairs.strides[0])
        self.assertEqual({column.strides[0] for column in contacts}, {contacts.pairs.strides[0]})
        self.assertFalse(any(column.flags.owndata for column in contacts))
        self.assertTrue(numpy.allclose(numpy.linalg.norm(contacts.normals, axis=1), 1, atol=1e-6))

    def test_input_is_not_copied(self):
        from tandem.arrays import host_array
        rows = numpy.array(POSES)
        self.assertIs(host_array(rows, "poses", 7), rows)
        self.assertEqual(address(host_array(ByDlpack(rows), "poses", 7)), address(rows))
        self.assertNotEqual(address(host_array(rows.astype(numpy.float32), "poses", 7)), address(rows))
        mesh = tandem.read_mesh(self.files[0])
        self.assertEqual(address(mesh.vertices), address(mesh.vertices))
        self.assertFalse(mesh.vertices.flags.writeable)
        self.assertTrue((mesh.vertices == self.meshes[0][0]).all() and (mesh.tetrahedra == self.meshes[0][1]).all())
        view = mesh.vertices
        del mesh
        self.assertTrue((view == self.meshes[0][0]).all())

    def test_an_answer_outlives_later_runs(self):
        collider = self.collider()
        answer = collider.run(POSES)
        before, digest = answer.pairs(), answer.digest()
        for step in range(4):
            collider.run([POSES[0], [0.1 * step, 0, 0, 1, 0, 0, 0]])
        self.assertTrue((answer.pairs() == before).all())
        self.assertEqual(answer.digest(), digest)

    def test_other_libraries_accept_the_pairs(self):
        answer = self.collider().run(POSES)
        for library in ("torch", "cupy", "jax"):
            try:
                taken = __import__(library)
            except ImportError:
                print(f"\n  {library} is not installed and was not tested", end="", file=sys.stderr)
                continue
            if library == "torch":
                tensor = taken.from_dlpack(answer.pairs(on_device=True))
                self.assertEqual(tensor.data_ptr(), address(numpy.from_dlpack(answer.pairs(on_device=True))))
                poses = taken.tensor(POSES, dtype=taken.float64)
                self.expect_digest(answer, poses, ByDlpack(poses), poses.repeat_interleave(2, 1)[:, ::2])
                with self.assertRaisesRegex(ValueError, "poses: __dlpack__ failed: .*grad"):
                    self.collider().run(poses.requires_grad_())
                if hasattr(taken.Tensor, "__dlpack_c_exchange_api__"):
                    with unittest.mock.patch.object(taken.Tensor, "__dlpack__", side_effect=BufferError("not by the table")):
                        self.expect_digest(answer, poses.detach())
            elif library == "jax":
                array = taken.numpy.from_dlpack(answer.pairs(on_device=True))
                self.assertEqual(sorted(map(tuple, numpy.asarray(array))), list(map(tuple, answer.pairs())))
                taken.config.update("jax_enable_x64", True)
                poses = taken.numpy.asarray(numpy.array(POSES))
                self.expect_digest(answer, poses, ByDlpack(poses))

    def expect_digest(self, answer, *poses):
        for rows in poses:
            self.assertEqual(self.collider().digest(rows), answer.digest())


class Threads(ColliderCase):
    def test_other_threads_run_during_a_call(self):
        """A frame takes so long that, with the lock held, the other thread would have to wait for it."""
        scene = tandem.make_scene("pile:bodies=200")
        collider = tandem.Collider(scene.meshes, bodies=scene.bodies, threads=1)
        poses = scene.poses(0)
        collider.run(poses)
        sys.setswitchinterval(1e-4)
        ticks, done = [], threading.Event()

        def tick():
            while not done.is_set():
                ticks.append(time.perf_counter())
                time.sleep(1e-3)
        thread = threading.Thread(target=tick)
        thread.start()
        spans = []
        for _ in range(5):
            begin = time.perf_counter()
            collider.run(poses)
            spans.append((begin, time.perf_counter()))
        done.set()
        thread.join()
        within = [sum(begin < tick < end for tick in ticks) for begin, end in spans]
        longest = max(spans, key=lambda span: span[1] - span[0])
        print(f"\n  ticks within frames of up to {1e3 * (longest[1] - longest[0]):.1f} ms: {within}", end="", file=sys.stderr)
        self.assertGreater(max(within), 3)

    def test_one_collider_from_several_threads(self):
        collider = self.collider()
        frames = [[POSES[0], [0.1 * step, 0.05, 0, 1, 0, 0, 0]] for step in range(6)]
        expected = [collider.pairs(frame) for frame in frames]
        wrong = []

        def work(first):
            for step in range(40):
                i = (first + step) % len(frames)
                answer = collider.run(frames[i])
                if not (answer.pairs() == expected[i]).all() or answer.contact_digest().count != answer.contact_count:
                    wrong.append(i)
        threads = [threading.Thread(target=work, args=(first,)) for first in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])


    def test_colliders_side_by_side(self):
        expected = self.collider().digest(POSES)
        found = []

        def work(device):
            for _ in range(3):
                collider = self.collider(device=device)
                found.extend(collider.digest(POSES) for _ in range(10))
        threads = [threading.Thread(target=work, args=(device,)) for device in DEVICES + DEVICES]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual((len(found), set(found)), (120, {expected}))


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
                (TypeError, "meshes[0]: tetrahedra: type float64; expected integers", (points, tets.astype(float))),
                (TypeError, "meshes[0]: vertices: type complex128; expected real numbers", (points.astype(complex), tets)),
                (ValueError, "meshes[0]: vertices: is not an array; give rows of equal lengths", ([[0, 0, 0], [1, 2]], tets)),
                (ValueError, "numbers from -1 to", (points, tets - 1)),
                (ValueError, "meshes[0]: tetrahedron 0 names vertex", (points, tets + 1000)),
                (ValueError, "meshes[0]: vertex 2 is not finite", (nan, tets)),
                (ValueError, "meshes[0]: no tetrahedra", (points, tets[:0])),
                (ValueError, "nowhere.msh: No such file or directory", "nowhere.msh"),
                (ValueError, "is in CUDA's memory; copy it to the host's memory (.cpu() or .get())", (OnDevice(), tets)),
                (TypeError, "meshes[0]: type int; expected a tandem.Mesh, a path or (vertices, tetrahedra)", 7)):
            with self.subTest(words):
                self.expect(kind, words, tandem.Collider, [mesh, self.files[1]])
        self.expect(TypeError, "meshes: type str; expected a list", tandem.Collider, "a.msh")
        self.expect(ValueError, "has no bodies", tandem.Collider, [])
        self.expect(ValueError, "bodies: body 1 is of mesh 5 of 2", tandem.Collider, self.meshes, bodies=[0, 5])
        self.expect(ValueError, "bodies[0]: -1 is not the number of a mesh", tandem.Collider, self.meshes, bodies=[-1])
        self.expect(TypeError, "bodies[0]: type float", tandem.Collider, self.meshes, bodies=[0.5])
        self.expect(ValueError, "deformable[0]: 2 is not the number of a body; there are 2", tandem.Collider, self.meshes, deformable=[2])
        self.expect(ValueError, "broken.msh", tandem.read_mesh, gmsh(self.work / "broken.msh", [(0, 0, 0)] * 3, [[0, 1, 2, 9]]))

    def test_errors_of_settings_equal_the_programs(self):
        for words, options in (("unknown setting of tiled 'kk'", {"kk": 8}), ("unknown algorithm 'tild'", {"algorithm": "tild"}),
                               ("unknown device 'hst'", {"device": "hst"}), ("k=7", {"k": 7}), ("rounding=directed is impossible on host", {"rounding": "directed"}),
                               ("unknown preset of tiled 'fairest'", {"preset": "fairest"}), ("named twice", {"device": "host+host"}), ("device=all", {"device": "all"})):
            with self.subTest(words):
                self.expect(ValueError, words, tandem.Collider, self.meshes, **options)
        self.expect(TypeError, "setting k: type float; expected a word or an integer", tandem.Collider, self.meshes, k=8.0)
        self.expect(TypeError, "device: type int; expected a name", tandem.Collider, self.meshes, device=0)
        for options, words in (({"k": 7}, ("--set", "k=7")), ({"device": "cuda:9"}, ("--device", "cuda:9")), ({"rounding": "directed"}, ("--set", "rounding=directed"))):
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
                (ValueError, "poses: shape (2, 6); expected (n, 7)", poses[:, :6]), (ValueError, "poses: shape (7,); expected (n, 7)", poses[0]),
                (ValueError, "poses: 1 rows for 2 bodies", poses[:1]), (TypeError, "poses: type bool", poses > 0), (TypeError, "poses: type <U", [["identity"] * 7] * 2),
                (TypeError, "poses: type object", [[None] * 7] * 2), (ValueError, "poses: row 1 has no rotation", poses * [[1], [0]]),
                (ValueError, "poses: row 0 is not finite", poses + [float("inf"), 0, 0, 0, 0, 0, 0]),
                (ValueError, "poses: row 0 has no rotation", poses + [0, 0, 0, float("nan"), 0, 0, 0]),
                (ValueError, "precision=float takes at most 1e+36", poses + [1e37, 0, 0, 0, 0, 0, 0]), (ValueError, "is in CUDA's memory", OnDevice())):
            with self.subTest(words):
                self.expect(kind, words, collider.pairs, value)
        bad = points.copy()
        bad[3, 2] = float("nan")
        for kind, words, value in (
                (ValueError, "vertices: 2 arrays for 1 deformable bodies", [points, points]), (ValueError, "vertices: 0 is not a deformable body (those are: 1)", {0: points}),
                (ValueError, "vertices of body 1: shape (16, 2)", [points[:, :2]]), (ValueError, "vertices: 15 rows for body 1, whose mesh has 16 vertices", [points[1:]]),
                (ValueError, "body 1: vertex 3 is not finite", [bad]), (TypeError, "vertices of body 1: type complex128", [points.astype(complex)]),
                (TypeError, "vertices: type int; expected a list", 5)):
            with self.subTest(words):
                self.expect(kind, words, soft.pairs, vertices=value)
        self.expect(ValueError, "no body is deformable; make the collider with deformable=True", collider.pairs, vertices=[points])
        self.assertTrue((collider.pairs(POSES) == self.collider().pairs(POSES)).all(), "goes on after bad input")

    def test_answers_that_were_not_stored(self):
        counted = self.collider(output="count").run(POSES)
        self.assertEqual(counted.count, self.collider().count(POSES))
        for ask in (counted.pairs, counted.contacts, lambda: counted.pairs(on_device=True)):
            self.expect(ValueError, "output=count keeps no pairs", ask)
        self.expect(ValueError, "contact_rule=none makes no contacts", self.collider(contact_rule="none").run(POSES).contacts)
        self.expect(ValueError, "no array library takes OpenCL's memory by DLPack", self.collider(device="opencl:0").run(POSES).pairs, on_device=True)
        self.expect(tandem.DeviceError, "host: the pairs are in 2 parts", self.collider(device="host+opencl:0").run(POSES).pairs, on_device=True)

    def test_failures_of_devices(self):
        self.assertTrue(issubclass(tandem.DeviceError, RuntimeError) and issubclass(tandem.OutOfMemory, tandem.DeviceError))
        self.expect(tandem.OutOfMemory, "bytes", tandem.Collider, self.meshes, **{**self.small("gproximity"), "algorithm": "gproximity", "queue_bytes": 1 << 39})


class Example(ColliderCase):
    def example(self, *arguments, code=0, script="collide.py"):
        done = subprocess.run([sys.executable, SOURCE / "scripts/examples" / script, *map(str, arguments)], cwd=self.work, capture_output=True, text=True,
                              env={**os.environ, "PYTHONPATH": FOLDER.name})
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1 if code else 0, done.stderr)
        return done.stdout + done.stderr

    def test_draws_contacts(self):
        self.assertRegex(self.example(), r"\d{2,} contacts")
        self.assertGreater((self.work / "collide.png").stat().st_size, 10000)
        self.example(*self.files, "--shift", "0.125,0,0.0625", "-o", "other.png")
        self.assertTrue((self.work / "other.png").exists())
        self.assertIn("no contacts to draw", self.example(*self.files, "--shift", "99,0,0"))
        for arguments in ((self.files[0],), (self.files[0], "nowhere.msh"), ("--shift", "1,x"), ("--device", "hst")):
            self.assertTrue(self.example(*arguments, code=2).startswith("collide.py: "))


    def test_the_cost_of_a_call_is_printed(self):
        text = self.example("plates:count=2", "--frames", "60:61", "--rounds", 1, "--arrays", "all", script="call_cost.py")
        self.assertRegex(text, r"arrays of numpy, 2 frames, 1 rounds: call [\d.]+ us, library's frame [\d.]+ us, overhead [\d.]+ us; conversion of pairs")
        self.assertRegex(text, r"3 arrays, called from Python: __dlpack_device__ [\d.]+ us, __dlpack__ [\d.]+ us; without DLPack's table")
        self.assertTrue(self.example("plates", "--frames", "60", code=2, script="call_cost.py").startswith("call_cost.py: "))


class Package(unittest.TestCase):
    def test_without_the_compiled_part(self):
        """Records are readable without it; missing names explain how to get them."""
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(SOURCE / "python/tandem", pathlib.Path(folder) / "tandem", ignore=shutil.ignore_patterns("__pycache__"))
            code = ("import tandem\nfrom tandem import *\nassert read and 'Collider' not in tandem.__all__\n"
                    "for name in ('Collider', 'devices'):\n    try: getattr(tandem, name)\n    except ImportError as error: print(error)\n")
            done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=folder, env={**os.environ, "PYTHONPATH": folder})
        self.assertEqual(done.stderr, "")
        self.assertEqual([line.partition(" needs the compiled part")[0] for line in done.stdout.splitlines()], ["tandem.Collider", "tandem.devices"])
        self.assertIn("pip install .", done.stdout)

    def test_importing_loads_only_what_is_needed(self):
        code = "import sys, tandem; tandem.Collider; assert 'pandas' not in sys.modules and 'matplotlib' not in sys.modules"
        subprocess.run([sys.executable, "-c", code], check=True, env={**os.environ, "PYTHONPATH": FOLDER.name})

    def test_stubs_name_everything(self):
        from tandem import _core
        stub = ast.parse((SOURCE / "python/tandem/_core.pyi").read_text())
        named = {}
        for node in stub.body:
            if isinstance(node, ast.ClassDef):
                named[node.name] = {inner.name for inner in node.body if isinstance(inner, ast.FunctionDef) and not inner.name.startswith("_")}
            elif isinstance(node, ast.FunctionDef):
                named[node.name] = set()
        exported = {name: {inner for inner in vars(value) if not inner.startswith("_")} if isinstance(value, type) else set()
                 for name, value in vars(_core).items() if not name.startswith("_")}
        self.assertEqual(named, exported)
        self.assertTrue((SOURCE / "python/tandem/py.typed").exists())
        for name in tandem.__all__:
            self.assertTrue(getattr(tandem, name).__doc__, name)

    def test_the_cost_of_a_call(self):
        """Printed, not checked: times on a busy machine mean nothing."""
        name, last, rounds = ("plates", 69, 5) if LONG else ("plates:count=2", 62, 2)
        scene = tandem.make_scene(name)
        for device in DEVICES:
            collider = tandem.Collider(scene.meshes, device=device, bodies=scene.bodies, deformable=True)
            frames = [scene.vertices(i) for i in range(60, last + 1)]
            whole, within = min(self.replay(collider, frames) for _ in range(rounds))
            out = pathlib.Path(FOLDER.name) / f"cost-{device}.jsonl"
            status, text, errors = run_tandem("run", name, "--frames", f"60:{last}", "--algorithm", "tiled", "--device", device, "--repeat", rounds, "--no-check",
                                              "--no-count", "--out", out)
            self.assertEqual((status, errors), (0, []), text)
            program = min(json.loads(out.read_text().splitlines()[0])["total_ns"]["samples"]) / len(frames)
            print(f"\n  {name} on {device}, us a frame: {1e6 * whole:.0f} by Collider.run, of which {1e6 * (whole - within):.1f} are the call's; "
                  f"{program * 1e-3:.0f} by tandem run", end="", file=sys.stderr)

    @staticmethod
    def replay(collider, frames):
        """Seconds per frame, of the calls and within the library."""
        begin, within = time.perf_counter(), 0.0
        for frame in frames:
            within += collider.run(vertices=frame).seconds
        return (time.perf_counter() - begin) / len(frames), within / len(frames)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
