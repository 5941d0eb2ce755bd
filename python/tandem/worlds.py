# SPDX-License-Identifier: MIT
"""Numbers of bodies. A collider of several worlds counts the bodies through all of them: world * bodies of a world + body."""
from .arguments import number_of


class Numbering:
    """bodies: those of a world. worlds: None for a collider without them, whose calls do not number worlds. deformable: numbers of bodies, counted
    through all worlds."""
    def __init__(self, bodies, worlds, deformable):
        self.bodies, self.worlds, self.deformable = bodies, worlds, frozenset(deformable)
        self.key = "body" if worlds is None else "(world, body)"

    def number(self, key, what):
        """The number of `key`, checked: of a body, or with worlds of (world, body)."""
        if self.worlds is None:
            return _below(key, self.bodies, what, "body")
        if not isinstance(key, tuple) or len(key) != 2:
            raise TypeError(f"{what}: {key!r}; expected (world, body)")
        return _below(key[0], self.worlds, what, "world") * self.bodies + _below(key[1], self.bodies, what, "body")

    def name(self, number):
        """A body as messages name it."""
        return str(number) if self.worlds is None else "{1} of world {0}".format(*divmod(number, self.bodies))


def _below(value, count, what, of):
    number = number_of(value, what, of)
    if number >= count:
        raise ValueError(f"{what}: {number} is not the number of a {of}; there are {count}, numbered from 0")
    return number
