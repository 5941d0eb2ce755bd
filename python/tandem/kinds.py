# SPDX-License-Identifier: MIT
"""Reads files that have records of several kinds."""

import contextlib
import json

from . import lines

SCHEMAS = {"cell": 4, "verdict": 4, "profile": 2, "simulation": 3, "ceilings": 1}
WHAT_TO_GIVE = "give files that 'tandem run --out', 'profile --out', 'simulate --record' or 'devices --measure --out' wrote"
CONVERT = "convert it with scripts/convert_records, which is installed as tandem-convert-records"
_MARKS = {
    "profile_of": "profile",
    "key": "cell",
    "copy_bytes_per_s": "ceilings",
}  # the first field present determines the kind


def kind_of(record):
    """Kind of a record, a name of SCHEMAS; None if it is not a record of tandem."""
    if not isinstance(record, dict):
        return None
    if record.get("kind") in ("step", "run"):
        return "simulation"
    if record.get("kind") == "verdict":
        return "verdict"
    return next((kind for field, kind in _MARKS.items() if field in record), None)


def checked(text, location):
    """The kind and the record of the bytes of a line. Raises RecordError."""
    record = lines.parsed(text, location, WHAT_TO_GIVE)
    kind = kind_of(record)
    if kind is None:
        raise lines.RecordError(f"{location}: is no record of tandem; {WHAT_TO_GIVE}")
    schema = record.get("schema")
    if kind == "cell":
        lines.checked_cell(record, location)
    elif schema != SCHEMAS[kind]:
        is_newer = isinstance(schema, int) and schema > SCHEMAS[kind]
        action = "use the package of the program that wrote it" if is_newer else CONVERT
        raise lines.RecordError(
            f"{location}: a record of schema {json.dumps(schema)}, but the schema of a {kind} is {SCHEMAS[kind]}; {action}"
        )
    return kind, record


def each(path, torn):
    """Yields ("FILE:LINE", kind, record) for every record of a file. Leaves out a last line without an end,
    and calls `torn` with a message about it. Raises RecordError."""
    number = 0
    for number, (kind, record) in lines.numbered(path, torn, checked):
        yield f"{path}:{number}", kind, record
    if number == 0:
        raise lines.RecordError(f"{path}: its only line has no end; name a file of records")


@contextlib.contextmanager
def fields_of(kind, location):
    """Context manager for code that reads fields of a record: raises RecordError if they do not match its
    schema."""
    try:
        yield
    except lines.RecordError:
        raise
    except lines.FIELD_ERRORS as problem:
        raise lines.RecordError(
            f"{location}: is no record of a {kind} ({problem!r}); {WHAT_TO_GIVE}"
        ) from None
