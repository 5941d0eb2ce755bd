# SPDX-License-Identifier: MIT
"""Fields of records: those that are columns of tables, which are declared in harness/ and come from fields.json,
and functions that read a field. Needs only the standard library."""

import functools
import json
import pathlib

_FIELDS = json.loads((pathlib.Path(__file__).parent / "fields.json").read_text(encoding="utf-8"))["columns"]
TYPES = {
    "text": (str, "string"),
    "integer": (int, "number"),
    "number": ((int, float), "number"),
    "boolean": (bool, "truth value"),
}
NEEDED = "key status algorithm preset scene scene_digest first_frame last_frame dirty".split()


def at(record, *path):
    """The value at a path of names; None if a name of the path is missing."""
    for name in path:
        if not isinstance(record, dict):
            return None
        record = record.get(name)
    return record


def frames_of(record):
    """The number of frames in a sample of a record."""
    return record["frames"]["last"] - record["frames"]["first"] + 1


def milliseconds(ns, frames):
    """Milliseconds per frame from nanoseconds of all frames; None for None."""
    return None if ns is None else ns / frames / 1e6


def checked(value, name, kind="text"):
    """A value of this kind. Raises TypeError."""
    types, word = TYPES[kind]
    if not isinstance(value, types) or isinstance(value, bool) is not (kind == "boolean"):
        raise TypeError(f"{name} must be a {word}")
    return value


def needed(part, *path, kind="text"):
    """The value of this kind at a path. Raises KeyError and TypeError."""
    return checked(functools.reduce(lambda value, name: value[name], path, part), path[-1], kind)


def text_of(part, name):
    """An optional text; empty if it is unknown."""
    value = part.get(name)
    return "" if value is None else checked(value, name)


class Declared:
    """A field of fields.json. Unknown texts are empty, and other unknown values None."""

    def __init__(self, column, path, type):
        self.name, self.path, self.kind = column, path, type

    def __get__(self, cell, owner=None):
        value = at(cell.record, *self.path)
        if value is None:
            return "" if self.kind == "text" else None
        return checked(value, self.path[-1], self.kind)

    def check(self, cell):
        """Raises TypeError for a value of another type, and KeyError for a missing value that is needed."""
        self.__get__(cell)
        if self.name in NEEDED:
            needed(cell.record, *self.path, kind=self.kind)


DECLARED = [Declared(**field) for field in _FIELDS]
