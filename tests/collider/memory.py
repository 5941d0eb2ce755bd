# SPDX-License-Identifier: MIT
# test: cost=9 full=20 needs=TANDEM_BUILDS_PYTHON
"""tandem.Collider shares memory where documented, checked by pointer.
Several threads may use it, and the interpreter's lock is released."""

import sys
import threading
import time
import unittest
import unittest.mock

import numpy

from tests.collider.case import DEVICES, POSES, ByDlpack, ColliderCase, address, tandem


class Memory(ColliderCase):
    def test_pairs_on_the_device_are_no_copy(self):
        collider = self.collider()
        answer = collider.run(POSES)
        given = answer.pairs(on_device=True)
        self.assertEqual(tuple(map(int, given.__dlpack_device__())), (1, 0))
        first, second = numpy.from_dlpack(given), numpy.from_dlpack(answer.pairs(on_device=True))
        self.assertEqual(address(first), address(second))
        self.assertEqual((first.dtype, first.shape), (numpy.int32, (answer.count, 4)))
        kept = first.copy()
        del collider, answer, given, second  # the remaining arrays keep the memory alive
        other = self.collider()
        for _ in range(5):
            other.pairs(POSES[::-1], on_device=True)
        self.assertTrue((first == kept).all())

    def test_pairs_on_the_device_are_sorted(self):
        far_apart = [POSES[0], [0.25, 0.125, 0, 0.98, 0.1, 0.05, 0.15]]
        for settings in ({}, {"algorithm": "chunked"}, {"pair_layout": "items"}, {"order": "canonical"}):
            with self.subTest(**settings):
                collider = self.collider(**settings)
                answers = [collider.run(poses) for poses in (POSES, far_apart, POSES)]
                before = [(answer.digest(), answer.contact_digest()) for answer in answers]
                for answer in answers:
                    self.assertGreater(answer.count, 10)
                    self.assertTrue((numpy.from_dlpack(answer.pairs(on_device=True)) == answer.pairs()).all())
                self.assertEqual([(answer.digest(), answer.contact_digest()) for answer in answers], before)
                self.assertTrue(
                    (answers[0].contacts().points == self.collider(**settings).contacts(POSES).points).all()
                )

    def test_no_pairs_are_an_empty_array(self):
        far = [POSES[0], [100, 0, 0, 1, 0, 0, 0]]
        answer = self.collider().run(far)
        self.assertEqual(
            (answer.count, answer.pairs().shape, numpy.from_dlpack(answer.pairs(on_device=True)).shape),
            (0, (0, 4), (0, 4)),
        )
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
        self.assertTrue(
            (mesh.vertices == self.meshes[0][0]).all() and (mesh.tetrahedra == self.meshes[0][1]).all()
        )
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
                    with unittest.mock.patch.object(
                        taken.Tensor, "__dlpack__", side_effect=BufferError("not by the table")
                    ):
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
        print(
            f"\n  ticks within frames of up to {1e3 * (longest[1] - longest[0]):.1f} ms: {within}",
            end="",
            file=sys.stderr,
        )
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
                if (
                    not (answer.pairs() == expected[i]).all()
                    or answer.contact_digest().count != answer.contact_count
                ):
                    wrong.append(i)

        threads = [threading.Thread(target=work, args=(first,)) for first in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])

    def test_colliders_side_by_side(self):
        """The threads also open the devices for the first time, if this test runs first."""
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
        (expected,) = {self.collider(device=device).digest(POSES) for device in DEVICES}
        self.assertEqual((len(found), set(found)), (120, {expected}))
