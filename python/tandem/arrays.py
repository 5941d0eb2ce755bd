# SPDX-License-Identifier: MIT
"""Arrays of users in the host's memory as the library takes them: rows beside each other, of one type."""
import numpy

CPU, CUDA_HOST = 1, 3  # kinds of memory as DLPack numbers them
KINDS = {2: "CUDA's", 4: "OpenCL's", 7: "Vulkan's", 8: "Metal's", 10: "ROCm's", 13: "CUDA's managed", 14: "oneAPI's"}


def host_array(value, what, columns, dtype=numpy.float64):
    """`value` as an array (rows, columns) of `dtype` with its rows beside each other. It is the same memory where `value`, a
    NumPy array or anything of the host's that has __dlpack__, is so already, and a copy otherwise. Raises ValueError or
    TypeError: one line that begins with `what`."""
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
    return numpy.require(array, dtype, "CA")


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
