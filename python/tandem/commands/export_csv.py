# SPDX-License-Identifier: MIT
"""tandem export --csv: writes the records of a file as a table of comma-separated values (RFC 4180). The
first line has the names of the columns; then each record, of any status, has one line. Columns name the cell
and its status, then come times in milliseconds per frame, counters and settings. Missing values are empty. A
text that begins with =, +, -, @, tab or carriage return has an apostrophe before it, so that spreadsheets do
not take it for a formula; control characters of texts are escapes. Numbers are never changed."""

import csv
import io
import json

from .. import cell_rows, lines
from ..cell import Cell
from ..csv_fields import text_field
from ..errors import OutputError
from ..files import check_output
from . import Parser, run, warn


def _parsed(arguments):
    parser = Parser("tandem export --csv", __doc__)
    parser.add_argument("--records", required=True, metavar="FILE")
    parser.add_argument("--output", default="", metavar="FILE.csv", help="standard output when left out")
    return parser.read(arguments)


def _row(record, path, line):
    try:
        return cell_rows.row(Cell(record, path, line))
    except lines.RecordError:
        raise
    except lines.FIELD_ERRORS:
        raise lines.RecordError(
            f"{path}:{line}: a record that lacks fields of its schema; {lines.WHAT_TO_GIVE}"
        ) from None


def _text(column, value):
    if value is None or isinstance(value, str):
        return text_field(value or "")
    return (
        f"{value:.9g}"
        if cell_rows.is_time(column)
        else json.dumps(value, separators=(",", ":"), sort_keys=True, ensure_ascii=False)
    )


def as_csv(rows):
    """The table of rows of cell_rows.row()."""
    columns, text = cell_rows.columns(rows), io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([_text(column, row.get(column)) for column in columns] for row in rows)
    return text.getvalue()


def _write(path, text):
    what = "cannot be written"
    try:
        with open(path, "wb") as file:
            what = "writing failed"
            file.write(text.encode(errors="surrogateescape"))
    except OSError as problem:
        raise OutputError(f"{path}: {what} ({problem.strerror}); choose another file") from None


def _make(arguments):
    options = _parsed(arguments)
    if options.output:
        check_output(options.output, [options.records])
    rows = [_row(record, options.records, line) for line, record in lines.numbered(options.records, warn)]
    if not rows:
        raise lines.RecordError(f"{options.records}: has no record; name a file of records")
    if not options.output:
        return as_csv(rows), 0
    _write(options.output, as_csv(rows))
    return f"{options.output}: {len(rows)} records of {options.records}\n", 0


def main(arguments, program=""):
    return run(lambda: _make(arguments))
