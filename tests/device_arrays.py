#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""device_arrays.py PROGRAM SOURCE: GPU arrays as input of tandem.Collider, on the stub of CUDA's driver
(LD_LIBRARY_PATH and TANDEM_NVRTC name it). Tests the stream passed to the array's library, kernels that get
the original addresses, release of borrowed arrays, and errors. Kernels of the stub find no pairs;
tests/conformance checks their results. With origin=auto the host would read the first frame, and the stub
copies from no array of others."""

import ctypes
import gc
import pathlib
import subprocess
import sys
import tempfile
import unittest
import weakref

import numpy

from program import PROGRAM, Case, bar

POSES = [[0, 0, 0, 1, 0, 0, 0], [0.125, 0, 0.0625, 0.98, 0.1, 0.05, 0.15]]


def setUpModule():
    global tandem, FOLDER, DRIVER
    FOLDER = tempfile.TemporaryDirectory(prefix="tandem-arrays")
    subprocess.run(
        ["cmake", "--install", PROGRAM.parent, "--component", "python", "--prefix", FOLDER.name],
        check=True,
        capture_output=True,
    )
    sys.path.insert(0, FOLDER.name)
    import tandem

    assert pathlib.Path(tandem.__file__).is_relative_to(FOLDER.name)
    DRIVER = ctypes.CDLL("libcuda.so.1")
    for name in ("stub_launches_with", "stub_copies_of"):
        getattr(DRIVER, name).argtypes, getattr(DRIVER, name).restype = [ctypes.c_ulonglong], ctypes.c_ulong
    for name in ("stub_calls", "stub_orderings"):
        getattr(DRIVER, name).argtypes, getattr(DRIVER, name).restype = (
            [ctypes.c_void_p, ctypes.c_void_p],
            ctypes.c_ulong,
        )


def tearDownModule():
    FOLDER.cleanup()


class Tensor(ctypes.Structure):
    _fields_ = [
        ("data", ctypes.c_void_p),
        ("device_type", ctypes.c_int32),
        ("device_id", ctypes.c_int32),
        ("ndim", ctypes.c_int32),
        ("code", ctypes.c_uint8),
        ("bits", ctypes.c_uint8),
        ("lanes", ctypes.c_uint16),
        ("shape", ctypes.POINTER(ctypes.c_int64)),
        ("strides", ctypes.POINTER(ctypes.c_int64)),
        ("byte_offset", ctypes.c_uint64),
    ]


DELETER = ctypes.CFUNCTYPE(None, ctypes.c_void_p)


class Managed(ctypes.Structure):
    _fields_ = [("tensor", Tensor), ("context", ctypes.c_void_p), ("deleter", DELETER)]


class Versioned(ctypes.Structure):
    _fields_ = [
        ("major", ctypes.c_uint32),
        ("minor", ctypes.c_uint32),
        ("context", ctypes.c_void_p),
        ("deleter", DELETER),
        ("flags", ctypes.c_uint64),
        ("tensor", Tensor),
    ]


FROM_OBJECT = ctypes.PYFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.POINTER(ctypes.c_void_p))
CURRENT_STREAM = ctypes.PYFUNCTYPE(
    ctypes.c_int, ctypes.c_int, ctypes.c_int32, ctypes.POINTER(ctypes.c_void_p)
)


class Table(ctypes.Structure):
    pass


Table._fields_ = [
    ("major", ctypes.c_uint32),
    ("minor", ctypes.c_uint32),
    ("older", ctypes.POINTER(Table)),
    ("allocate", ctypes.c_void_p),
    ("from_object", FROM_OBJECT),
    ("to_object", ctypes.c_void_p),
    ("view", ctypes.c_void_p),
    ("current_stream", CURRENT_STREAM),
]


ctypes.pythonapi.PyCapsule_New.restype = ctypes.py_object
ctypes.pythonapi.PyCapsule_New.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]


class OnGpu:
    """NumPy memory that reports itself as GPU memory, as in the stub; counts requests and releases."""

    def __init__(self, values, dtype=numpy.float64, device=(2, 0)):
        self.array, self.device = numpy.array(values, dtype), device
        self.streams, self.asked, self.given_back = [], 0, 0

    @property
    def address(self):
        return self.array.__array_interface__["data"][0]

    def __dlpack_device__(self):
        self.asked += 1
        return self.device

    def __dlpack__(self, *, stream=None):
        self.streams.append(stream)
        if self.device[0] == 1 and stream is not None:
            raise BufferError("there is no stream on the host")
        self.managed = Managed(self.tensor(), None, self.deleter)
        return ctypes.pythonapi.PyCapsule_New(ctypes.addressof(self.managed), b"dltensor", None)

    def tensor(self):
        numbers, array = ctypes.c_int64 * self.array.ndim, self.array
        self.shape, self.strides = (
            numbers(*array.shape),
            numbers(*(step // array.itemsize for step in array.strides)),
        )
        self.deleter = DELETER(self._take_back)
        code = {"i": 0, "u": 1, "f": 2, "c": 5}[array.dtype.kind]
        return Tensor(
            self.address, *self.device, array.ndim, code, 8 * array.itemsize, 1, self.shape, self.strides, 0
        )

    def _take_back(self, _):
        self.given_back += 1


class ByInterface:
    """The same with __cuda_array_interface__ only."""

    def __init__(self, array, **changes):
        self.array, self.changes = array, changes

    @property
    def __cuda_array_interface__(self):
        return {
            "shape": self.array.shape,
            "typestr": self.array.dtype.str,
            "version": 3,
            "strides": None,
            "stream": None,
            "data": (self.array.__array_interface__["data"][0], False),
            **self.changes,
        }


def with_table(stream=None, major=1, older=None, gives=0, tells=0, name=b"dlpack_exchange_api"):
    """A type of such arrays whose library has DLPack's table of C functions with current stream `stream`; the
    functions' return codes and the version are parameters."""

    def from_object(address, out):
        array = ctypes.cast(address, ctypes.py_object).value
        array.given += 1
        array.versioned = Versioned(1, 3, None, DELETER(), 0, array.tensor())
        array.versioned.deleter = array.deleter
        out[0] = None if gives else ctypes.addressof(array.versioned)
        return gives

    def current_stream(kind, number, out):
        out[0] = stream if (kind, number) in ((2, 0), (13, 0)) else None
        return tells

    class WithTable(OnGpu):
        given = 0
        table = Table(
            major,
            0,
            ctypes.pointer(older) if older else None,
            None,
            FROM_OBJECT(from_object),
            None,
            None,
            CURRENT_STREAM(current_stream),
        )
        __dlpack_c_exchange_api__ = ctypes.pythonapi.PyCapsule_New(ctypes.addressof(table), name, None)

    return WithTable


class WithBoth(OnGpu):
    """With both DLPack and an interface, as CuPy's."""

    changes = {}

    @property
    def __cuda_array_interface__(self):
        return {**ByInterface(self.array).__cuda_array_interface__, **self.changes}


class Arrays(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.parts = [
            tuple(map(numpy.array, bar(4, (0, 0, 0)))),
            tuple(map(numpy.array, bar(3, (0.5, 0.25, 0.375)))),
        ]

    def collider(self, device="cuda:0", **options):
        return tandem.Collider(
            self.parts,
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
        rows = [OnGpu(points, numpy.float32) for points, _ in self.parts]
        self.expect_read(soft, lambda: soft.run(vertices=rows), 0, *(array.address for array in rows))
        soft.run(vertices={1: rows[1]})  # the other body has the vertices of its mesh
        self.assertEqual(soft._core.addresses[2], rows[1].address)
        self.assertNotEqual(soft._core.addresses[1], rows[0].address)
        soft.run(vertices=[self.parts[0][0], rows[1]])  # from host memory and from GPU memory
        self.assertEqual(soft._core.addresses[2], rows[1].address)
        self.assertEqual([array.given_back for array in rows], [1, 3])
        self.assertEqual([array.asked for array in rows], [1, 2], "the second is read after the first")

    def test_arrays_at_different_addresses_are_different_input(self):
        soft, (first, second) = self.collider(deformable=True), (points for points, _ in self.parts)
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
        rows = [ByInterface(points, stream=first) for points, _ in self.parts]
        self.expect_followed(
            soft, first, 1, lambda: self.expect_followed(soft, second, 0, lambda: soft.run(vertices=rows))
        )
        self.expect_followed(soft, second, 1, lambda: soft.run(ByInterface(array, stream=second), rows))
        self.expect_followed(soft, first, 1, lambda: soft.run(vertices=rows))
        self.expect_followed(soft, None, 1, lambda: soft.run(ByInterface(array, stream=1), rows))
        swept = self.collider(deformable=True, motion="linear", contact_rule="none")
        later = [ByInterface(points + 1, stream=first) for points, _ in self.parts]
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
            rows = [kind(points, dtype, device) for points, _ in self.parts]
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
            points = self.parts[0][0]
            first, last = (
                points.copy().view(kind) if issubclass(kind, numpy.ndarray) else kind(points),
                Emptying(self.parts[1][0]),
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

    def expect(self, kind, words, function, *arguments, **named):
        with self.assertRaises(kind) as caught:
            function(*arguments, **named)
        self.assertIs(type(caught.exception), kind)
        self.assertNotIn("\n", str(caught.exception))
        self.assertIn(words, str(caught.exception))
        print(f"\n  {kind.__name__}: {caught.exception}", end="", file=sys.stderr)

    def test_refused_input(self):
        collider, soft, array = self.collider(), self.collider(deformable=[1]), numpy.array(POSES)
        wide = OnGpu(numpy.zeros((2, 14)))
        wide.array = wide.array[:, ::2]
        odd = OnGpu(numpy.zeros(16))
        odd.array = (
            numpy.frombuffer(odd.array.tobytes() + b"    ", numpy.uint8)[4 : 4 + 112]
            .view(numpy.float64)
            .reshape(2, 7)
        )
        table, both = with_table(), type("Both", (WithBoth,), {"changes": {"stream": 1}})
        for kind, words, value in (
            (ValueError, "poses: shape (2, 6); expected (n, 7)", table(array[:, :6])),
            (TypeError, "poses: numbers of 64 bits that are neither", table(array, numpy.int64)),
            (
                ValueError,
                "poses: is in CUDA's memory of GPU 1, and the collider works on cuda:0",
                table(array, device=(2, 1)),
            ),
            (ValueError, "poses: shape (2, 6); expected (n, 7)", both(array[:, :6])),
            (TypeError, "poses: numbers of 64 bits that are neither", both(array, numpy.int64)),
            (
                ValueError,
                "poses: is in CUDA's memory of GPU 1, and the collider works on cuda:0",
                both(array, device=(2, 1)),
            ),
            (ValueError, "poses: shape (2, 6); expected (n, 7)", OnGpu(array[:, :6])),
            (ValueError, "poses: shape (7,); expected (n, 7)", OnGpu(array[0])),
            (ValueError, "poses: 1 rows for 2 bodies", OnGpu(array[:1])),
            (TypeError, "poses: numbers of 16 bits that are neither", OnGpu(array, numpy.float16)),
            (TypeError, "poses: numbers of 64 bits that are neither", OnGpu(array, numpy.int64)),
            (ValueError, "rows are not contiguous", wide),
            (
                ValueError,
                "poses: is in CUDA's memory of GPU 1, and the collider works on cuda:0",
                OnGpu(array, device=(2, 1)),
            ),
            (ValueError, "poses: its address is not a multiple of 8 bytes", odd),
            (ValueError, "poses: shape (2, 6); expected (n, 7)", ByInterface(array[:, :6])),
            (TypeError, "poses: type <i8 on a GPU", ByInterface(array.astype(int))),
            (ValueError, "rows are not contiguous", ByInterface(array, strides=(112, 16))),
        ):
            with self.subTest(words):
                self.expect(kind, words, collider.pairs, value)
        self.expect(
            ValueError,
            "vertices: 15 rows for body 1, whose mesh has 16 vertices",
            soft.run,
            vertices=[OnGpu(self.parts[1][0][1:])],
        )
        self.expect(
            ValueError,
            "placement=exact bounds on the host",
            self.collider(placement="exact").run,
            OnGpu(array),
        )
        self.expect(
            ValueError,
            "residency=published converts every frame on the host",
            self.collider(algorithm="chunked", preset="published", seed_capacity=1024).run,
            OnGpu(array),
        )
        for device in ("host", "host+cuda:0"):
            for array_on_gpu in (OnGpu(array), with_table()(array)):
                self.expect(
                    ValueError,
                    f"poses: is in CUDA's memory, and the collider works on {device}",
                    self.collider(device=device).run,
                    array_on_gpu,
                )
        self.expect(ValueError, "stream: device host is not a CUDA device", self.collider, "host", stream=0)
        self.expect(
            TypeError, "stream: type str; expected a CUDA stream or its address", self.collider, stream="main"
        )
        self.expect(tandem.DeviceError, "cuda:4: the driver has 1 devices", self.collider, "cuda:4", stream=0)
        collider.run(OnGpu(array))

        class Ungiven(OnGpu):
            def __dlpack__(self, **_):
                raise BufferError("not while it\nis differentiated")

        self.expect(
            ValueError,
            "poses: __dlpack__ failed: not while it is differentiated",
            collider.run,
            Ungiven(array),
        )


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
