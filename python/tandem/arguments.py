# SPDX-License-Identifier: MIT
"""Checks of a collider's arguments, as numbers of bodies, groups and settings. All raise ValueError or
TypeError, whose one-line message begins with the name of the argument."""

from __future__ import annotations

import operator
import os
from collections.abc import Mapping

import numpy

from ._core import Mesh


def list_of(value, what):
    """The elements of any iterable except texts, paths, meshes, and mappings, whose keys alone would be taken."""
    if isinstance(value, (str, bytes, os.PathLike, Mesh, Mapping)):
        raise TypeError(f"{what}: type {type(value).__name__}; expected a list")
    try:
        return list(value)
    except TypeError:
        raise TypeError(f"{what}: type {type(value).__name__}; expected a list") from None


def integer_of(value, what, expected):
    """An integer of any type with __index__ except bool: a list of these is a mask, which nothing here takes."""
    try:
        if not isinstance(value, (bool, numpy.bool_)):
            return operator.index(value)
    except TypeError:
        pass
    raise TypeError(f"{what}: type {type(value).__name__}; expected {expected}")


def number_of(value, what, of="mesh"):
    """An integer from 0 on."""
    number = integer_of(value, what, f"the number of a {of}")
    if not 0 <= number < 2**32:
        raise ValueError(f"{what}: {number} is not the number of a {of}; numbers start at 0")
    return number


def flags_of(deformable, bodies):
    """One bool per body, of True, False or the numbers of some bodies."""
    if isinstance(deformable, (bool, numpy.bool_)):
        return [bool(deformable)] * bodies
    flags = [False] * bodies
    for i, value in enumerate(list_of(deformable, "deformable")):
        number = number_of(value, f"deformable[{i}]", "body")
        if number >= bodies:
            raise ValueError(
                f"deformable[{i}]: {number} is not the number of a body; there are {bodies}, numbered from 0"
            )
        flags[number] = True
    return flags


def meshes_of_bodies(bodies, meshes):
    """The number of each body's mesh; None: each mesh is a body."""
    if bodies is None:
        return list(range(meshes))
    return [number_of(value, f"bodies[{i}]") for i, value in enumerate(list_of(bodies, "bodies"))]


def filters_of(body_groups, meets, bodies):
    """The bits of its groups, and of those that it meets, for each body."""
    groups = _bits_of_bodies(body_groups, "body_groups", 1, bodies)
    return list(zip(groups, _bits_of_bodies(meets, "meets", 2**32 - 1, bodies)))


def _bits_of_bodies(lists, what, default, bodies):
    """The bits of a list of groups for each body; `default` for None."""
    if lists is None:
        return [default] * bodies
    given = list_of(lists, what)
    if len(given) != bodies:
        raise ValueError(f"{what}: {len(given)} lists for {bodies} bodies; give one per body")
    return [
        default if groups is None else _bits(groups, f"{what}[{body}]") for body, groups in enumerate(given)
    ]


def _bits(groups, what):
    bits = 0
    for group in list_of(groups, what):
        number = integer_of(group, what, "the number of a group")
        if not 0 <= number < 32:
            raise ValueError(f"{what}: {number} is not the number of a group; they are 0 to 31")
        bits |= 1 << number
    return bits


def body_pairs_of(pairs, what, bodies):
    """A list of pairs of numbers of bodies."""
    result = []
    for i, pair in enumerate(list_of(pairs, what)):
        numbers = [number_of(value, f"{what}[{i}]", "body") for value in list_of(pair, f"{what}[{i}]")]
        if len(numbers) != 2 or max(numbers) >= bodies:
            raise ValueError(f"{what}[{i}]: expected two bodies of {bodies}, numbered from 0")
        result.append(tuple(numbers))
    return result


def lists_of(groups):
    """`body_groups` or `meets` as lists, which can be pickled."""
    return None if groups is None else [None if one is None else list(one) for one in groups]


def text_of(value, name):
    """The text of a setting."""
    if isinstance(value, (bool, numpy.bool_)):
        return "yes" if value else "no"
    if isinstance(value, (str, int, numpy.integer)):
        return str(value)
    if isinstance(value, (float, numpy.floating)):
        return repr(float(value))
    raise TypeError(f"setting {name}: type {type(value).__name__}; expected a word or a number")
