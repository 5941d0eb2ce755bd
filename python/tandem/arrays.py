# SPDX-License-Identifier: MIT
"""Converts users' arrays in host memory to the form that the library reads: contiguous rows of one type."""
import numpy

CPU, CUDA_HOST = 1, 3  # DLPack's numbers of memory types
KINDS = {2: "CUDA's", 4: "OpenCL's", 7: "Vulkan's", 8: "Metal's", 10: "ROCm's", 13: "CUDA's managed", 14: "oneAPI's"}


def host_array(value, what, columns, dtype=numpy.float64):
    """`value` as a contiguous array (rows, columns) of `dtype`. A NumPy array, or a host array with __dlpack__, keeps its memory
    where it has this form already; otherwise the result is a copy. Raises ValueError or TypeError, whose one-line message begins
    with `what`."""
    array = _numpy_array(value, what)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(f"{what}: shape {array.shape}; expected (n, {columns})")
    if numpy.issubdtype(dtype, numpy.integer):
        if array.dtype.kind not in "iu":
            raise TypeError(f"{what}: type {array.dtype}; expected integers")
        if array.size and (array.min() < 0 or array.max() > numpy.iinfo(dtype).max):
            raise ValueError(f"{what}: numbers from {array.min()} to {array.max()}; expected 0 to {numpy.iinfo(dtype).max}")
    elif array.dtype.kind not in "iuf":
        raise TypeError(f"{what}: type {array.dtype}; expected real numbers ({numpy.dtype(dtype)} is read without a copy)")
    return numpy.require(array, dtype, "CA")


def stream_address(stream):
    """Address of a CUstream. `stream`: that address, or a stream of CuPy (.ptr), of PyTorch (.cuda_stream) or with __cuda_stream__."""
    if hasattr(stream, "__cuda_stream__"):
        stream = stream.__cuda_stream__()[1]
    for name in ("cuda_stream", "ptr"):
        stream = getattr(stream, name, stream)
    if isinstance(stream, bool) or not hasattr(stream, "__index__"):
        raise TypeError(f"stream: type {type(stream).__name__}; expected a CUDA stream or its address")
    if stream.__index__() < 0:
        raise ValueError(f"stream: {stream.__index__()} is not an address")
    return stream.__index__()


def _numpy_array(value, what):
    """`value` as a NumPy array, without a copy if it is an array already."""
    if isinstance(value, numpy.ndarray):
        return value
    if hasattr(value, "__dlpack_device__"):
        kind = int(value.__dlpack_device__()[0])
        if kind not in (CPU, CUDA_HOST):
            raise ValueError(f"{what}: is in {KINDS.get(kind, 'a device')} memory; copy it to the host's memory (.cpu() or .get())")
        try:
            return numpy.from_dlpack(value)
        except Exception as error:  # libraries raise exceptions of any type
            raise ValueError(f"{what}: __dlpack__ failed: {' '.join(str(error).split())}") from None
    try:
        return numpy.asarray(value)
    except ValueError:  # rows of different lengths
        raise ValueError(f"{what}: is not an array; give rows of equal lengths") from None
