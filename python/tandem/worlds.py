# SPDX-License-Identifier: MIT
"""Numbers of bodies and arrays of several worlds. The core counts the bodies through all worlds: world *
bodies of a world + body."""

import math

import numpy

from . import _core
from .arguments import body_pairs_of, integer_of, list_of, number_of
from .arrays import numpy_array, refuse_mapping

BYTES_OF_BODY = 256  # at least, of a collider: in its scene, its frames and on the device


class Numbering:
    """bodies: those of a world. worlds: None for a collider without them, whose calls do not number worlds.
    deformable: bodies of a world. All methods raise ValueError or TypeError, whose one-line message begins
    with `what`."""

    def __init__(self, bodies=0, worlds=None, deformable=()):
        self.bodies = bodies
        self.worlds = None if worlds is None else integer_of(worlds, "worlds", "the number of worlds")
        if self.count < 1 or self.count * bodies >= 2**31:
            raise ValueError(
                f"worlds: {worlds} with {bodies} bodies each; give 1 or more, with fewer than 2^31 bodies in all"
            )
        _core.refuse_beyond_memory(f"{self.count * bodies} bodies", BYTES_OF_BODY * self.count * bodies)
        self.deformable = frozenset(
            world * bodies + body for world in range(self.count) for body in deformable
        )
        self.key = "body" if worlds is None else "(world, body)"

    @property
    def count(self):
        """Number of worlds."""
        return 1 if self.worlds is None else self.worlds

    def number(self, key, what):
        """The number of `key`, checked: of a body, or with worlds of (world, body)."""
        if self.worlds is None:
            return _below(key, self.bodies, what, "body")
        if not isinstance(key, tuple) or len(key) != 2:
            raise TypeError(f"{what}: {key!r}; expected (world, body)")
        return _below(key[0], self.worlds, what, "world") * self.bodies + _below(
            key[1], self.bodies, what, "body"
        )

    def name(self, number):
        """A body as messages name it."""
        return str(number) if self.worlds is None else "{1} of world {0}".format(*divmod(number, self.bodies))

    def in_all_worlds(self, pairs):
        """Pairs of bodies of one world, in each of them."""
        return [
            (world * self.bodies + a, world * self.bodies + b)
            for world in range(self.count)
            for a, b in pairs
        ]

    def pairs_of(self, pairs, what):
        """Pairs of numbers, of pairs of bodies or with worlds of rows (world, body, body)."""
        if self.worlds is None:
            return body_pairs_of(pairs, what, self.bodies)
        result = []
        for i, row in enumerate(list_of(pairs, what)):
            row = list_of(row, f"{what}[{i}]")
            if len(row) != 3:
                raise ValueError(f"{what}[{i}]: {len(row)} numbers; expected (world, body, body)")
            result.append(tuple(self.number((row[0], body), f"{what}[{i}]") for body in row[1:]))
        return result

    def poses_of(self, poses, what):
        """Poses as rows of all bodies: of arrays on any device a view, if they are contiguous."""
        if poses is None or self.worlds is None:
            return poses
        refuse_mapping(poses, what)
        poses, shape = _with_shape(poses, what)
        expected = (self.worlds, self.bodies)
        if shape[:2] != expected or shape[2:] not in ((7,), (4, 4)):
            raise ValueError(f"{what}: shape {shape}; expected {(*expected, 7)} or {(*expected, 4, 4)}")
        return poses.reshape((math.prod(expected), *shape[2:]))

    def vertices_of(self, vertices, what):
        """{number: (n, 3)} of {body of a world: (worlds, n, 3)}."""
        if vertices is None or self.worlds is None:
            return vertices
        result = {}
        for body, array in vertices.items():
            array, shape = _with_shape(array, f"{what} of body {body}")
            if len(shape) != 3 or shape[0] != self.worlds:
                raise ValueError(f"{what} of body {body}: shape {shape}; expected ({self.worlds}, n, 3)")
            result.update({world * self.bodies + body: array[world] for world in range(self.worlds)})
        return result

    def rows_of(self, pairs):
        """Rows of an answer, with worlds with their number in front."""
        if self.worlds is None:
            return pairs
        world = pairs[:, 0] // self.bodies
        inside = pairs - numpy.multiply.outer(world * self.bodies, numpy.array([1, 0, 1, 0], pairs.dtype))
        return numpy.column_stack((world, inside))


def _with_shape(array, what):
    """`array` with its shape; what is no array of a device becomes a NumPy array."""
    if not hasattr(array, "reshape") or isinstance(array, numpy.ma.MaskedArray):
        array = numpy_array(array, what)
    return array, tuple(array.shape)


def _below(value, count, what, of):
    number = number_of(value, what, of)
    if number >= count:
        raise ValueError(f"{what}: {number} is not the number of a {of}; there are {count}, numbered from 0")
    return number
