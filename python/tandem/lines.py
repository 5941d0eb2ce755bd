# SPDX-License-Identifier: MIT
"""Lines of files of records, as 'tandem run --out' writes them: one JSON object a line."""
import json
import lzma
import os
import warnings

WHAT_TO_GIVE = "give files that 'tandem run --out' wrote"
OLDEST, NEWEST = 2, 3


class RecordError(ValueError):
    """One line: FILE:LINE, what it is instead of a record, and what to do."""


def _open(path):
    return lzma.open(path, "rb") if os.fspath(path).endswith(".xz") else open(path, "rb")


def _checked(text, place):
    try:
        record = json.loads(text)
    except (ValueError, RecursionError):
        raise RecordError(f"{place}: is not JSON; {WHAT_TO_GIVE}") from None
    if not isinstance(record, dict) or "schema" not in record or "key" not in record:
        raise RecordError(f"{place}: is no record of a cell; {WHAT_TO_GIVE}")
    schema = record["schema"]
    if not isinstance(schema, int):
        raise RecordError(f"{place}: is no record of a cell (schema {schema!r}); {WHAT_TO_GIVE}")
    if schema < OLDEST:
        raise RecordError(f"{place}: a record of schema {schema}; bring it to schema {NEWEST} with scripts/convert_records")
    if schema > NEWEST:
        raise RecordError(f"{place}: a record of schema {schema}, and this package knows {OLDEST} and {NEWEST}; take the package "
                          "of the program that wrote it")
    return record


def each(path):
    """Every record of a file and "FILE:LINE"; a last line without an end is warned of and left out. Raises RecordError."""
    number = 0
    try:
        with _open(path) as file:
            for number, line in enumerate(file, 1):
                if not line.endswith(b"\n"):
                    warnings.warn(f"{path}:{number}: the last line has no end, being cut off or still written: it is ignored", stacklevel=3)
                    return
                yield _checked(line, f"{path}:{number}"), f"{path}:{number}"
    except (OSError, EOFError, lzma.LZMAError) as problem:
        reason = getattr(problem, "strerror", None) or problem
        raise RecordError(f"{path}: cannot be read ({reason}); name a file of records") from None
    if number == 0:
        raise RecordError(f"{path}: has no record; name a file of records")
