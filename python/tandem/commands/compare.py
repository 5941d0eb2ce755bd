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
    return parser.parse_args(arguments)


def _make(options):
    check_packages("tandem compare", ("numpy",))
    from .. import comparison
    from ..comparison import texts
    threshold = None if options.threshold is None else options.threshold / 100
    found = comparison.matched_files(options.old, options.new, threshold, options.level, (options.commit_old, options.commit_new))
    form = {"text": texts.text, "json": texts.as_json, "markdown": texts.markdown}[options.format]
    return form(*found, options.level), int(found[2].changed)


def main(arguments, program):
    options = _parsed(arguments)
    return run(lambda: _make(options))
