# SPDX-License-Identifier: MIT
"""tandem paper: measures the steps of a plan, then makes tables, figures, verdicts and index.html from the records of its folder.
Exits with 2 and one error line for bad use and a folder without records, and with 3 if a step failed or a file cannot be written."""
import argparse
import csv
import dataclasses

from ..paper import measuring
from . import check_packages, print_error

PACKAGES = ("matplotlib", "pandas", "scipy")


def write_claims(folder, found):
    from ..paper import claims
    with open(folder.path / "claims.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, [field.name for field in dataclasses.fields(claims.Claim)], lineterminator="\n")
        writer.writeheader()
        writer.writerows(map(dataclasses.asdict, found))


def build(path):
    """Makes all files. Returns a line with their numbers. Raises lines.RecordError, OSError."""
    from ..paper import claims, figures, page, pictures, tables
    from ..paper.folder import Folder
    folder = Folder(path)
    made = tables.all_tables(folder)
    for table in made:
        table.write(folder.path)
    all_figures = [*pictures.all_pictures(folder), *figures.all_curves(folder)]
    found = claims.all_claims(folder)
    write_claims(folder, found)
    page.write(folder, made, all_figures, found)
    gaps = sum(bool(figure.missing) for figure in all_figures)
    verdicts = ", ".join(f"{sum(claim.verdict == kind for claim in found)} {kind}" for kind in (claims.AGREES, claims.DIFFERS, claims.UNTESTED))
    return f"{folder.path / 'index.html'}: 7 tables, {len(all_figures) - gaps} of {len(all_figures)} figures, claims: {verdicts}"


def draw(path):
    """Makes all files and prints their numbers or an error. Returns the exit code."""
    from .. import lines
    try:
        print(build(path), flush=True)
    except lines.RecordError as error:
        return print_error(error, 2)
    except OSError as error:
        return print_error(f"{error.filename or path}: cannot be written: {error.strerror}", 3)
    return 0


def parsed(arguments):
    parser = argparse.ArgumentParser(prog="tandem paper", description=__doc__)
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--device", default="opencl:0")
    parser.add_argument("--queue-bytes", type=int, default=0, help="bytes of device memory that the paper's release allocates for queues")
    parser.add_argument("--size", default="small")
    parser.add_argument("--steps", default="")
    for name in ("again", "measure-only", "draw-only", "dry-run"):
        parser.add_argument(f"--{name}", action="store_true")
    return parser.parse_args(arguments)


def main(arguments, program):
    """`program`: path of tandem, which runs the steps."""
    options = parsed(arguments)
    try:
        if not options.measure_only and not options.dry_run:
            check_packages("tandem paper", PACKAGES, ", or give --measure-only")  # fails before anything is measured
        if options.draw_only:
            return draw(options.output)
        steps = measuring.steps_of(options.size, options.device, options.queue_bytes)
        first, last = measuring.numbered(options.steps, len(steps))
        folder = measuring.MeasuredFolder(options.output, options.size, options.device, program)
        if options.dry_run:
            measuring.list_steps(folder, steps)
            return 0
        if options.again:
            for step in steps[first - 1:last]:
                folder.forget(step)
        worst = measuring.run_steps(folder, steps, first, last)
    except measuring.BadUse as error:
        return print_error(error, 2)
    except OSError as error:
        return print_error(f"{error.filename or options.output}: {error.strerror}", 3)
    if options.measure_only:
        return worst
    return 3 if draw(options.output) else worst
