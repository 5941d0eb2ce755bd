# SPDX-License-Identifier: MIT
"""Changes of some bodies of a frame, from the arguments of Collider.update()."""

from collections.abc import Mapping

import numpy

from .arrays import POSE, host_array, numpy_array


def changes_of(poses, vertices, prefix, numbering):
    """What _core.Collider.update takes for a frame: numbers of rigid bodies, a row of their poses each or
    None, and {number: vertices} or None. `prefix`: how the names of the arguments begin. Raises ValueError or
    TypeError, whose one-line message begins with the name."""
    what = f"{prefix}poses"
    by_number = _by_number(poses, what, numbering)
    for number in by_number:
        if number in numbering.deformable:
            raise ValueError(
                f"{what}: body {numbering.name(number)} is deformable and has no pose; give its vertices"
            )
    moved = _by_number(vertices, f"{prefix}vertices", numbering)
    for number in moved:
        if number not in numbering.deformable:
            raise ValueError(
                f"{prefix}vertices: body {numbering.name(number)} is not deformable; make the collider with it in deformable"
            )
    rows = _rows(by_number, what, numbering) if by_number else None
    return list(by_number), rows, moved or None


def _by_number(changes, what, numbering):
    if changes is None:
        return {}
    if not isinstance(changes, Mapping):
        raise TypeError(
            f"{what}: type {type(changes).__name__}; expected a mapping {{{numbering.key}: array}}, or all bodies for run()"
        )
    return {numbering.number(key, what): array for key, array in changes.items()}


def _rows(by_number, what, numbering):
    """Poses as rows tx ty tz qw qx qy qz, converted in one step if all are of one form."""
    values = list(by_number.values())
    try:
        rows = host_array(values, what, POSE)
        if len(rows) == len(values):
            return rows
    except (TypeError, ValueError):
        pass  # the row of a body has the better message
    return numpy.concatenate(
        [_row(value, f"{what} of body {numbering.name(number)}") for number, value in by_number.items()]
    )


def _row(value, what):
    array = numpy_array(value, what)
    if array.shape not in ((POSE,), (4, 4)):
        raise ValueError(f"{what}: shape {array.shape}; expected (7,) or (4, 4)")
    return host_array(array[None], what, POSE)
