# SPDX-License-Identifier: MIT
"""command FOLDER: tables, figures, verdicts and index.html of a folder of 'tandem paper', from its records. Exit 2, and one line
that says why, for a folder that has none; 3 when something cannot be written."""
import csv
import dataclasses
import sys

from .. import lines
from . import claims, figures, page, pictures, tables
from .folder import Folder


def write_claims(folder, found):
    with open(folder.path / "claims.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, [field.name for field in dataclasses.fields(claims.Claim)], lineterminator="\n")
        writer.writeheader()
        writer.writerows(map(dataclasses.asdict, found))


def build(path):
    """Everything; returns the line that says what there is. Raises lines.RecordError, OSError."""
    folder = Folder(path)
    made = tables.all_tables(folder)
    for table in made:
        table.write(folder.path)
    drawn = [*pictures.all_pictures(folder), *figures.all_curves(folder)]
    found = claims.all_claims(folder)
    write_claims(folder, found)
    page.write(folder, made, drawn, found)
    gaps = sum(bool(figure.missing) for figure in drawn)
    verdicts = ", ".join(f"{sum(claim.verdict == kind for claim in found)} {kind}" for kind in (claims.AGREES, claims.DIFFERS, claims.UNTESTED))
    return f"{folder.path / 'index.html'}: 7 tables, {len(drawn) - gaps} of {len(drawn)} figures, claims: {verdicts}"


def main(arguments):
    if len(arguments) != 1 or arguments[0] in ("-h", "--help"):
        print(__doc__, file=sys.stdout if arguments else sys.stderr)
        return 0 if arguments else 2
    try:
        print(build(arguments[0]))
    except lines.RecordError as error:
        print(f"tandem: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"tandem: {error.filename or arguments[0]}: cannot be written: {error.strerror}", file=sys.stderr)
        return 3
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
