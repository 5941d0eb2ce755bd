# SPDX-License-Identifier: MIT
"""Records of every kind, by the fields that tell the kinds apart."""
import contextlib

from . import lines

SCHEMAS = {"cell": 4, "profile": 2, "simulation": 3, "ceilings": 1}
_MARKS = {"profile_of": "profile", "key": "cell", "copy_bytes_per_s": "ceilings"}  # the first that a record has says its kind


def kind_of(record):
    """A name of SCHEMAS; None of what is no record of tandem."""
    if not isinstance(record, dict):
        return None
    if record.get("kind") in ("step", "run"):
        return "simulation"
    return next((kind for field, kind in _MARKS.items() if field in record), None)


def _checked(text, place):
    record = lines.parsed(text, place)
    kind = kind_of(record)
    if kind is None:
        raise lines.RecordError(f"{place}: is no record of tandem; {lines.WHAT_TO_GIVE}")
    schema = record.get("schema")
    if schema == SCHEMAS[kind]:
        return kind, record
    if isinstance(schema, int) and schema > SCHEMAS[kind]:
        todo = "take the package of the program that wrote it"
    else:
        todo = "bring it to that with scripts/convert_records, which is installed as tandem-convert-records"
    raise lines.RecordError(f"{place}: a record of schema {schema}, and the schema of a {kind} is {SCHEMAS[kind]}; {todo}")


def each(path, torn):
    """("FILE:LINE", kind, record) of every record of a file, a line at a time. A last line without an end is left out: `torn` is called
    with what to say of it. Raises RecordError."""
    number = 0
    for number, (kind, record) in lines.numbered(path, torn, _checked):
        yield f"{path}:{number}", kind, record
    if number == 0:
        raise lines.RecordError(f"{path}: its only line has no end; name a file of records")


@contextlib.contextmanager
def fields_of(kind, place):
    """Within it, what reads fields of a record raises RecordError where they are not those of its schema."""
    try:
        yield
    except lines.RecordError:
        raise
    except lines.FIELD_ERRORS as problem:
        raise lines.RecordError(f"{place}: is no record of a {kind} ({problem!r}); {lines.WHAT_TO_GIVE}") from None
