# SPDX-License-Identifier: MIT
"""Lines of files of records, as 'tandem run --out' writes them: one JSON object a line."""
import json
import lzma
import math
import os
import re
import warnings

WHAT_TO_GIVE = "give files that 'tandem run --out' wrote"
OLDEST, NEWEST = 2, 4
# What a reader of fields raises where a record is not of its schema.
FIELD_ERRORS = (KeyError, TypeError, AttributeError, IndexError, ValueError, ArithmeticError)
_LARGE = re.compile(rb"[eE]\+?\d{3}|\d{300}")  # a number that may be beyond all doubles
_LONE_SURROGATE = re.compile(rb"\\u[dD][89a-fA-F]")  # or a pair


class RecordError(ValueError):
    """One line: FILE:LINE, what it is instead of a record, and what to do."""


def _open(path):
    return lzma.open(path, "rb") if os.fspath(path).endswith(".xz") else open(path, "rb")


def _finite(text):
    """A number of a JSON text. Raises ValueError for one that no double holds, for NaN and for Infinity."""
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text} is not JSON")
    return value


def parsed(text, place, what_to_give=WHAT_TO_GIVE):
    """The value that the bytes of a line are in JSON, which has neither NaN nor halves of characters. Raises RecordError."""
    try:
        value = json.loads(text, parse_float=_finite if _LARGE.search(text) else float, parse_constant=_finite)
        if _LONE_SURROGATE.search(text):
            json.dumps(value, ensure_ascii=False).encode()
    except (ValueError, RecursionError):
        raise RecordError(f"{place}: is not JSON; {what_to_give}") from None
    return value


def checked_cell(record, place):
    """The record, where it is one of a cell and of a schema that this package knows. Raises RecordError otherwise."""
    if not isinstance(record, dict) or "schema" not in record or "key" not in record:
        raise RecordError(f"{place}: is no record of a cell; {WHAT_TO_GIVE}")
    schema = record["schema"]
    if not isinstance(schema, int):
        raise RecordError(f"{place}: is no record of a cell (schema {schema!r}); {WHAT_TO_GIVE}")
    if schema < OLDEST:
        raise RecordError(f"{place}: a record of schema {schema}; bring it to schema {NEWEST} with scripts/convert_records")
    if schema > NEWEST:
        raise RecordError(f"{place}: a record of schema {schema}, and this package knows {OLDEST} to {NEWEST}; take the package "
                          "of the program that wrote it")
    return record


def _cell(text, place):
    return checked_cell(parsed(text, place), place)


def numbered(path, torn, check=_cell):
    """(line number, record) of every record of a file. A last line without an end is left out: `torn` is called with what to say of it.
    `check` makes a record of the bytes of a line and "FILE:LINE"; without it the records are of cells. Raises RecordError."""
    number = 0
    try:
        with _open(path) as file:
            for number, line in enumerate(file, 1):
                if not line.endswith(b"\n"):
                    torn(f"{path}:{number}: the last line has no end, being cut off or still written: it is ignored")
                    return
                yield number, check(line, f"{path}:{number}")
    except (OSError, EOFError, lzma.LZMAError) as problem:
        reason = "is a folder" if isinstance(problem, IsADirectoryError) else getattr(problem, "strerror", None) or problem
        raise RecordError(f"{path}: cannot be read ({reason}); name a file of records") from None
    if number == 0:
        raise RecordError(f"{path}: is empty; name a file of records")


def each(path):
    """Every record of a file and "FILE:LINE"; a last line without an end is warned of and left out. Raises RecordError."""
    for number, record in numbered(path, lambda message: warnings.warn(message, stacklevel=4)):
        yield record, f"{path}:{number}"


def samples_by_round(record):
    """The samples of a record in nanoseconds, by the number of their round."""
    total = record.get("total_ns") or {}
    samples = total.get("samples", [])
    rounds = {}
    for of, ns in zip(total.get("rounds", range(len(samples))), samples):
        rounds.setdefault(of, []).append(ns)
    return rounds


def goes_on_with(more, less):
    """Whether rounds have all of the others, and some besides: the same run, gone on with."""
    return len(more) > len(less) > 0 and all(more.get(of) == samples for of, samples in less.items())


def run_of(record):
    """What two records of one cell in one run of the program share; None where the run is not known."""
    session = record.get("session")
    return session and (record["key"], session, tuple(device["id"] for device in record["devices"]), record.get("chosen") is not None)


def merged(paths):
    """Every record of several files, its place and its file, each result once: a record whose rounds another one of its key goes on
    with is left out, and so is a copy. Raises RecordError for files that are none, and for two records of one cell in one run that
    contradict each other."""
    rows = [(record, place, path) for path in paths for record, place in each(path)]
    by_key = {}
    for number, (record, *_) in enumerate(rows):
        by_key.setdefault(record["key"], []).append(number)
    dropped = set()
    for numbers in by_key.values():
        if len(numbers) > 1:
            dropped |= _superseded([(number, *rows[number][:2]) for number in numbers])
    return [row for number, row in enumerate(rows) if number not in dropped]


def _superseded(rows):
    """Numbers of the records of one key that take no part."""
    rounds, runs = {}, {}
    for number, record, place in rows:
        try:
            rounds[number], runs[number] = samples_by_round(record), run_of(record)
        except (KeyError, TypeError, AttributeError):
            raise RecordError(f"{place}: a record that lacks fields of its schema; {WHAT_TO_GIVE}") from None
    dropped = {number for number in rounds if any(goes_on_with(rounds[other], rounds[number]) for other in rounds)}
    first = {}
    for number, record, place in rows:
        run = runs[number]
        if number in dropped or not run:
            continue
        if run not in first:
            first[run] = record, place
        elif record == first[run][0]:
            dropped.add(number)
        else:
            raise RecordError(f"{first[run][1]} and {place}: contradict each other, being of one cell in one run; leave one of them out")
    return dropped
