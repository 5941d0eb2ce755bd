# SPDX-License-Identifier: MIT
"""tandem paper: measures the steps of a plan, then makes tables, figures, verdicts and index.html from the
records of its folder. Exits with 2 and one error line for bad use and a folder without records, and with 3 if
a step failed or a file cannot be written."""

import csv
import pathlib
import subprocess

from ..csv_fields import fields
from ..errors import BadUse, OutputError
from ..files import check_output, temporary_folder
from ..paper import measuring
from ..sequences.needs import Machine
from ..text_lines import visible
from . import Parser, check_packages, check_together, print_error, run

PACKAGES = ("matplotlib", "pandas", "scipy")


CLAIM_COLUMNS = """
    claim where says scene verdict value low high unit paper_low paper_high samples basis disturbed frames
    reason records
""".split()


def claim_rows(claim):
    """One row of claims.csv for each scene, then one for the claim."""
    fields = {"claim": claim.id, "where": claim.fields["where"], "says": claim.fields["says"]}
    for line in claim.lines:
        measured, paper = line.measured, list(line.paper.values())
        row = {
            **fields,
            "scene": line.label,
            "verdict": line.verdict,
            "reason": line.reason,
            "unit": claim.fields.get("unit", ""),
            "paper_low": min(paper, default=None),
            "paper_high": max(paper, default=None),
        }
        if measured:
            row |= {
                name: getattr(measured, name)
                for name in ("value", "low", "high", "samples", "basis", "disturbed", "frames")
            }
            row["records"] = " ".join(measured.records)
        yield row
    yield {**fields, "scene": "all", "verdict": claim.verdict}


def write_claims(path, found):
    from ..paper.tables import short

    with open(path / "claims.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, CLAIM_COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(
            fields({name: short(row.get(name)) for name in CLAIM_COLUMNS})
            for claim in found
            for row in claim_rows(claim)
        )


def all_tables(folder):
    from ..paper import comparison_tables, simulation_tables, tables

    return [
        make(folder)
        for make in (
            tables.table1,
            tables.table2,
            simulation_tables.table3,
            comparison_tables.table4,
            comparison_tables.table5,
            simulation_tables.table6,
            simulation_tables.table7,
        )
    ]


def check_outputs(path):
    """Raises BadUse if a file of the page cannot be written, or is a file of records."""
    folder = pathlib.Path(path)
    if folder.is_dir():
        for output in (*folder.glob("*.csv"), *folder.glob("*.svg"), folder / "index.html"):
            check_output(output)


def build(path):
    """Makes all files. Returns a line with their numbers. Raises lines.RecordError, OSError."""
    from ..paper import claims, figures, page, pictures, simulation_figures
    from ..paper.folder import Folder

    folder = Folder(path)
    check_outputs(path)
    made = all_tables(folder)
    for table in made:
        table.write(folder.path)
    curves = figures.all_of_frames(folder) | simulation_figures.all_of_simulations(folder)
    all_figures = [*pictures.all_pictures(folder), *(curves[number] for number in sorted(curves))]
    found = claims.all_claims(folder)
    write_claims(folder.path, found)
    page.write(folder, made, all_figures, found)
    gaps = sum(bool(figure.missing) for figure in all_figures)
    verdicts = ", ".join(f"{count} {verdict}" for verdict, count in claims.counts(found).items())
    return f"{folder.path / 'index.html'}: 7 tables, {len(all_figures) - gaps} of {len(all_figures)} figures, claims: {verdicts}"


def draw(path):
    """Makes all files and prints their numbers or an error. Returns the exit code."""
    from .. import lines

    try:
        print(visible(build(path)), flush=True)
    except (lines.RecordError, BadUse) as error:
        return print_error(error, 2)
    except OSError as error:
        return print_error(f"{error.filename or path}: cannot be written: {error.strerror}", 3)
    return 0


def parsed(arguments):
    parser = Parser("tandem paper", __doc__, "tandem paper -o paper")
    add = parser.add_argument
    folder = "the folder for tables, figures, records and index.html"
    add("-o", "--output", required=True, metavar="FOLDER", help=folder)
    device = "the device to measure on (default: the first GPU, else host)"
    add("--device", metavar="DEVICE", help=device)
    size = "scenes: small, for a processor (10 minutes on two cores), or full, those of the paper, for a GPU (default: small)"
    add("--size", default="small", metavar="small|full", help=size)
    steps = (
        "only these of the steps that --dry-run lists: FIRST:LAST or N; or tableN, figureN or a name, with the steps "
        "that make their recordings; several with commas (default: all)"
    )
    add("--steps", default="", metavar="STEPS", help=steps)
    for name, text in (
        ("again", "measure again what is already done"),
        ("measure-only", "draw nothing; draw later with --draw-only, on any machine"),
        ("draw-only", "draw tables, figures and verdicts from the records of the folder; measure nothing"),
        ("dry-run", "list the steps and their times; measure nothing"),
    ):
        add(f"--{name}", action="store_true", help=text)
    options = parser.read(arguments)
    check_together(options, (), [("draw-only", name) for name in ("measure-only", "again", "steps")])
    return options


def check_is_one(device):
    if device == "all" or any(letter in device for letter in ",+"):
        raise BadUse(f"--device {device}: the paper's scenes run on one device; name exactly one")


def check_device(program, device):
    """Raises BadUse unless the program has this device."""
    words = ["run", "plates", "--frames", "0", "--algorithm", "chunked", "--dry-run", "--device", device]
    done = subprocess.run([program, *words], capture_output=True, text=True)
    if done.returncode:
        raise BadUse(done.stderr.strip().splitlines()[-1].removeprefix("tandem: "))


def _make(options, program):
    if not options.draw_only:
        options.device = options.device or Machine(program, options.output).default
        check_is_one(options.device)
    if not options.measure_only and not options.dry_run:
        # Fails before anything is measured.
        check_packages("tandem paper", PACKAGES, ", or give --measure-only")
        check_outputs(options.output)
    if options.draw_only:
        return draw(options.output)
    steps = measuring.steps_of(options.size, options.device)
    numbers = measuring.chosen(options.steps, steps)
    folder_of = lambda path: measuring.measured_folder(path, options.size, options.device, program)
    if options.dry_run:
        with temporary_folder() as empty:  # a list makes no folder
            is_there = pathlib.Path(options.output).exists()
            measuring.list_steps(folder_of(options.output if is_there else empty), steps)
        return 0
    runner = folder_of(options.output)
    if any(measuring.runs_on(steps[number], options.device) for number in numbers):
        check_device(program, options.device)
    if options.again:
        for number in numbers:
            runner.forget(steps[number])
    failed = runner.run(steps, numbers)
    if runner.interrupted:
        return 128 + runner.interrupted
    worst = max((1 if code == 1 else 3 for code in failed), default=0)
    if options.measure_only:
        return worst
    return 3 if draw(options.output) else worst


def _made(arguments, program):
    options = parsed(arguments)
    try:
        return "", _make(options, program)
    except OSError as error:
        raise OutputError(f"{error.filename or options.output}: {error.strerror}") from None


def main(arguments, program):
    """`program`: path of tandem, which runs the steps."""
    return run(lambda: _made(arguments, program))
