# SPDX-License-Identifier: MIT
"""Arrays of users as the library takes them: rows beside each other, of one type in the host's memory, of two on a GPU."""
import numpy

CPU, CUDA, CUDA_HOST, CUDA_MANAGED = 1, 2, 3, 13  # kinds of memory as DLPack numbers them
DEFAULT_STREAM = 1  # its name where 0 is none
KINDS = {2: "CUDA's", 4: "OpenCL's", 7: "Vulkan's", 8: "Metal's", 10: "ROCm's", 13: "CUDA's managed", 14: "oneAPI's"}


def host_array(value, what, columns, dtype=numpy.float64):
    """`value` as an array (rows, columns) of `dtype` with its rows beside each other. It is the same memory where `value`, a
    NumPy array or anything of the host's that has __dlpack__, is so already, and a copy otherwise. Raises ValueError or
    TypeError: one line that begins with `what`."""
    if isinstance(value, numpy.ndarray) and value.dtype == dtype and value.ndim == 2 and value.shape[1] == columns and value.flags.c_contiguous:
        return value
    array = _taken(value, what)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(f"{what}: shape {array.shape}, and (n, {columns}) is wanted")
    if numpy.issubdtype(dtype, numpy.integer):
        if array.dtype.kind not in "iu":
            raise TypeError(f"{what}: type {array.dtype}, and integers are wanted")
        if array.size and (array.min() < 0 or array.max() > numpy.iinfo(dtype).max):
            raise ValueError(f"{what}: numbers from {array.min()} to {array.max()}, and they go from 0 to {numpy.iinfo(dtype).max}")
    elif array.dtype.kind not in "iuf":
        raise TypeError(f"{what}: type {array.dtype}, and real numbers are wanted ({numpy.dtype(dtype)} is taken without a copy)")
    return numpy.ascontiguousarray(array, dtype)


def on_gpu(value):
    """Whether it is an array in memory of a CUDA device: by DLPack, else by __cuda_array_interface__."""
    if isinstance(value, (numpy.ndarray, list, tuple)):
        return False
    if hasattr(value, "__dlpack_device__"):
        return int(value.__dlpack_device__()[0]) in (CUDA, CUDA_MANAGED)
    return hasattr(value, "__cuda_array_interface__")


def gpu_rows(value, what, columns, queue):
    """An array on a GPU as _core takes it, which is told to be written before what `queue`, a CUstream, gets next: a capsule of DLPack, or
    (address, rows, bits, stream). No number is looked at or moved. Raises ValueError or TypeError."""
    if not hasattr(value, "__dlpack__"):
        return _interface_rows(value.__cuda_array_interface__, what, columns)
    try:
        return value.__dlpack__(stream=queue or DEFAULT_STREAM)
    except Exception as error:  # what libraries raise here is of any kind
        raise ValueError(f"{what}: is not given by DLPack: {' '.join(str(error).split())}") from None


def stream_address(stream):
    """The CUstream that `stream` is: an address, or what CuPy (.ptr), PyTorch (.cuda_stream) and others (__cuda_stream__) have for one."""
    if hasattr(stream, "__cuda_stream__"):
        stream = stream.__cuda_stream__()[1]
    for name in ("cuda_stream", "ptr"):
        stream = getattr(stream, name, stream)
    if isinstance(stream, bool) or not hasattr(stream, "__index__"):
        raise TypeError(f"stream: type {type(stream).__name__}, and a CUDA stream or its address is wanted")
    if stream.__index__() < 0:
        raise ValueError(f"stream: {stream.__index__()} is no address")
    return stream.__index__()


def _interface_rows(fields, what, columns):
    """Of __cuda_array_interface__, whose strides are None where rows are beside each other."""
    shape, bits = tuple(fields["shape"]), {"<f8": 64, "<f4": 32}.get(fields["typestr"])
    if len(shape) != 2 or shape[1] != columns:
        raise ValueError(f"{what}: shape {shape}, and (n, {columns}) is wanted")
    if bits is None:
        raise TypeError(f"{what}: type {fields['typestr']} on a GPU, where it is read as it is, and float64 or float32 is wanted")
    if fields.get("strides") not in (None, (columns * bits // 8, bits // 8)):
        raise ValueError(f"{what}: its rows are not beside each other, and what is on a device is read as it is; give a contiguous array")
    stream = fields.get("stream")
    return fields["data"][0], shape[0], bits, 0 if stream == DEFAULT_STREAM else stream


def _taken(value, what):
    """As an array of NumPy's, without a copy where there is an array."""
    if isinstance(value, numpy.ndarray):
        return value
    if hasattr(value, "__dlpack_device__"):
        kind = int(value.__dlpack_device__()[0])
        if kind not in (CPU, CUDA_HOST):
            raise ValueError(f"{what}: is in {KINDS.get(kind, 'a device')} memory, and the host's is wanted; copy it there (.cpu() or .get())")
        try:
            return numpy.from_dlpack(value)
        except Exception as error:  # what libraries raise here is of any kind
            raise ValueError(f"{what}: is not given by DLPack: {' '.join(str(error).split())}") from None
    try:
        return numpy.asarray(value)
    except ValueError:  # rows of different lengths
        raise ValueError(f"{what}: is no array; give rows of equal lengths") from None
