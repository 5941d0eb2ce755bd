# SPDX-License-Identifier: MIT
"""tandem compare: which cells changed, by how much and how surely. Exits with 1 if a cell is slower, faster
or has another answer."""

import contextlib
import tempfile

from . import Parser, check_packages, check_together, print_error, run, within

FAILED = 3
SESSIONS = 12  # of each program
LEVEL, LEVEL_OF_RUNS = 0.05, 0.01  # continuous integration compares builds at every change


def _parsed(arguments):
    parser = Parser(
        "tandem compare",
        __doc__,
        "tandem compare old.jsonl new.jsonl",
        "tandem compare runs.jsonl@1234567 runs.jsonl@89abcde",
    )
    add = parser.add_argument
    add("old", help="FILE.jsonl of records, or FILE.jsonl@COMMIT for the records of one commit")
    add("new", help="as OLD; may be the same file with another commit")
    add("words", nargs="*", help="with --run, behind --: scenes or a plan, and options of 'tandem run'")
    percent = "least change of a cell that counts, in percent (default: 1 on GPUs, 3 on processors)"
    add("--threshold", type=within(0, 1e6), metavar="P", help=percent)
    alarm = f"probability of any false alarm over all cells together (default: {LEVEL}, with --run {LEVEL_OF_RUNS})"
    add("--level", type=within(1e-9, 0.5), metavar="A", help=alarm)
    forms = ("text", "json", "markdown")
    add(
        "--format",
        default="text",
        choices=forms,
        metavar="|".join(forms),
        help="format of the output (default: text)",
    )
    for side, letter in (("old", "C"), ("new", "D")):
        of_commit = f"use only the records of {side.upper()} whose commit begins with this text"
        add(f"--commit-{side}", default="", metavar=letter, help=of_commit)
    add("--strict", action="store_true", help="exit with 1 also if a cell changes in disturbed rounds only")
    turns = "OLD and NEW are two builds of this program; measure both by turns and compare: --run OLD NEW -- SCENE ..."
    add("--run", action="store_true", help=turns)
    processes = f"with --run: processes of each program (default: {SESSIONS})"
    add("--sessions", type=within(2, 1000, int), metavar="N", help=processes)
    kept = "with --run: keep the records in this folder, which must be new or empty"
    add("--out", metavar="FOLDER", help=kept)
    end = arguments.index("--") if "--" in arguments else len(arguments)
    options = parser.read(arguments[:end])
    options.words += arguments[end + 1 :]
    check_together(
        options,
        [(name, "run") for name in ("words", "sessions", "out")],
        [(f"commit-{side}", "run") for side in ("old", "new")],
    )
    options.level = options.level or (LEVEL_OF_RUNS if options.run else LEVEL)
    options.sessions = options.sessions or SESSIONS
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
    return run(lambda: _make(_parsed(arguments)))
