#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""validate_records.py [FILE.jsonl ...]: checks records against results/record.schema.json; without files, all
committed ones. Exit 1 names file:line and the place of the first problems."""
import json
import pathlib
import sys

import jsonschema

ROOT = pathlib.Path(__file__).resolve().parent.parent


def problems(path, validator):
    """(line number, text) of everything wrong in a file, and how many records it has."""
    found, count = [], 0
    for number, line in enumerate(path.read_text().splitlines(), 1):
        count += 1
        try:
            record = json.loads(line)
        except json.JSONDecodeError as error:
            found.append((number, f"not JSON: {error}"))
            continue
        for error in validator.iter_errors(record):
            place = "/".join(map(str, error.absolute_path))
            found.append((number, f"/{place}: {error.message}"))
    return found, count


def main():
    schema = json.loads((ROOT / "results/record.schema.json").read_text())
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    given = [pathlib.Path(name) for name in sys.argv[1:]]
    files = given or sorted((ROOT / "results").glob("**/*.jsonl"))
    total, wrong = 0, 0
    for path in files:
        found, count = problems(path, validator)
        total += count
        wrong += len(found)
        for number, text in found[:10]:
            print(f"{path}:{number}: {text}", file=sys.stderr)
    if given and total == 0:
        print("no records in the files given", file=sys.stderr)
        return 1
    print(f"{total} records valid" if wrong == 0 else f"{wrong} problems in {total} records")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
