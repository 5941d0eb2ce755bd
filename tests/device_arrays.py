#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""device_arrays.py PROGRAM SOURCE: arrays of a GPU as input of tandem.Collider, on the stub of CUDA's driver (LD_LIBRARY_PATH and
TANDEM_NVRTC name it): which stream their library is told, that kernels are given the very addresses, that what was borrowed is given
back, and what is refused in which words. Kernels of the stub find nothing; what they make of numbers is tests/conformance's."""
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
    subprocess.run(["cmake", "--install", PROGRAM.parent, "--component", "python", "--prefix", FOLDER.name], check=True, capture_output=True)
    sys.path.insert(0, FOLDER.name)
    import tandem
    assert pathlib.Path(tandem.__file__).is_relative_to(FOLDER.name)
    DRIVER = ctypes.CDLL("libcuda.so.1")
    for name in ("stub_launches_with", "stub_copies_of"):
        getattr(DRIVER, name).argtypes, getattr(DRIVER, name).restype = [ctypes.c_ulonglong], ctypes.c_ulong
    DRIVER.stub_calls.argtypes, DRIVER.stub_calls.restype = [ctypes.c_void_p, ctypes.c_void_p], ctypes.c_ulong


def tearDownModule():
    FOLDER.cleanup()


class Tensor(ctypes.Structure):
    _fields_ = [("data", ctypes.c_void_p), ("device_type", ctypes.c_int32), ("device_id", ctypes.c_int32), ("ndim", ctypes.c_int32),
                ("code", ctypes.c_uint8), ("bits", ctypes.c_uint8), ("lanes", ctypes.c_uint16), ("shape", ctypes.POINTER(ctypes.c_int64)),
                ("strides", ctypes.POINTER(ctypes.c_int64)), ("byte_offset", ctypes.c_uint64)]


DELETER = ctypes.CFUNCTYPE(None, ctypes.c_void_p)


class Managed(ctypes.Structure):
    _fields_ = [("tensor", Tensor), ("context", ctypes.c_void_p), ("deleter", DELETER)]


ctypes.pythonapi.PyCapsule_New.restype = ctypes.py_object
ctypes.pythonapi.PyCapsule_New.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]


class OnGpu:
    """Memory of NumPy's that says it is a GPU's, as the stub's is; what it was asked for, and what was given back."""
    def __init__(self, values, dtype=numpy.float64, device=(2, 0)):
        self.array, self.device = numpy.array(values, dtype), device
        self.streams, self.given_back = [], 0

    @property
    def address(self):
        return self.array.__array_interface__["data"][0]

    def __dlpack_device__(self):
        return self.device

    def __dlpack__(self, *, stream=None):
        self.streams.append(stream)
        numbers, array = ctypes.c_int64 * self.array.ndim, self.array
        self.shape, self.strides = numbers(*array.shape), numbers(*(step // array.itemsize for step in array.strides))
        self.deleter = DELETER(self._take_back)
        code = {"i": 0, "u": 1, "f": 2, "c": 5}[array.dtype.kind]
        self.managed = Managed(Tensor(self.address, *self.device, array.ndim, code, 8 * array.itemsize, 1, self.shape, self.strides, 0), None, self.deleter)
        return ctypes.pythonapi.PyCapsule_New(ctypes.addressof(self.managed), b"dltensor", None)

    def _take_back(self, _):
        self.given_back += 1


class ByInterface:
    """The same by __cuda_array_interface__ alone."""
    def __init__(self, array, **changes):
        self.array, self.changes = array, changes

    @property
    def __cuda_array_interface__(self):
        return {"shape": self.array.shape, "typestr": self.array.dtype.str, "version": 3, "strides": None, "stream": None,
                "data": (self.array.__array_interface__["data"][0], False), **self.changes}


class Arrays(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.parts = [tuple(map(numpy.array, bar(4, (0, 0, 0)))), tuple(map(numpy.array, bar(3, (0.5, 0.25, 0.375))))]

    def collider(self, device="cuda:0", **options):
        return tandem.Collider(self.parts, device=device, **{"pair_capacity": 1024, "contact_capacity": 1024, **options})

    def expect_read(self, collider, run, *addresses):
        """The frame's kernels are given these, and nothing is copied there or from there. Others may have had the addresses before."""
        there = [address for address in addresses if address]
        before = [(DRIVER.stub_launches_with(address), DRIVER.stub_copies_of(address)) for address in there]
        run()
        self.assertEqual(collider._core.addresses, list(addresses))
        self.assertEqual([(DRIVER.stub_launches_with(address), DRIVER.stub_copies_of(address)) for address in there],
                         [(launches + 1, copies) for launches, copies in before])

    def stream(self):
        """An application's, of the primary context."""
        context, stream = ctypes.c_void_p(), ctypes.c_void_p()
        DRIVER.cuDevicePrimaryCtxRetain(ctypes.byref(context), 0)
        DRIVER.cuCtxSetCurrent(context)
        DRIVER.cuStreamCreate(ctypes.byref(stream), 0)
        DRIVER.cuCtxSetCurrent(None)
        return stream.value, context.value

    def test_kernels_read_poses_where_they_are(self):
        collider = self.collider()
        for dtype in (numpy.float64, numpy.float32):
            for device in ((2, 0), (13, 0)):  # managed memory is also a GPU's
                poses = OnGpu(POSES, dtype, device)
                self.expect_read(collider, lambda: collider.run(poses), poses.address)
                self.assertEqual((poses.streams, poses.given_back), ([collider._core.queue], 1))
                self.assertNotIn(poses.streams[0], (None, 0, 1), "a stream of its own")

    def test_kernels_read_vertices_where_they_are(self):
        soft = self.collider(deformable=True)
        rows = [OnGpu(points, numpy.float32) for points, _ in self.parts]
        self.expect_read(soft, lambda: soft.run(vertices=rows), 0, *(array.address for array in rows))
        soft.run(vertices={1: rows[1]})  # the other body has its mesh's
        self.assertEqual(soft._core.addresses[2], rows[1].address)
        self.assertNotEqual(soft._core.addresses[1], rows[0].address)
        soft.run(vertices=[self.parts[0][0], rows[1]])  # from the host's memory and from the GPU's
        self.assertEqual(soft._core.addresses[2], rows[1].address)
        self.assertEqual([array.given_back for array in rows], [1, 3])

    def test_arrays_may_come_by_the_cuda_array_interface(self):
        collider, array = self.collider(), numpy.array(POSES)
        stream, context = self.stream()
        before = DRIVER.stub_calls(stream, context)
        for changes, followed in (({}, 0), ({"stream": stream}, 1), ({"strides": (56, 8)}, 1)):
            self.expect_read(collider, lambda: collider.run(ByInterface(array, **changes)), array.__array_interface__["data"][0])
            self.assertEqual(DRIVER.stub_calls(stream, context), before + followed)

    def test_work_goes_by_the_applications_stream(self):
        address, context = self.stream()

        class Stream:
            pass
        for name, value in ((None, address), ("ptr", address), ("cuda_stream", address), ("__cuda_stream__", lambda: (0, address))):
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

    def test_what_is_refused(self):
        collider, soft, array = self.collider(), self.collider(deformable=[1]), numpy.array(POSES)
        wide = OnGpu(numpy.zeros((2, 14)))
        wide.array = wide.array[:, ::2]
        odd = OnGpu(numpy.zeros(16))
        odd.array = numpy.frombuffer(odd.array.tobytes() + b"    ", numpy.uint8)[4:4 + 112].view(numpy.float64).reshape(2, 7)
        for kind, words, value in (
                (ValueError, "poses: shape (2, 6), and (n, 7) is wanted", OnGpu(array[:, :6])), (ValueError, "poses: shape (7,), and (n, 7) is wanted", OnGpu(array[0])),
                (ValueError, "poses: 1 rows for 2 bodies", OnGpu(array[:1])), (TypeError, "poses: numbers of 16 bits that are neither", OnGpu(array, numpy.float16)),
                (TypeError, "poses: numbers of 64 bits that are neither", OnGpu(array, numpy.int64)), (ValueError, "rows are not beside each other", wide),
                (ValueError, "poses: is in CUDA's memory of GPU 1, and the collider works on cuda:0", OnGpu(array, device=(2, 1))),
                (ValueError, "poses: begins at no multiple of 8 bytes", odd),
                (ValueError, "poses: shape (2, 6), and (n, 7) is wanted", ByInterface(array[:, :6])), (TypeError, "poses: type <i8 on a GPU", ByInterface(array.astype(int))),
                (ValueError, "rows are not beside each other", ByInterface(array, strides=(112, 16)))):
            with self.subTest(words):
                self.expect(kind, words, collider.pairs, value)
        self.expect(ValueError, "vertices: 15 rows for body 1, whose mesh has 16 vertices", soft.run, vertices=[OnGpu(self.parts[1][0][1:])])
        self.expect(ValueError, "placement=exact bounds on the host", self.collider(placement="exact").run, OnGpu(array))
        self.expect(ValueError, "residency=published converts every frame on the host", self.collider(algorithm="chunked", preset="published", seed_capacity=1024).run,
                    OnGpu(array))
        for device in ("host", "host+cuda:0"):
            self.expect(ValueError, f"poses: is in CUDA's memory, and the collider works on {device}", self.collider(device=device).run, OnGpu(array))
        self.expect(ValueError, "stream: device host is not one of CUDA's", self.collider, "host", stream=0)
        self.expect(TypeError, "stream: type str, and a CUDA stream or its address is wanted", self.collider, stream="main")
        self.expect(tandem.DeviceError, "cuda:4: the driver has 1 devices", self.collider, "cuda:4", stream=0)
        collider.run(OnGpu(array))

        class Ungiven(OnGpu):
            def __dlpack__(self, **_):
                raise BufferError("not while it\nis differentiated")
        self.expect(ValueError, "poses: is not given by DLPack: not while it is differentiated", collider.run, Ungiven(array))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
