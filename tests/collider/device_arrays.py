# SPDX-License-Identifier: MIT
# test: cost=1 needs=TANDEM_BUILDS_PYTHON
"""GPU arrays as input of tandem.Collider, on the stub of CUDA's driver
(LD_LIBRARY_PATH and TANDEM_NVRTC name it). Tests the stream passed to the array's library, kernels that get
the original addresses, release of borrowed arrays, and errors. Kernels of the stub find no pairs;
tests/conformance checks their results. With origin=auto the host would read the first frame, and the stub
copies from no array of others."""

import ctypes
import gc
import weakref

import numpy

from tests.collider.case import POSES, ColliderCase, tandem
from tests.collider.gpu_memory import ByInterface, OnGpu, WithBoth, with_table


DRIVER = ctypes.CDLL("libcuda.so.1")
for name in ("stub_launches_with", "stub_copies_of"):
    getattr(DRIVER, name).argtypes, getattr(DRIVER, name).restype = [ctypes.c_ulonglong], ctypes.c_ulong
for name in ("stub_calls", "stub_orderings"):
    getattr(DRIVER, name).argtypes, getattr(DRIVER, name).restype = [ctypes.c_void_p] * 2, ctypes.c_ulong

# As in mistakes.py.
REFUSED = """
ValueError  | poses: shape (2, 6); expected (n, 7)                      | pairs(table(array[:, :6]))
TypeError   | poses: numbers of 64 bits that are neither                | pairs(table(array, numpy.int64))
ValueError  | poses: is in CUDA's memory of GPU 1, and the collider works on cuda:0 | pairs(table(array, device=(2, 1)))
ValueError  | poses: shape (2, 6); expected (n, 7)                      | pairs(both(array[:, :6]))
TypeError   | poses: numbers of 64 bits that are neither                | pairs(both(array, numpy.int64))
ValueError  | poses: is in CUDA's memory of GPU 1, and the collider works on cuda:0 | pairs(both(array, device=(2, 1)))
ValueError  | poses: shape (2, 6); expected (n, 7)                      | pairs(OnGpu(array[:, :6]))
ValueError  | poses: shape (7,); expected (n, 7)                        | pairs(OnGpu(array[0]))
ValueError  | poses: 1 rows for 2 bodies                                | pairs(OnGpu(array[:1]))
TypeError   | poses: numbers of 16 bits that are neither                | pairs(OnGpu(array, numpy.float16))
TypeError   | poses: numbers of 64 bits that are neither                | pairs(OnGpu(array, numpy.int64))
ValueError  | rows are not contiguous                                   | pairs(wide)
ValueError  | poses: is in CUDA's memory of GPU 1, and the collider works on cuda:0 | pairs(OnGpu(array, device=(2, 1)))
ValueError  | poses: its address is not a multiple of 8 bytes           | pairs(odd)
ValueError  | poses: shape (2, 6); expected (n, 7)                      | pairs(ByInterface(array[:, :6]))
TypeError   | poses: type <i8 on a GPU                                  | pairs(ByInterface(array.astype(int)))
ValueError  | rows are not contiguous                                   | pairs(ByInterface(array, strides=(112, 16)))
ValueError  | vertices: 15 rows for body 1, whose mesh has 16 vertices  | soft.run(vertices=[OnGpu(points[1:])])
ValueError  | placement=exact bounds on the host                        | exact.run(OnGpu(array))
ValueError  | residency=published converts every frame on the host      | published.run(OnGpu(array))
ValueError  | poses: is in CUDA's memory, and the collider works on host | make("host").run(OnGpu(array))
ValueError  | poses: is in CUDA's memory, and the collider works on host | make("host").run(table(array))
ValueError  | in CUDA's memory, and the collider works on host+cuda:0   | make("host+cuda:0").run(OnGpu(array))
ValueError  | in CUDA's memory, and the collider works on host+cuda:0   | make("host+cuda:0").run(table(array))
ValueError  | stream: device host is not a CUDA device                  | make("host", stream=0)
TypeError   | stream: type str; expected a CUDA stream or its address   | make(stream="main")
DeviceError | cuda:4: the driver has 1 devices                          | make("cuda:4", stream=0)
ValueError  | poses: __dlpack__ failed: not while it is differentiated  | pairs(Ungiven(array))
"""


class Arrays(ColliderCase):
    def collider(self, device="cuda:0", **options):
        return tandem.Collider(
            self.meshes,
            device=device,
            **{"pair_capacity": 1024, "contact_capacity": 1024, "origin": "world", **options},
        )

    def expect_read(self, collider, run, *addresses):
        """Checks that the frame's kernels get these addresses and that nothing is copied to or from them. Counters
        include earlier uses of the addresses."""
        passed = [address for address in addresses if address]
        before = [(DRIVER.stub_launches_with(address), DRIVER.stub_copies_of(address)) for address in passed]
        run()
        self.assertEqual(collider._core.addresses, list(addresses))
        self.assertEqual(
            [(DRIVER.stub_launches_with(address), DRIVER.stub_copies_of(address)) for address in passed],
            [(launches + 1, copies) for launches, copies in before],
        )

    def stream(self):
        """An application's stream of the primary context."""
        context, stream = ctypes.c_void_p(), ctypes.c_void_p()
        DRIVER.cuDevicePrimaryCtxRetain(ctypes.byref(context), 0)
        DRIVER.cuCtxSetCurrent(context)
        DRIVER.cuStreamCreate(ctypes.byref(stream), 0)
        DRIVER.cuCtxSetCurrent(None)
        return stream.value, context.value

    def test_kernels_read_poses_without_a_copy(self):
        collider = self.collider()
        for dtype in (numpy.float64, numpy.float32):
            for device in ((2, 0), (13, 0)):  # managed memory is also a GPU's
                poses = OnGpu(POSES, dtype, device)
                self.expect_read(collider, lambda: collider.run(poses), poses.address)
                self.assertEqual((poses.streams, poses.given_back), ([collider._core.queue], 1))
                self.assertNotIn(poses.streams[0], (None, 0, 1), "a stream of its own")

    def test_kernels_read_vertices_without_a_copy(self):
        soft = self.collider(deformable=True)
        rows = [OnGpu(points, numpy.float32) for points, _ in self.meshes]
        self.expect_read(soft, lambda: soft.run(vertices=rows), 0, *(array.address for array in rows))
        soft.run(vertices={1: rows[1]})  # the other body has the vertices of its mesh
        self.assertEqual(soft._core.addresses[2], rows[1].address)
        self.assertNotEqual(soft._core.addresses[1], rows[0].address)
        soft.run(vertices=[self.meshes[0][0], rows[1]])  # from host memory and from GPU memory
        self.assertEqual(soft._core.addresses[2], rows[1].address)
        self.assertEqual([array.given_back for array in rows], [1, 3])
        self.assertEqual([array.asked for array in rows], [1, 2], "the second is read after the first")

    def test_arrays_at_different_addresses_are_different_input(self):
        soft, (first, second) = self.collider(deformable=True), (points for points, _ in self.meshes)
        expected = soft.run(vertices=[first, second]).digest()
        rows = [OnGpu(first), OnGpu(second, device=(1, 0))]
        self.assertEqual(soft.run(vertices=rows).digest(), expected)
        self.assertEqual((rows[1].streams, rows[1].asked > 0), ([soft._core.queue, None], True))
        self.assertNotEqual(soft._core.addresses[2], rows[1].address)
        for words, array in (
            ("is in CUDA's memory of GPU 1, and the collider works on cuda:0", OnGpu(second, device=(2, 1))),
            ("shape (1, 3, 3)", OnGpu([second[:3]])),
            ("vertices of body 1: its rows are not contiguous", OnGpu(second)),
        ):
            if "contiguous" in words:
                array.array = numpy.repeat(second, 2, axis=1)[:, ::2]
            with self.assertRaisesRegex(ValueError, words.replace("(", "\\(").replace(")", "\\)")):
                soft.run(vertices=[OnGpu(first), array])

    def test_arrays_with_the_cuda_array_interface(self):
        collider, array = self.collider(), numpy.array(POSES)
        stream, context = self.stream()
        before = DRIVER.stub_calls(stream, context)
        for changes, followed in (({}, 0), ({"stream": stream}, 1), ({"strides": (56, 8)}, 1)):
            self.expect_read(
                collider,
                lambda: collider.run(ByInterface(array, **changes)),
                array.__array_interface__["data"][0],
            )
            self.assertEqual(DRIVER.stub_calls(stream, context), before + followed)

    def expect_followed(self, collider, stream, times, run):
        before = DRIVER.stub_orderings(collider._core.queue, stream)
        run()
        self.assertEqual(DRIVER.stub_orderings(collider._core.queue, stream), before + times)

    def test_a_stream_is_followed_once_per_frame(self):
        soft, array = self.collider(deformable=True), numpy.array(POSES)
        first, second = (self.stream()[0] for _ in range(2))
        rows = [ByInterface(points, stream=first) for points, _ in self.meshes]
        self.expect_followed(
            soft, first, 1, lambda: self.expect_followed(soft, second, 0, lambda: soft.run(vertices=rows))
        )
        self.expect_followed(soft, second, 1, lambda: soft.run(ByInterface(array, stream=second), rows))
        self.expect_followed(soft, first, 1, lambda: soft.run(vertices=rows))
        self.expect_followed(soft, None, 1, lambda: soft.run(ByInterface(array, stream=1), rows))
        swept = self.collider(deformable=True, motion="linear", contact_rule="none")
        later = [ByInterface(points + 1, stream=first) for points, _ in self.meshes]
        read = [
            address
            for frame in (rows, later)
            for address in (0, *(array.array.__array_interface__["data"][0] for array in frame))
        ]
        self.expect_followed(
            swept,
            first,
            1,
            lambda: self.expect_read(swept, lambda: swept.run(vertices=rows, next_vertices=later), *read),
        )
        own = self.collider(stream=first)
        self.expect_followed(own, first, 0, lambda: own.run(ByInterface(array, stream=first)))

    def test_arrays_with_dlpacks_table(self):
        """No Python method is called, and the library's stream is followed."""
        stream, _ = self.stream()
        soft, kind = self.collider(deformable=True), with_table(stream)
        for dtype, device in ((numpy.float64, (2, 0)), (numpy.float32, (13, 0))):
            rows = [kind(points, dtype, device) for points, _ in self.meshes]
            self.expect_followed(
                soft,
                stream,
                1,
                lambda: self.expect_read(
                    soft, lambda: soft.run(vertices=rows), 0, *(array.address for array in rows)
                ),
            )
            self.assertEqual(
                [(array.given, array.given_back, array.streams) for array in rows], [(1, 1, [])] * 2
            )
        default, collider = with_table(None)(POSES), self.collider()
        self.expect_followed(collider, None, 1, lambda: collider.run(default))
        newer = with_table(stream, major=2, older=kind.table)(POSES)
        self.expect_followed(collider, stream, 1, lambda: collider.run(newer))
        self.assertEqual((newer.given, newer.streams), (1, []))
        dropped = kind(POSES)
        collider.run(dropped)
        gone = weakref.ref(dropped)
        del dropped
        gc.collect()
        self.assertIsNone(gone())

    def test_arrays_stay_alive_during_a_frame(self):
        """Also if the list that contained it is cleared before the frame runs."""
        soft, kept = self.collider(deformable=True), []

        class Emptying(OnGpu):
            def __dlpack__(self, **named):
                rows.clear()
                return super().__dlpack__(**named)

        for kind in (
            type("Plain", (numpy.ndarray,), {}),
            type("Both", (WithBoth,), {"changes": {"stream": 1}}),
            with_table(),
            OnGpu,
        ):
            points = self.meshes[0][0]
            first, last = (
                points.copy().view(kind) if issubclass(kind, numpy.ndarray) else kind(points),
                Emptying(self.meshes[1][0]),
            )
            rows, reference = [first, last], weakref.ref(first)
            del first
            watcher = ctypes.CFUNCTYPE(None, ctypes.c_int)(
                lambda _: kept.append(reference() is not None and not getattr(reference(), "given_back", 0))
            )
            DRIVER.stub_watch(watcher)
            soft.run(vertices=rows)
            DRIVER.stub_watch(None)
            self.assertEqual((rows, set(kept)), ([], {True}), kind)
            gc.collect()
            self.assertIsNone(reference())

    def test_arrays_that_the_table_lacks_use_dlpack(self):
        collider, stream = self.collider(), self.stream()[0]
        for options in ({"gives": -1}, {"tells": -1}, {"major": 2}, {"name": b"other"}):
            poses = with_table(stream, **options)(POSES)
            self.expect_followed(
                collider,
                stream,
                0,
                lambda: self.expect_read(collider, lambda: collider.run(poses), poses.address),
            )
            self.assertEqual(
                (poses.given, poses.streams),
                ("major" not in options and "name" not in options, [collider._core.queue]),
                options,
            )
            self.assertEqual(poses.given_back, 2 if "tells" in options else 1, options)

        class Odd(with_table(stream)):
            def tensor(self):
                tensor = super().tensor()
                tensor.ndim = -1
                return tensor

        poses = Odd(POSES)
        with self.assertRaises(RuntimeError):
            collider.run(poses)
        self.assertEqual((poses.given, poses.given_back, len(poses.streams)), (1, 1, 1))
        poses = with_table(stream)(POSES)
        poses.requires_grad = True
        collider.run(poses)
        self.assertEqual((poses.given, poses.streams), (0, [collider._core.queue]))

    def test_host_arrays_with_dlpacks_table(self):
        for device in ("host", "cuda:0"):
            collider = self.collider(device)
            for kind in ((1, 0), (3, 0)):
                poses = with_table()(POSES, device=kind)
                answer = collider.run(poses)
                self.assertEqual((poses.given, poses.given_back, poses.streams), (1, 1, []))
                self.assertEqual(answer.digest(), collider.run(POSES).digest())
            apart = with_table()(POSES, numpy.float32, (1, 0))
            self.assertEqual(collider.run(apart).digest(), answer.digest())
            self.assertEqual((apart.given, apart.streams), (1, [None]), "NumPy makes of it what is wanted")

    def test_the_protocol_that_names_a_stream_is_preferred(self):
        collider, stream = self.collider(), self.stream()[0]

        class Streamless(WithBoth):
            pass

        for kind, changes, followed in (
            (WithBoth, {"stream": stream}, 1),
            (Streamless, {}, 0),
            (Streamless, {"stream": stream}, 0),
            (WithBoth, {"stream": stream}, 1),
        ):
            poses = kind(POSES)
            poses.changes = changes
            self.expect_followed(
                collider,
                stream,
                followed,
                lambda: self.expect_read(collider, lambda: collider.run(poses), poses.address),
            )
            self.assertEqual(
                (poses.streams, poses.given_back), ([], 0) if followed else ([collider._core.queue], 1)
            )

    def test_work_follows_the_applications_stream(self):
        address, context = self.stream()

        class Stream:
            pass

        for name, value in (
            (None, address),
            ("ptr", address),
            ("cuda_stream", address),
            ("__cuda_stream__", lambda: (0, address)),
        ):
            stream = address
            if name:
                stream = Stream()
                setattr(stream, name, value)
            before = DRIVER.stub_calls(address, context)
            collider, poses = self.collider(stream=stream), OnGpu(POSES)
            self.assertEqual(collider.devices, ["cuda:0"])
            collider.run(poses)
            self.assertEqual(poses.streams, [address])
            self.assertGreater(DRIVER.stub_calls(address, context), before + 7)
        kept, stream = self.collider(stream=stream).run(POSES), weakref.ref(stream)
        self.assertIsNotNone(stream(), "an answer has its collider, which has its stream")
        del kept, collider
        gc.collect()
        self.assertIsNone(stream())
        for default in (0, 1):
            poses = OnGpu(POSES)
            self.collider(stream=default).run(poses)
            self.assertEqual(poses.streams, [1], "DLPack's name of the default stream")

    def test_enqueued_frames_are_in_the_order_of_the_arrays_stream(self):
        stream, other = self.stream()[0], self.stream()[0]
        collider, poses = self.collider(), ByInterface(numpy.array(POSES), stream=stream)

        def ordered(run):
            """How often `run` ordered the collider's stream after another one, and the other after it."""
            own = collider._core.queue
            before = [
                DRIVER.stub_orderings(*pair)
                for name in (stream, other)
                for pair in ((own, name), (name, own))
            ]
            run()
            after = [
                DRIVER.stub_orderings(*pair)
                for name in (stream, other)
                for pair in ((own, name), (name, own))
            ]
            return [new - old for new, old in zip(after, before)]

        self.assertEqual(ordered(lambda: collider.enqueue(poses)), [1, 1, 0, 0])
        self.assertEqual(ordered(lambda: collider.enqueue(poses, stream=other)), [1, 0, 1, 1])
        self.assertEqual(ordered(lambda: collider.enqueue(POSES)), [0, 0, 0, 0])

    def test_a_captured_frame_needs_arrays_of_the_gpu(self):
        stream, context = self.stream()
        collider, array = self.collider(deformable=[1]), numpy.array(POSES)
        poses, points = ByInterface(array, stream=stream), ByInterface(self.meshes[1][0], stream=stream)
        collider.enqueue(poses, [points])
        collider.enqueue(poses, [self.meshes[1][0]])

        def captured(run):
            graph = ctypes.c_void_p()
            DRIVER.cuCtxSetCurrent(ctypes.c_void_p(context))
            DRIVER.cuStreamBeginCapture_v2(ctypes.c_void_p(stream), 0)
            try:
                run()
            finally:
                code = DRIVER.cuStreamEndCapture(ctypes.c_void_p(stream), ctypes.byref(graph))
                DRIVER.cuCtxSetCurrent(None)
            self.assertEqual(code, 0)

        captured(lambda: collider.enqueue(poses, [points]))
        with self.assertRaisesRegex(ValueError, "in a capture got an array in host memory"):
            captured(lambda: collider.enqueue(poses, [self.meshes[1][0]]))
        with self.assertRaisesRegex(ValueError, "enqueue a frame before the capture"):
            captured(lambda: self.collider().enqueue(poses))

    def test_refused_input(self):
        array = numpy.array(POSES)
        wide, odd = OnGpu(numpy.zeros((2, 14))), OnGpu(numpy.zeros(16))
        wide.array = wide.array[:, ::2]
        odd.array = numpy.frombuffer(odd.array.tobytes() + b"    ", numpy.uint8)[4 : 4 + 112]
        odd.array = odd.array.view(numpy.float64).reshape(2, 7)

        class Ungiven(OnGpu):
            def __dlpack__(self, **_):
                raise BufferError("not while it\nis differentiated")

        both = type("Both", (WithBoth,), {"changes": {"stream": 1}})
        exact = self.collider(placement="exact")
        published = self.collider(algorithm="chunked", preset="published", seed_capacity=1024)
        names = {
            **{"make": self.collider, "exact": exact, "published": published, "numpy": numpy, "array": array},
            **{"wide": wide, "odd": odd, "table": with_table(), "both": both, "Ungiven": Ungiven},
            **{"OnGpu": OnGpu, "ByInterface": ByInterface, "pairs": self.collider().pairs},
            **{"soft": self.collider(deformable=[1]), "points": self.meshes[1][0]},
        }
        self.expect_mistakes(REFUSED, names)
