# SPDX-License-Identifier: MIT
"""tandem compare: which cells changed, by how much and how surely. Exits with 1 if a cell is slower, faster or has another answer."""
import argparse

from . import check_packages, run

def _parsed(arguments):
    parser = argparse.ArgumentParser(prog="tandem compare", description=__doc__)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--threshold", type=float, help="percent")
    parser.add_argument("--level", type=float, default=0.05)
    parser.add_argument("--format", default="text", choices=("text", "json", "markdown"))
    parser.add_argument("--commit-old", default="")
    parser.add_argument("--commit-new", default="")
    parser.add_argument("--strict", action="store_true")
    return parser.parse_args(arguments)


def _text(found, options):
    """The text of a comparison, and its exit code."""
    from ..comparison import texts
    matched = found[2]
    form = {"text": texts.text, "json": texts.as_json, "markdown": texts.markdown}[options.format]
    return form(*found, options.level), int(matched.changed or (options.strict and matched.count("disturbed") > 0))


def _threshold(options):
    return None if options.threshold is None else options.threshold / 100


def _compared_files(options):
    from .. import comparison
    return _text(comparison.matched_files(options.old, options.new, _threshold(options), options.level, (options.commit_old, options.commit_new)), options)


def _make(options):
    check_packages("tandem compare", ("numpy",))
    return _compared_files(options)


def main(arguments, program):
    options = _parsed(arguments)
    return run(lambda: _make(options))
