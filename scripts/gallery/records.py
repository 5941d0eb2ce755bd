# SPDX-License-Identifier: MIT
"""Reads records for the page, and refuses submitted ones that do not match the schema or the history of the
project."""

import dataclasses
import pathlib
import re
import subprocess

from tandem import kinds, lines
from tandem.cell import Cell
from tandem.errors import BadUse
from tandem.text_lines import one_line
from validate_records import problems_of_record

ERRORS_ONLY = "accuracy"  # files that begin so have times of work that nobody compares
ABBREVIATION = re.compile(r"[0-9a-f]{7,40}\Z")


@dataclasses.dataclass
class Source:
    """A record of a cell, its place FILE:LINE, and whether it was submitted."""

    cell: Cell
    place: str
    is_submitted: bool


@dataclasses.dataclass
class Gathered:
    """Records of cells in the order of their files, and messages about submitted lines that are refused."""

    sources: list = dataclasses.field(default_factory=list)
    refused: list = dataclasses.field(default_factory=list)


def history(root):
    """Full hashes of all commits of the checkout. Raises BadUse without git or its history."""
    done = subprocess.run(
        ["git", "-C", root, "rev-list", "--all", "HEAD"], capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        raise BadUse(
            f"{root}: commits of records cannot be checked ({one_line(done.stderr.strip(), 200)}); use a checkout with its history"
        )
    return set(done.stdout.split())


def _is_known(commit, commits):
    return bool(ABBREVIATION.match(commit)) and any(one.startswith(commit) for one in commits)


def objection(record, commits):
    """Why a submitted record is refused; None if it is accepted. A wrong answer is no reason: the page shows
    it."""
    problems = problems_of_record(record)
    if problems:
        return f"does not match results/record.schema.json ({problems[0]})"
    environment = record["environment"]
    if not environment["commit"] or not _is_known(environment["commit"], commits):
        return f"commit {environment['commit'] or 'unknown'} is not in the history of this project; measure a commit of it"
    if environment["dirty"]:
        return "the program was built with changes that no commit has; measure a committed tree"
    return None


def _check_of(gathered, commits):
    """The check of lines.numbered: the record of a cell; None for lines of other kinds and for refused ones.
    `commits` is None for committed files."""

    def check(text, location):
        try:
            record = lines.parsed(text, location)
            if kinds.kind_of(record) in kinds.SCHEMAS and kinds.kind_of(record) != "cell":
                return None
            reason = objection(record, commits) if commits is not None else None
            if reason:
                raise lines.RecordError(f"{location}: {reason}")
            return lines.checked_cell(record, location)
        except lines.RecordError as problem:
            if commits is None:
                raise
            gathered.refused.append(str(problem))
            return None

    return check


def add_file(gathered, path, name, commits=None):
    """Adds the cells of a file to Gathered. name: how the page calls it. commits: hashes of the history, for
    submitted files; committed files had their review. Raises RecordError for a committed file with an error."""
    torn = gathered.refused.append if commits is not None else lambda message: None
    try:
        for number, record in lines.numbered(str(path), torn, _check_of(gathered, commits)):
            if not any(record == other.cell.record for other in gathered.sources):
                source = Source(Cell(record, path, number), f"{name}:{number}", commits is not None)
                gathered.sources.append(source)
    except lines.RecordError as problem:
        if commits is None:
            raise
        gathered.refused.append(str(problem))


def gathered_from(results, files, commits):
    """Gathered of the committed files of records in results/*/ that were timed, then of submitted ones: those of
    results/submitted, and `files`. Raises RecordError."""
    patterns, folder = ("*/*.jsonl", "*/*.jsonl.xz"), pathlib.Path(results)
    found = sorted(path for pattern in patterns for path in folder.glob(pattern))
    submitted = [path for path in found if path.parent.name == "submitted"]
    gathered = Gathered()
    for path in found:
        if path not in submitted and not path.name.startswith(ERRORS_ONLY):
            add_file(gathered, path, str(path.relative_to(results)))
    for path in [*submitted, *map(pathlib.Path, files)]:
        add_file(gathered, path, path.name, commits)
    return gathered
