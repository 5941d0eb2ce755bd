# SPDX-License-Identifier: MIT
"""python3 -m tandem.model [FILE.jsonl[.xz] ...] [--write README.md]: fits a model of the time of a frame on a
device to records of one device, of several devices and of ranks. It also makes tables of the microbenchmarks
of the partitioner and the ghost lists.

Without files it reads those of a checkout: results/h100x2/*.jsonl*, results/h200/plan.jsonl,
results/scaling/ranks.jsonl, and the microbenchmarks of results/cpu/bench.json. The fit is one of non-negative
least squares of relative errors, stage by stage, over all records of one device, algorithm, k and slabs.
--write writes each table between its marks, <!-- model: NAME --> and <!-- end -->; without it the tables are
printed. --fit prints only the coefficients of all groups. Exits with 2 and one error line for files without
records, or with too few for a fit."""

import argparse
import pathlib

from .. import markdown
from ..commands import Parser, check_packages, run, warn

RESULTS = pathlib.Path(__file__).resolve().parents[3] / "results"


def _parsed(arguments):
    parser = Parser(
        prog="python3 -m tandem.model",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("files", nargs="*", metavar="FILE", type=pathlib.Path)
    parser.add_argument(
        "--partitions", type=pathlib.Path, default=RESULTS / "cpu/bench.json", metavar="FILE.json"
    )
    parser.add_argument("--write", action="append", default=[], metavar="README.md")
    parser.add_argument(
        "--group",
        default="tiled resident, k = 18, slabs=three",
        help="text in the names of groups (default: %(default)s)",
    )
    parser.add_argument("--fit", action="store_true", help="print only the coefficients of all groups")
    options = parser.parse_args(arguments)
    options.files = options.files or [
        *sorted((RESULTS / "h100x2").glob("*.jsonl*")),
        RESULTS / "h200/plan.jsonl",
        RESULTS / "scaling/ranks.jsonl",
    ]
    return options


def tables(options):
    """Texts of the tables by the names of their marks. Raises RecordError and BadUse."""
    from . import fitting, loads, pages

    groups = loads.read(options.files, warn)
    if options.fit:
        return {"coefficients": pages.coefficients(fitting.fit(groups))}
    models = {
        name: model
        for name, model in fitting.fit(groups, options.group).items()
        if not name.startswith("host ")
    }
    return {
        "coefficients": pages.coefficients(models),
        "every rank": pages.every_rank(fitting.every_rank(groups)),
        **pages.partitions(options.partitions),
    }


def _make(arguments):
    options = _parsed(arguments)
    check_packages("tandem.model", ("numpy",))
    texts = tables(options)
    for page in options.write:
        markdown.rewrite(page, "model", texts)
    return "" if options.write else "\n\n".join(f"{name}\n\n{text}" for name, text in texts.items()) + "\n", 0


def main(arguments, program=""):
    return run(lambda: _make(arguments))
