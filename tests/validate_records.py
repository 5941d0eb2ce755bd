#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""validate_records.py [FILE.jsonl|FILE.jsonl.xz ...]: checks records against results/record.schema.json.
Files with other names have other schemas of results/: ceilings*.jsonl (ceilings), simulation*.jsonl, sim-*,
host-*, serial-*, parallel-* and solver-*.jsonl (simulation), steps.jsonl (paper), tried*.jsonl (tried),
profile*.jsonl and profile records in any file (profile), lines of kind verdict in any file (verdict). Without
files it checks all committed ones. Exit code 1; FILE:LINE and position of the first errors are printed."""

import functools
import json
import lzma
import pathlib
import sys

import fastjsonschema
import jsonschema

ROOT = pathlib.Path(__file__).resolve().parent.parent
SHOWN = 10
# Schema by the beginning of a file's name; files of 'tandem paper' are named after its steps.
KINDS = {
    "ceilings": "ceilings",
    "simulation": "simulation",
    "profile": "profile",
    "steps.": "paper",
    "tried": "tried",
    "sim-": "simulation",
    "host-": "simulation",
    "serial-": "simulation",
    "parallel-": "simulation",
    "solver-": "simulation",
}


def no_constant(name):
    raise ValueError(f"{name} is not JSON; unknown is null")


def problems_of(line, kind):
    """Errors of one line, each with its position in the record."""
    try:
        record = json.loads(line, parse_constant=no_constant)
    except ValueError as error:
        return [f"not JSON: {error}"]
    # Records of profiles and cells identify themselves, also in one file.
    if isinstance(record, dict) and kind in ("record", "profile"):
        kind = (
            "profile"
            if "profile_of" in record
            else "record"
            if "key" in record
            else "verdict"
            if record.get("kind") == "verdict"
            else kind
        )
    return problems_of_record(record, kind)


def problems_of_record(record, kind="record"):
    """Errors of a record against the schema of `kind`, each with its position in the record."""
    try:
        checker_of(kind)(record)
        return []
    except fastjsonschema.JsonSchemaException:  # reports the first error only
        pass
    found = validator_of(f"{kind}.schema.json").iter_errors(record)
    return [f"/{'/'.join(map(str, e.absolute_path))}: {e.message[:300]}" for e in found] or [
        "/: not as the schema says"
    ]


def problems_in(path, kind):
    """(line number, text) of every error in a file, and its number of lines."""
    try:
        data = lzma.open(path).read() if path.suffix == ".xz" else path.read_bytes()
        lines = data.decode("utf-8").removesuffix("\n").split("\n")
    except (OSError, EOFError, lzma.LZMAError, UnicodeDecodeError) as error:
        return [(1, str(error))], 0
    lines = [] if lines == [""] else lines
    return [(n, text) for n, line in enumerate(lines, 1) for text in problems_of(line, kind)], len(lines)


def resolved(schema, records):
    """`schema` with its references into record.schema.json replaced by their targets."""
    if isinstance(schema, list):
        return [resolved(part, records) for part in schema]
    if not isinstance(schema, dict):
        return schema
    file, _, pointer = schema.get("$ref", "").partition("#/")
    if file != "record.schema.json":
        return {name: resolved(part, records) for name, part in schema.items()}
    for name in pointer.split("/"):
        records = records[name]
    return records


def schema_of(name):
    """A schema of results/ without external references."""
    records = json.loads((ROOT / "results/record.schema.json").read_text())
    schema = resolved(json.loads((ROOT / "results" / name).read_text()), records)
    schema["definitions"] = {**records["definitions"], **schema.get("definitions", {})}
    jsonschema.Draft7Validator.check_schema(schema)
    return schema


@functools.cache
def validator_of(name):
    return jsonschema.Draft7Validator(schema_of(name))


@functools.cache
def checker_of(kind):
    """A function that raises at the first error of a record. It takes a tenth of the time of a validator,
    which finds all."""
    return fastjsonschema.compile(schema_of(f"{kind}.schema.json"))


def main(names):
    files = [pathlib.Path(name) for name in names] or sorted(
        path for folder in ("results", "tests/records") for path in (ROOT / folder).glob("**/*.jsonl*")
    )
    if not files:
        print("no records are committed yet")
        return 0
    total, found = 0, []
    for path in files:
        kind = next((kind for beginning, kind in KINDS.items() if path.name.startswith(beginning)), "record")
        problems, count = problems_in(path, kind)
        total += count
        found += [f"{path}:{number}: {text}" for number, text in problems]
    if not found and total == 0:
        found = [f"{files[0]}:1: no records in the files"]
    for text in found[:SHOWN]:
        print(text, file=sys.stderr)
    print(f"{len(found)} problems in {total} records" if found else f"{total} records valid")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
