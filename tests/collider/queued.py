# SPDX-License-Identifier: MIT
# test: cost=3 needs=TANDEM_BUILDS_PYTHON
"""tandem.Collider.enqueue: the answers of run(), arrays over memory of the device, the flag of frames that do not
fit, and refusals. Streams and captures: device_arrays.py, and with a GPU gpu_arrays.py."""

import numpy

from tests.collider.case import DEVICES, POSES, ColliderCase, tandem


class Queued(ColliderCase):
    def test_collected_answers_are_those_of_run(self):
        for device in DEVICES:
            collider, right = self.collider(device=device), self.collider(device=device).run(POSES)
            for _ in range(3):
                answer = collider.enqueue(POSES).collect()
                self.assertEqual(answer.digest(), right.digest())
                self.assertEqual(answer.contact_digest(), right.contact_digest())
            self.assertTrue((answer.pairs() == right.pairs()).all())
            self.assertTrue((answer.contacts().points == right.contacts().points).all())
            given = collider.enqueue(POSES, body_pairs=[(1, 0)]).collect()
            self.assertEqual((given.count, given.body_pairs), (right.count, 1))
            self.assertEqual(
                self.collider(device=device, output="digest").enqueue(POSES).collect().digest(),
                right.digest(),
            )

    def test_collected_counts_are_those_of_run(self):
        flat = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.0]], [[0, 1, 2, 3]]
        solid = [[0, 0, -0.5], [1, 0, -0.5], [0, 1, -0.5], [0, 0, 0.5]], [[0, 1, 2, 3]]
        for device in DEVICES:
            collider = tandem.Collider([flat, solid, solid], device=device)
            counts = lambda answer: (answer.count, answer.contact_count, answer.degenerate)
            self.assertEqual(counts(collider.enqueue().collect()), counts(collider.run()))
            self.assertEqual(collider.run().degenerate, 2)

    def test_a_buffer_too_small_before_the_sort(self):
        """Rows that distances leave are sorted, and none are left if not all contacts fitted."""
        poses = numpy.array([[0.5 * i, 0, 0, 1, 0, 0, 0] for i in range(3)])
        tet = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]], [[0, 1, 2, 3]]
        given = {"contact_rule": "distance", "output": "distances", "order": "canonical"}
        for device in DEVICES:
            collider = tandem.Collider([tet], bodies=[0] * 3, device=device, contact_capacity=1, **given)
            queued = collider.enqueue(poses)
            self.assertIsNone(queued.collect())
            self.assertEqual(collider.run(poses).contact_count, 3)

    def test_arrays_have_the_answer_in_memory_of_the_device(self):
        for precision, kind in (("float", numpy.float32), ("double", numpy.float64)):
            collider = self.collider(device="host", precision=precision, order="canonical")
            right = collider.run(POSES)
            queued = collider.enqueue(POSES)
            flag, pairs, contacts, body_pairs, *_ = numpy.from_dlpack(queued.counts)[0]
            self.assertEqual((flag, pairs, contacts, body_pairs), (0, right.count, right.contact_count, 1))
            rows = numpy.from_dlpack(queued.pairs)
            self.assertGreaterEqual(len(rows), pairs)
            self.assertTrue((rows[:pairs] == right.pairs()).all())
            ids, values = numpy.from_dlpack(queued.contact_ids), numpy.from_dlpack(queued.contact_values)
            self.assertEqual((ids.shape[1], values.shape[1], values.dtype), (2, 8, kind))
            found = right.contacts()
            self.assertTrue((rows[ids[:contacts, 0]] == found.pairs).all())
            self.assertTrue((ids[:contacts, 1] == found.features).all())
            self.assertTrue((values[:contacts, 6] == found.depths).all())
            numpy.testing.assert_allclose(values[:contacts, :3] + queued.origin, found.points, atol=1e-6)
        counts = self.collider(device="host", output="count").enqueue(POSES)
        self.assertEqual(numpy.from_dlpack(counts.counts)[0, 1], right.count)
        self.assertEqual(numpy.from_dlpack(counts.pairs).shape, (0, 4))
        self.assertEqual(numpy.from_dlpack(counts.contact_ids).shape, (0, 2))

    def test_memory_is_the_same_for_every_frame_and_outlives_the_collider(self):
        collider = self.collider(device="host")
        first = numpy.from_dlpack(collider.enqueue(POSES).pairs)
        second = numpy.from_dlpack(collider.enqueue(POSES).pairs)
        self.assertEqual(first.ctypes.data, second.ctypes.data)
        right = collider.run(POSES)
        del collider
        self.assertEqual(set(map(tuple, first[: right.count])), set(map(tuple, right.pairs())))

    def test_a_frame_that_does_not_fit_is_flagged(self):
        for name in ("pair_capacity", "contact_capacity"):
            collider = self.collider(device="host", **{name: 1})
            queued = collider.enqueue(POSES)
            flag, pairs, *_ = numpy.from_dlpack(queued.counts)[0]
            self.assertEqual(flag, tandem.Queued.NO_ROOM)
            self.assertGreater(pairs, 1)
            self.assertIsNone(queued.collect())
            right = collider.run(POSES)
            self.assertEqual(collider.enqueue(POSES).collect().digest(), right.digest())
            with self.assertRaisesRegex(ValueError, "a later enqueue\\(\\) has overwritten"):
                queued.collect()

    def test_an_answer_that_is_overwritten_refuses(self):
        collider = self.collider(device="host")
        right = collider.run(POSES)
        answer = collider.enqueue(POSES).collect()
        collider.run(POSES)  # does not overwrite it
        self.assertTrue((answer.pairs() == right.pairs()).all())
        collider.enqueue(POSES)
        for call in (answer.pairs, answer.contacts, answer.digest, answer.contact_digest, answer.meeting):
            with self.assertRaisesRegex(ValueError, "a later enqueue\\(\\) has overwritten"):
                call()
        self.assertEqual(answer.count, right.count)

    def test_worlds(self):
        poses = numpy.array([POSES, POSES, POSES])
        poses[1, 1, 0] += 50
        collider = self.collider(device="host", worlds=3)
        right = collider.run(poses)
        queued = collider.enqueue(poses)
        self.assertTrue((queued.collect().pairs() == right.pairs()).all())
        rows = numpy.from_dlpack(queued.pairs)[: right.count]
        self.assertEqual(set(rows[:, 0] // 2), {0, 2}, "bodies are numbered through all worlds")

    def test_refusals_are_one_line(self):
        for words, options in (
            ("needs the host in every frame; choose tiled", {"algorithm": "gproximity"}),
            ("decision=exact decides some pairs on the host", {"decision": "exact"}),
            ("several devices share a frame", {"device": "host+opencl:0"}),
        ):
            with self.assertRaisesRegex(ValueError, words):
                self.collider(**options).enqueue(POSES)
        with self.assertRaisesRegex(ValueError, "no array library takes OpenCL's memory"):
            self.collider(device="opencl:0").enqueue(POSES).counts
        with self.assertRaisesRegex(ValueError, "1 rows for 2 bodies"):
            self.collider().enqueue(POSES[:1])
        with self.assertRaisesRegex(TypeError, "expected a CUDA stream or its address"):
            self.collider().enqueue(POSES, stream="main")
