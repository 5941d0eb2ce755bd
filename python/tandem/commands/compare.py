# SPDX-License-Identifier: MIT
"""tandem compare: which cells changed, by how much and how surely. Exits with 1 if a cell is slower, faster
or has another answer."""

import argparse
import contextlib
import tempfile

from . import check_packages, print_error, run

FAILED = 3
LEVEL, LEVEL_OF_RUNS = 0.05, 0.01  # continuous integration compares builds at every change


def _parsed(arguments):
    parser = argparse.ArgumentParser(prog="tandem compare", description=__doc__)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("words", nargs="*")
    parser.add_argument("--threshold", type=float, help="percent")
    parser.add_argument("--level", type=float)
    parser.add_argument("--format", default="text", choices=("text", "json", "markdown"))
    parser.add_argument("--commit-old", default="")
    parser.add_argument("--commit-new", default="")
    parser.add_argument("--strict", action="store_true")
    parser.add_argument("--run", action="store_true")
    parser.add_argument("--sessions", type=int, default=12)
    parser.add_argument("--out")
    options = parser.parse_args(arguments)
    if options.level is None:
        options.level = LEVEL_OF_RUNS if options.run else LEVEL
    return options


def _form(options):
    """The function that makes the text of a comparison. Imports every module that compares: the files of
    these modules may change while two programs are measured."""
    from ..comparison import texts

    return {"text": texts.text, "json": texts.as_json, "markdown": texts.markdown}[options.format]


def _text(found, options, form):
    """The text of a comparison, and its exit code."""
    matched = found[2]
    return form(*found, options.level), int(
        matched.changed or (options.strict and matched.count("disturbed") > 0)
    )


def _threshold(options):
    return None if options.threshold is None else options.threshold / 100


def _compared_files(options):
    from .. import comparison

    found = comparison.matched_files(
        options.old, options.new, _threshold(options), options.level, (options.commit_old, options.commit_new)
    )
    return _text(found, options, _form(options))


def _compared_programs(options):
    from .. import comparison
    from ..comparison import turns

    form = _form(options)
    with contextlib.ExitStack() as stack:
        folder = (
            options.out
            if options.out
            else stack.enter_context(tempfile.TemporaryDirectory(prefix="tandem-compare"))
        )
        both = turns.Turns(options.old, options.new, options.words, folder)
        turns.prepared_folder(folder)
        ended = both.measure(options.sessions)
        old, new = (both.side(side) for side in turns.SIDES)
    try:
        text, code = _text(
            comparison.matched_cells(old, new, _threshold(options), options.level), options, form
        )
    except comparison.lines.RecordError as problem:
        if not (ended.failure or ended.wrong):
            raise
        text, code = "", 0 if ended.failure else print_error(problem, 1)
    if ended.failure:
        return text, print_error(ended.failure, 128 + ended.signal if ended.signal else FAILED)
    return text, max(code, int(ended.wrong))


def _make(options):
    check_packages("tandem compare", ("numpy", "scipy"))
    return _compared_programs(options) if options.run else _compared_files(options)


def main(arguments, program):
    options = _parsed(arguments)
    return run(lambda: _make(options))
