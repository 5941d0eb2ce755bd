# SPDX-License-Identifier: MIT
"""python3 -m tandem.error_figures FILE.jsonl[.xz] ... FOLDER: draws records with errors against the truth
(tandem accuracy) as three figures, and writes their data beside them.

pareto: time over candidates per meeting pair, and over the 99th percentiles of depth and normal error, with
names of Pareto-optimal cells. cliffs: errors over difficulty of hard scenes. bars: missed and false pairs and
time by kind of scene. Labels have the settings that differ. A panel without data has a text with the reason.
Other records of tandem, and cells that failed or are wrong, are left out.

Exits with 2 and one error line for a file without records and if nothing can be drawn, with 3 if figures
cannot be written. Needs python3-matplotlib."""

import pathlib

from ..commands import Parser, check_packages, run, warn
from ..errors import BadUse, OutputError


def _parsed(arguments):
    parser = Parser("python3 -m tandem.error_figures", __doc__)
    parser.add_argument("files", nargs="+", metavar="FILE")
    parser.add_argument("folder", metavar="FOLDER", type=pathlib.Path)
    return parser.read(arguments)


def draw(files, folder):
    """Draws the records of these files. Returns the output line. Raises RecordError, BadUse and OutputError."""
    from .drawing import figures
    from .points import read

    points, left_out = read(files, warn)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise BadUse(f"cannot create the folder {folder}, the last argument: {problem.strerror}") from None
    try:
        names, more = figures(points, folder)
    except OSError as problem:
        raise OutputError(f"cannot write to {folder}: {problem.strerror}") from None
    return (
        f"{len(points)} records drawn: {names} in {folder}{more}"
        + (f"; {left_out} failed, wrong or untimed left out" if left_out else "")
        + "\n"
    )


def _make(arguments):
    options = _parsed(arguments)
    check_packages("tandem.error_figures", ("matplotlib",))
    return draw(options.files, options.folder), 0


def main(arguments, program=""):
    return run(lambda: _make(arguments))
