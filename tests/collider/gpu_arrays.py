#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""gpu_arrays.py LIBRARY [DEVICE]: tandem.Collider with arrays of cupy, torch or jax on a CUDA device
(cuda:0). Frames are not copied and have bit for bit the answers of NumPy arrays, after the library's enqueued
work. Work follows the library's stream, pairs stay on the device, and errors equal those for host memory. For
a machine with a GPU: scripts/gpu/run python."""

import sys
import unittest
import unittest.mock

import numpy

import tandem

if len(sys.argv) not in (2, 3) or sys.argv[1] not in ("cupy", "torch", "jax"):
    sys.exit(__doc__)
LIBRARY, DEVICE = sys.argv[1], (sys.argv[2:] or ["cuda:0"])[0]
SIDE = 4096  # size of the matrices whose products keep the GPU busy for tens of milliseconds


class Cupy:
    """The interface of the tests to a library."""

    def __init__(self):
        import cupy

        self.module = cupy

    def array(self, values, dtype=numpy.float64):
        return self.module.asarray(numpy.asarray(values, dtype))

    def empty_like(self, array):
        return self.module.zeros_like(array)

    def address(self, array):
        return array.data.ptr

    def host(self, array):
        return self.module.asnumpy(array)

    def taken(self, given):
        return self.module.from_dlpack(given)

    def matrix(self):
        return self.module.ones((SIDE, SIDE), self.module.float32)

    def written_late(self, target, values, matrix, products=60):
        """`target`, which gets `values` after much other work of the GPU; and whether it had them already when this
        returned."""
        for _ in range(products):
            matrix = matrix @ matrix * numpy.float32(1 / SIDE)
        target[...] = values + 0 * matrix[0, 0].astype(target.dtype)
        event = self.module.cuda.Event()
        event.record()
        return target, event.done

    def stream(self):
        return self.module.cuda.Stream(non_blocking=True)

    def on(self, stream):
        return stream

    def stream_address(self, stream):
        return stream.ptr

    def finish(self):
        self.module.cuda.Device().synchronize()

    def captured(self, stream, work):
        """`work` as a graph: a function that replays it in `stream`."""
        with stream:
            stream.begin_capture()
            work()
            graph = stream.end_capture()
        return lambda: graph.launch(stream)

    def written(self, target, values):
        target[...] = values


class Torch(Cupy):
    def __init__(self):
        import torch

        self.module = torch

    def array(self, values, dtype=numpy.float64):
        return self.module.from_numpy(numpy.array(values, dtype)).cuda()

    def address(self, array):
        return array.data_ptr()

    def host(self, array):
        return array.cpu().numpy()

    def matrix(self):
        return self.module.ones((SIDE, SIDE), dtype=self.module.float32, device="cuda")

    def written_late(self, target, values, matrix, products=60):
        for _ in range(products):
            matrix = matrix @ matrix * (1 / SIDE)
        target.copy_(values + 0 * matrix[0, 0].to(target.dtype))
        event = self.module.cuda.Event()
        event.record()
        return target, event.query()

    def stream(self):
        return self.module.cuda.Stream()

    def on(self, stream):
        return self.module.cuda.stream(stream)

    def stream_address(self, stream):
        return stream.cuda_stream

    def finish(self):
        self.module.cuda.synchronize()

    def captured(self, stream, work):
        graph = self.module.cuda.CUDAGraph()
        with self.module.cuda.graph(graph, stream=stream):
            work()
        return graph.replay

    def written(self, target, values):
        target.copy_(values)


class Jax(Cupy):
    def __init__(self):
        import jax

        jax.config.update("jax_enable_x64", True)
        self.module = jax

    def array(self, values, dtype=numpy.float64):
        return self.module.block_until_ready(self.module.numpy.asarray(numpy.asarray(values, dtype)))

    def address(self, array):
        return array.unsafe_buffer_pointer()

    def empty_like(self, array):
        return self.module.numpy.zeros_like(array)

    def host(self, array):
        return numpy.asarray(array)

    def taken(self, given):
        return self.module.dlpack.from_dlpack(given)

    def matrix(self):
        return self.module.numpy.ones((SIDE, SIDE), numpy.float32)

    def written_late(self, target, values, matrix, products=60):
        """A new array, because arrays of JAX never change."""
        for _ in range(products):
            matrix = matrix @ matrix * numpy.float32(1 / SIDE)
        late = values + 0 * matrix[0, 0].astype(values.dtype)
        return late, late.is_ready()

    def stream(self):
        raise unittest.SkipTest("jax has no streams of its users'")

    def finish(self):
        self.module.block_until_ready(self.module.numpy.zeros(1) + 1)


def setUpModule():
    global ON
    ON = {"cupy": Cupy, "torch": Torch, "jax": Jax}[LIBRARY]()
    print(
        f"{LIBRARY} {ON.module.__version__}, {DEVICE}: {next(d['name'] for d in tandem.devices() if d['id'] == DEVICE)}",
        file=sys.stderr,
    )


class InterfaceAlone:
    """An array with __cuda_array_interface__ only."""

    def __init__(self, array):
        self.__cuda_array_interface__ = array.__cuda_array_interface__
        self.kept = array


class DlpackAlone:
    """An array with DLPack's methods only."""

    def __init__(self, array):
        self.__dlpack__, self.__dlpack_device__ = array.__dlpack__, array.__dlpack_device__


class Arrays(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.plates, cls.pile = tandem.make_scene("plates"), tandem.make_scene("pile:bodies=64,frames=3")
        cls.soft = cls.collider(cls.plates)
        cls.rigid = cls.collider(cls.pile)

    @staticmethod
    def collider(scene, **options):
        return tandem.Collider(
            scene.meshes, device=DEVICE, bodies=scene.bodies, deformable=scene.deformable, **options
        )

    def expect_same(self, result, expected):
        self.assertGreater(expected.count, 100)
        self.assertEqual((result.count, result.contact_count), (expected.count, expected.contact_count))
        self.assertEqual(
            (result.digest(), result.contact_digest()), (expected.digest(), expected.contact_digest())
        )
        self.assertTrue((result.pairs() == expected.pairs()).all())

    def test_poses_are_not_copied(self):
        for dtype in (numpy.float64, numpy.float32):
            for frame in (0, 1, 0, 1, 0, 1):  # one submission from the third time on
                rows = self.pile.poses(frame % self.pile.frame_count).astype(dtype)
                poses = ON.array(rows, dtype)
                answer = self.rigid.run(poses)
                self.assertEqual(self.rigid._core.addresses, [ON.address(poses)])
                self.expect_same(answer, self.rigid.run(rows))

    def test_vertices_are_not_copied(self):
        buffers = None
        for frame in (60, 61, 62, 63):
            rows = self.plates.vertices(frame)
            moved = {body: ON.array(points) for body, points in rows.items()}
            answer = self.soft.run(vertices=moved)
            self.assertEqual(self.soft._core.addresses, [0, *map(ON.address, moved.values())])
            self.expect_same(answer, self.soft.run(vertices=rows))
            mixed = self.soft.run(
                vertices={body: moved[body] if body % 2 else points for body, points in rows.items()}
            )
            self.expect_same(mixed, answer)
            buffers = moved
        for _ in range(5):  # the same commands again
            self.expect_same(self.soft.run(vertices=buffers), answer)

    def test_arrays_by_the_cuda_array_interface(self):
        poses = ON.array(self.pile.poses(0))
        if not hasattr(poses, "__cuda_array_interface__"):
            self.skipTest(f"{LIBRARY} has none")
        self.expect_same(self.rigid.run(InterfaceAlone(poses)), self.rigid.run(self.pile.poses(0)))
        self.assertEqual(self.rigid._core.addresses, [ON.address(poses)])

    def test_arrays_by_dlpacks_methods(self):
        poses = ON.array(self.pile.poses(0))
        self.expect_same(self.rigid.run(DlpackAlone(poses)), self.rigid.run(self.pile.poses(0)))
        self.assertEqual(self.rigid._core.addresses, [ON.address(poses)])

    def test_arrays_by_dlpacks_table(self):
        poses = ON.array(self.pile.poses(0))
        if not hasattr(type(poses), "__dlpack_c_exchange_api__"):
            self.skipTest(f"{LIBRARY} has none")
        with unittest.mock.patch.object(
            type(poses), "__dlpack__", side_effect=BufferError("not by the table")
        ):
            self.expect_same(self.rigid.run(poses), self.rigid.run(self.pile.poses(0)))

    def test_frames_wait_for_their_enqueued_work(self):
        """The library's stream is busy when the collider is called, and writes the frame afterwards."""
        self.expect_frames_after(lambda array: array)

    def test_frames_wait_with_dlpacks_methods(self):
        self.expect_frames_after(DlpackAlone)

    def test_frames_wait_for_another_stream_of_the_library(self):
        with ON.on(ON.stream()):
            self.expect_frames_after(lambda array: array)

    def expect_frames_after(self, given):
        expected = self.soft.run(vertices=self.plates.vertices(64))
        values = {body: ON.array(points) for body, points in self.plates.vertices(64).items()}
        targets = {body: ON.empty_like(array) for body, array in values.items()}
        matrix = ON.matrix()
        ON.written_late(targets[0], values[0], matrix, 2)  # compiles
        late = False
        for _ in range(3):
            ON.finish()
            body = next(iter(targets))
            if LIBRARY != "jax":
                targets[body][...] = 0
            array, was_done = ON.written_late(targets[body], values[body], matrix)
            late |= not was_done
            self.expect_same(self.soft.run(vertices={**values, body: given(array)}), expected)
        self.assertTrue(late, "nothing was under way: the test says nothing")

    def test_work_follows_the_librarys_stream(self):
        stream = ON.stream()
        collider = self.collider(self.pile, stream=stream)
        self.assertEqual(collider._core.queue, ON.stream_address(stream))
        expected = self.rigid.run(self.pile.poses(1))
        matrix, values = ON.matrix(), ON.array(self.pile.poses(1))
        ON.finish()
        with ON.on(stream):
            poses, was_done = ON.written_late(ON.empty_like(values), values, matrix)
            self.assertFalse(was_done)
            answer = collider.run(poses)
            self.assertEqual(collider._core.addresses, [ON.address(poses)])
            self.expect_same(answer, expected)
            rows = ON.taken(answer.pairs(on_device=True))
            self.assertEqual(
                sorted(map(tuple, ON.host(rows).tolist())), sorted(map(tuple, expected.pairs().tolist()))
            )
        by_default_stream = self.collider(self.pile, stream=0)
        self.expect_same(by_default_stream.run(values), expected)

    def test_a_captured_frame_reads_its_arrays_again(self):
        """1,000 replays with other poses in the same array, without a call of tandem."""
        stream = ON.stream()
        collider = self.collider(self.pile)
        frames = [ON.array(self.pile.poses(frame)) for frame in range(self.pile.frame_count)]
        expected = [collider.run(frame) for frame in frames]
        with ON.on(stream):
            poses = ON.empty_like(frames[0])
            ON.written(poses, frames[0])
            queued = collider.enqueue(poses, stream=stream)
            self.expect_same(queued.collect(), expected[0])
        replay = ON.captured(stream, lambda: collider.enqueue(poses, stream=stream))
        counts = ON.taken(queued.counts)
        with ON.on(stream):
            for step in range(1000):
                frame = step % len(frames)
                ON.written(poses, frames[frame])
                replay()
                if step % 100 < len(frames):
                    stream.synchronize()
                    flag, pairs, contacts, *_ = ON.host(counts)[0]
                    right = expected[frame]
                    self.assertEqual((flag, pairs, contacts), (0, right.count, right.contact_count))
                    rows = ON.host(ON.taken(queued.pairs))[:pairs]
                    self.assertEqual(set(map(tuple, rows)), set(map(tuple, right.pairs())))

    def test_pairs_stay_on_the_device(self):
        answer = self.rigid.run(ON.array(self.pile.poses(0)))
        first, second = ON.taken(answer.pairs(on_device=True)), ON.taken(answer.pairs(on_device=True))
        self.assertEqual(ON.address(first), ON.address(second))
        self.assertEqual(tuple(first.shape), (answer.count, 4))
        self.assertEqual(
            tuple(map(int, answer.pairs(on_device=True).__dlpack_device__())), (2, int(DEVICE[5:]))
        )
        kept = ON.host(first).copy()
        self.assertTrue((kept == answer.pairs()).all())
        del answer
        for frame in (1, 2, 1):
            self.rigid.run(self.pile.poses(frame))
        self.assertTrue((ON.host(first) == kept).all(), "the memory lives as long as an array over it")

    def failure(self, kind, function, *arguments, **named):
        with self.assertRaises(kind) as caught:
            function(*arguments, **named)
        self.assertNotIn("\n", str(caught.exception))
        return str(caught.exception)

    def test_errors_equal_those_for_host_memory(self):
        for at, value in (((3, 0), numpy.nan), ((5, 4), numpy.inf), ((6, slice(3, 7)), 0), ((2, 1), 1e37)):
            rows = self.pile.poses(0).copy()
            rows[at] = value
            message = self.failure(ValueError, self.rigid.run, ON.array(rows))
            self.assertEqual(message, self.failure(ValueError, self.rigid.run, rows))
            print(f"\n  ValueError: {message}", end="", file=sys.stderr)
        rows = self.plates.vertices(60)
        rows[1][7, 2] = numpy.nan
        message = self.failure(ValueError, self.soft.run, vertices={1: ON.array(rows[1])})
        self.assertEqual(
            (message, self.failure(ValueError, self.soft.run, vertices={1: rows[1]})), (message, message)
        )
        self.assertIn("body 1: vertex 7 is not finite", message)
        good = self.pile.poses(0)
        self.expect_same(self.rigid.run(ON.array(good)), self.rigid.run(good))

    def test_refused_input(self):
        good = self.pile.poses(0)
        for kind, words, value in (
            (ValueError, "expected (n, 7)", ON.array(good[:, :6])),
            (ValueError, "rows for 64 bodies", ON.array(good[1:])),
            (TypeError, "neither float64 nor float32", ON.array(good, numpy.int32)),
        ):
            self.assertIn(words, self.failure(kind, self.rigid.run, value))
        if LIBRARY != "jax":  # whose arrays are always contiguous
            self.assertIn(
                "rows are not contiguous",
                self.failure(ValueError, self.rigid.run, ON.array(numpy.repeat(good, 2, axis=1))[:, ::2]),
            )
        if LIBRARY == "torch":
            self.assertIn(
                "__dlpack__ failed", self.failure(ValueError, self.rigid.run, ON.array(good).requires_grad_())
            )
        host = tandem.Collider(self.pile.meshes, bodies=self.pile.bodies)
        self.assertIn("the collider works on host", self.failure(ValueError, host.run, ON.array(good)))

    def test_auto_measures_on_device_frames(self):
        collider = self.collider(self.pile, algorithm="auto")
        trials = collider.tune(ON.array(self.pile.poses(0)), seconds=0.2)
        self.assertEqual(collider.algorithm, trials[0].algorithm)
        self.expect_same(collider.run(ON.array(self.pile.poses(1))), self.rigid.run(self.pile.poses(1)))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
