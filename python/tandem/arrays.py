# SPDX-License-Identifier: MIT
"""Converts users' arrays in host memory to the form that the library reads: contiguous rows of one type."""

from collections.abc import Mapping

import numpy

from .arguments import integer_of

POSE = 7  # columns of a pose: tx ty tz qw qx qy qz
LARGEST_ERROR = 1e-4  # largest relative change of a length that counts as rounding
CPU, CUDA_HOST = 1, 3  # DLPack's numbers of memory types
KINDS = {
    2: "CUDA's",
    4: "OpenCL's",
    7: "Vulkan's",
    8: "Metal's",
    10: "ROCm's",
    13: "CUDA's managed",
    14: "oneAPI's",
}


def host_array(value, what, columns, dtype=numpy.float64):
    """`value` as a contiguous array (rows, columns) of `dtype`; poses can also be (n, 4, 4) matrices. A NumPy
    array, or a host array with __dlpack__, keeps its memory where it has this form already; otherwise the
    result is a copy. Raises ValueError or TypeError, whose one-line message begins with `what`."""
    refuse_mapping(value, what)
    array = numpy_array(value, what)
    if columns == POSE and array.ndim == 3 and array.shape[1:] == (4, 4):
        array = _rows_of_matrices(array, what)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(
            f"{what}: shape {array.shape}; expected (n, {columns})"
            + (" or (n, 4, 4)" if columns == POSE else "")
        )
    if numpy.issubdtype(dtype, numpy.integer):
        if array.dtype.kind not in "iu":
            raise TypeError(f"{what}: type {array.dtype}; expected integers")
        if array.size and (array.min() < 0 or array.max() > numpy.iinfo(dtype).max):
            raise ValueError(
                f"{what}: numbers from {array.min()} to {array.max()}; expected 0 to {numpy.iinfo(dtype).max}"
            )
    elif array.dtype.kind not in "iuf":
        raise TypeError(
            f"{what}: type {array.dtype}; expected real numbers ({numpy.dtype(dtype)} is read without a copy)"
        )
    return numpy.require(array, dtype, "CA")


def host_numbers(value, what):
    """`value` as a contiguous array (n,) of float64. Raises as host_array()."""
    refuse_mapping(value, what)
    array = numpy_array(value, what)
    if array.ndim != 1:
        raise ValueError(f"{what}: shape {array.shape}; expected (n,)")
    if array.dtype.kind not in "iuf":
        raise TypeError(f"{what}: type {array.dtype}; expected real numbers")
    return numpy.require(array, numpy.float64, "CA")


def refuse_mapping(value, what):
    """Raises TypeError for a mapping, where arrays of all bodies are expected."""
    if isinstance(value, Mapping):
        raise TypeError(f"{what}: is a mapping of some bodies, which update() takes; give all bodies")


def stream_address(stream):
    """Address of a CUstream. `stream`: that address, or a stream of CuPy (.ptr), of PyTorch (.cuda_stream) or
    with __cuda_stream__."""
    if hasattr(stream, "__cuda_stream__"):
        stream = stream.__cuda_stream__()[1]
    for name in ("cuda_stream", "ptr"):
        stream = getattr(stream, name, stream)
    address = integer_of(stream, "stream", "a CUDA stream or its address")
    if address < 0:
        raise ValueError(f"stream: {address} is not an address")
    return address


def numpy_array(value, what):
    """`value` as a NumPy array, without a copy if it is an array already."""
    if any(
        isinstance(one, numpy.ma.MaskedArray)
        for one in (value, *(value if isinstance(value, (list, tuple)) else ()))
    ):
        raise ValueError(
            f"{what}: is a masked array, whose mask would be lost; give .filled(value), or .data if every number counts"
        )
    if isinstance(value, numpy.ndarray):
        return value
    if hasattr(value, "__dlpack_device__"):
        kind = int(value.__dlpack_device__()[0])
        if kind not in (CPU, CUDA_HOST):
            raise ValueError(
                f"{what}: is in {KINDS.get(kind, 'a device')} memory; copy it to the host's memory (.cpu() or .get())"
            )
        try:
            return numpy.from_dlpack(value)
        except Exception as error:  # libraries raise exceptions of any type
            raise ValueError(f"{what}: __dlpack__ failed: {' '.join(str(error).split())}") from None
    try:
        return numpy.asarray(value)
    except ValueError:  # rows of different lengths
        raise ValueError(f"{what}: is not an array; give rows of equal lengths") from None


def _rows_of_matrices(matrices, what):
    """Rows tx ty tz qw qx qy qz of 4 x 4 matrices. Raises ValueError or TypeError for a matrix that is not a
    rotation and a translation."""
    if matrices.dtype.kind not in "iuf":
        raise TypeError(f"{what}: type {matrices.dtype}; expected real numbers")
    matrices = matrices.astype(numpy.float64)
    turns, moves = matrices[:, :3, :3], matrices[:, :3, 3]

    def refuse(wrong, message):
        if wrong.any():
            raise ValueError(f"{what}: matrix {int(wrong.argmax())} {message}")

    refuse(~numpy.isfinite(matrices).all(axis=(1, 2)), "is not finite")
    refuse(
        (abs(matrices[:, 3] - [0, 0, 0, 1]) > 0).any(axis=1),
        "has another last row than 0 0 0 1; the translation is in the last column",
    )
    refuse(
        _stretches(turns) > LARGEST_ERROR,
        "scales or shears; give a rotation and a translation, and scale the mesh",
    )
    refuse(numpy.linalg.det(turns) < 0, "mirrors; give a rotation and a translation")
    return numpy.hstack((moves, _quaternions(turns)))


def _stretches(turns):
    """The largest relative change of a length by each of (n, 3, 3) matrices, from their singular values; 0
    where it is below 3/4 of LARGEST_ERROR."""
    off = abs(turns @ turns.transpose(0, 2, 1) - numpy.eye(3)).max(axis=(1, 2), initial=0)
    doubtful = (
        off > LARGEST_ERROR / 2
    )  # lengths change by at most 3/2 of `off`, because their squares change by at most 3 times it
    stretches = numpy.zeros(len(turns))
    stretches[doubtful] = abs(numpy.linalg.svd(turns[doubtful], compute_uv=False) - 1).max(axis=1, initial=0)
    return stretches


def _quaternions(turns):
    """Unit quaternions w x y z of (n, 3, 3) rotations. Row i of `products` is the quaternion times four of
    its component i; the one of the largest component has the most accurate digits."""
    (a, b, c), (d, e, f), (g, h, i) = turns.transpose(1, 2, 0)
    products = numpy.array(
        [
            [1 + a + e + i, h - f, c - g, d - b],
            [h - f, 1 + a - e - i, b + d, c + g],
            [c - g, b + d, 1 - a + e - i, f + h],
            [d - b, c + g, f + h, 1 - a - e + i],
        ]
    )
    largest = products.diagonal().argmax(axis=1)
    chosen = products[largest, :, numpy.arange(len(turns))]
    return chosen / numpy.linalg.norm(chosen, axis=1, keepdims=True)
