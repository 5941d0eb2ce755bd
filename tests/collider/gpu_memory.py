# SPDX-License-Identifier: MIT
"""Arrays that report NumPy memory as memory of a GPU, by each of the protocols of array libraries."""

import ctypes

import numpy


DELETER = ctypes.CFUNCTYPE(None, ctypes.c_void_p)
FROM_OBJECT = ctypes.PYFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.POINTER(ctypes.c_void_p))
CURRENT_STREAM = ctypes.PYFUNCTYPE(
    ctypes.c_int, ctypes.c_int, ctypes.c_int32, ctypes.POINTER(ctypes.c_void_p)
)
NUMBERS = ctypes.POINTER(ctypes.c_int64)


def structure(name, **fields):
    """A structure of C. Texts name types of ctypes without their c_; "self" is a pointer to the structure."""
    made = type(name, (ctypes.Structure,), {})
    types = {"self": ctypes.POINTER(made)}
    made._fields_ = [
        (field, types.get(kind) or getattr(ctypes, f"c_{kind}") if isinstance(kind, str) else kind)
        for field, kind in fields.items()
    ]
    return made


Tensor = structure(
    "Tensor",
    **dict(data="void_p", device_type="int32", device_id="int32", ndim="int32", code="uint8", bits="uint8"),
    **dict(lanes="uint16", shape=NUMBERS, strides=NUMBERS, byte_offset="uint64"),
)
Managed = structure("Managed", tensor=Tensor, context="void_p", deleter=DELETER)
Versioned = structure(
    "Versioned",
    **dict(major="uint32", minor="uint32", context="void_p", deleter=DELETER, flags="uint64", tensor=Tensor),
)
Table = structure(
    "Table",
    **dict(major="uint32", minor="uint32", older="self", allocate="void_p", from_object=FROM_OBJECT),
    **dict(to_object="void_p", view="void_p", current_stream=CURRENT_STREAM),
)


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
        older_table = ctypes.pointer(older) if older else None
        functions = FROM_OBJECT(from_object), CURRENT_STREAM(current_stream)
        table = Table(major, 0, older_table, None, functions[0], None, None, functions[1])
        __dlpack_c_exchange_api__ = ctypes.pythonapi.PyCapsule_New(ctypes.addressof(table), name, None)

    return WithTable


class WithBoth(OnGpu):
    """With both DLPack and an interface, as CuPy's."""

    changes = {}

    @property
    def __cuda_array_interface__(self):
        return {**ByInterface(self.array).__cuda_array_interface__, **self.changes}
