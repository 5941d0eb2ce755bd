# SPDX-License-Identifier: MIT
"""tandem report: writes records, and optionally a scene, as one page for a browser."""

import datetime
import subprocess

from ..errors import BadUse
from ..files import check_output
from . import Parser, check_packages, check_together, run, warn

MAX_BYTES = 15_900_000


def _parsed(arguments):
    from ..report.scene import FLAGS, OPTIONS, add_options, check_device

    parser = Parser("tandem report", __doc__, "tandem report records.jsonl -o report.html")
    add = parser.add_argument
    kinds = "records of cells, profiles, simulations or ceilings (.jsonl, .jsonl.xz)"
    add("files", nargs="+", help=kinds)
    page = "the HTML file to write (default: report.html)"
    add("-o", "--output", default="report.html", metavar="FILE", help=page)
    old = "OLD.jsonl or OLD.jsonl@COMMIT: compare the one FILE with it, as 'tandem compare' does"
    add("--against", metavar="OLD", help=old)
    sentences = "also print the fastest cell of each comparison, and what makes the difference"
    add("--sentences", action="store_true", help=sentences)
    add("--scene", metavar="SCENE", help="also show this scene or recording")
    add_options(parser)
    options = parser.read(arguments)
    names = [name.replace("_", "-") for name in (*OPTIONS, *FLAGS) if hasattr(options, name)]
    check_together(options, [(name, "scene") for name in names])
    check_device(options)
    return options


def _contents(cells, records):
    """ "36 cells of 2 files", with the numbers of other records."""
    counts = (
        (cells, "cell", "cells"),
        (len(records.profiles), "profile", "profiles"),
        (len(records.simulations), "simulation", "simulations"),
        (len(records.ceilings), "device's ceilings", "devices' ceilings"),
        (len(records.files), "file", "files"),
    )
    *parts, files = (f"{number} {one if number == 1 else more}" for number, one, more in counts if number)
    return f"{', '.join(parts)} of {files}"


def _made_by(program):
    """The program's version in one line, and the date and time."""
    version = subprocess.run(
        [program, "--version"], capture_output=True, text=True, check=True
    ).stdout.strip()
    return version, datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def _write(options, program):
    """Writes the page and returns the output line. Raises scene.ExportEnded and the errors that run() handles."""
    from ..pages.frame import html_of
    from ..pages.markup import element
    from ..report.assembly import open_page, scene_section, write_page
    from ..report.scene import shown_scene, words_of

    if options.against and len(options.files) != 1:
        raise BadUse(
            f"--against {options.against}: two sets of records are compared; give one FILE beside it"
        )
    check_output(
        options.output,
        [*options.files, *filter(None, (options.against, options.scene))],
        ".partial",
        is_page=True,
    )
    page = open_page("Report of tandem", True, bool(options.scene), program, "tandem report")
    from ..report.data import data_of, size_of
    from ..report.reading import read_records

    records, empty, compared = read_records(options.files), size_of(html_of(page)), None
    if options.against:
        from ..report.differences import differences

        compared = differences(options.against, options.files[0], records.cells)
    scene = shown_scene(program, words_of(options.scene, options), options.output) if options.scene else None
    if scene:
        page.data["scene"] = scene.json
    free_bytes = MAX_BYTES - empty - sum(map(size_of, page.data.values()))
    data = data_of(records, free_bytes, compared)
    page.data["records"], page.sections = (
        data.json,
        data.sections + ([scene_section(scene.key)] if scene else []),
    )
    version, date = _made_by(program)
    against = f", against {compared['old']}" if compared else ""
    page.lead = element(
        "p", f"Files: {', '.join(records.files)}{against}. Made {date}.", class_="quiet", id="made"
    )
    page.footer = [element("p", version), page.footer]
    written = write_page(options.output, page)
    for note in data.notes:
        warn(f"tandem: {note}")
    sentences = "".join(f"{one}\n" for one in data.sentences) if options.sentences else ""
    return f"{sentences}{options.output}: {_contents(data.cells, records)}{f', {scene.key}' if scene else ''}, {written / 1e6:.1f} MB\n"


def _make(options, program):
    try:
        return _write(options, program), 0
    except ModuleNotFoundError as missing:  # of trends, of --against, and where no verdict is recorded
        check_packages("tandem report", (missing.name.partition(".")[0],))
        raise


def main(arguments, program):
    return run(lambda: _make(_parsed(arguments), program))
