# SPDX-License-Identifier: MIT
"""Reads files of records, as 'tandem run --out' writes them: one JSON object per line."""

import json
import lzma
import math
import os
import re

WHAT_TO_GIVE = "give files that 'tandem run --out' wrote"
RECORD_AGAIN = "record the cell again"
OLDEST, NEWEST = 2, 4
# Exceptions of code that reads fields of a record which does not match its schema.
FIELD_ERRORS = (KeyError, TypeError, AttributeError, IndexError, ValueError, ArithmeticError)
_LARGE = re.compile(rb"[eE]\+?\d{3}|\d{300}")  # a number that may exceed the range of double
_LONE_SURROGATE = re.compile(rb"\\u[dD][89a-fA-F]")  # also matches pairs, which are valid


class RecordError(ValueError):
    """A line or file without valid records. The message is one line: FILE:LINE, what is wrong, and what to do."""


def _open(path):
    return lzma.open(path, "rb") if os.fspath(path).endswith(".xz") else open(path, "rb")


def _finite(text):
    """A number of a JSON text. Raises ValueError for numbers beyond the range of double, NaN and Infinity."""
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text} is not JSON")
    return value


def parsed(text, location, what_to_give=WHAT_TO_GIVE):
    """The JSON value of the bytes of a line. Refuses NaN, Infinity and lone surrogates, which are not valid
    JSON. Raises RecordError."""
    try:
        value = json.loads(
            text, parse_float=_finite if _LARGE.search(text) else float, parse_constant=_finite
        )
        if _LONE_SURROGATE.search(text):
            json.dumps(value, ensure_ascii=False).encode()
    except (ValueError, RecursionError):
        raise RecordError(f"{location}: is not JSON; {what_to_give}") from None
    return value


def checked_cell(record, location):
    """The record, if it is a record of a cell and of a schema that this package reads. Raises RecordError
    otherwise."""
    if not isinstance(record, dict) or "schema" not in record or "key" not in record:
        raise RecordError(f"{location}: is no record of a cell; {WHAT_TO_GIVE}")
    schema = record["schema"]
    if not isinstance(schema, int):
        raise RecordError(f"{location}: is no record of a cell (schema {schema!r}); {WHAT_TO_GIVE}")
    if schema < OLDEST:
        raise RecordError(
            f"{location}: a record of schema {schema}; convert it to schema {NEWEST} with scripts/convert_records"
        )
    if schema > NEWEST:
        raise RecordError(
            f"{location}: a record of schema {schema}, but this package reads schemas {OLDEST} to {NEWEST}; use the package "
            "of the program that wrote it"
        )
    _check_samples(record, location)
    return record


def _check_samples(record, location):
    """Raises RecordError for a time of a replay that is no finite number above 0. Other types are for the
    readers of the field."""
    total = record.get("total_ns")
    samples = total.get("samples") if isinstance(total, dict) else None
    for ns in samples if isinstance(samples, list) else ():
        if isinstance(ns, (int, float)) and not 0 < ns < 2**63:
            raise RecordError(
                f"{location}: a sample of {str(ns)[:24]} ns is not a valid time; {RECORD_AGAIN}"
            )


def is_verdict(record):
    """Whether a line of a file of cells is a verdict on cells before it (results/verdict.schema.json)."""
    return isinstance(record, dict) and record.get("kind") == "verdict" and record.get("schema") == NEWEST


def _cell(text, location):
    record = parsed(text, location)
    return None if is_verdict(record) else checked_cell(record, location)


def numbered(path, torn, check=_cell):
    """Yields (line number, record) for every record of a file. Leaves out a last line without an end, and
    calls `torn` with a message about it. `check` makes a record of the bytes of a line and "FILE:LINE", or
    None for a line to skip; the default accepts cells and skips verdicts. Raises RecordError."""
    number = 0
    try:
        with _open(path) as file:
            for number, line in enumerate(file, 1):
                if not line.endswith(b"\n"):
                    torn(
                        f"{path}:{number}: the last line has no end and is ignored; it is cut off or still being written"
                    )
                    return
                record = check(line, f"{path}:{number}")
                if record is not None:
                    yield number, record
    except (OSError, EOFError, lzma.LZMAError) as problem:
        reason = (
            "is a folder"
            if isinstance(problem, IsADirectoryError)
            else getattr(problem, "strerror", None) or problem
        )
        raise RecordError(f"{path}: cannot be read ({reason}); name a file of records") from None
    if number == 0:
        raise RecordError(f"{path}: is empty; name a file of records")
