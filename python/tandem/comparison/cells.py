# SPDX-License-Identifier: MIT
"""Reads the cells of a file that are compared."""

import dataclasses
import os

from .. import lines
from ..cell import Cell
from .pooling import counting, pooled


@dataclasses.dataclass
class RecordedCells:
    """The records of one file, or of one commit in it. `commit`: the full commit, if one was given. `cells`:
    one for each key with records that are ok, in the order of the keys' first lines. `left_out`: records that
    failed, are wrong or have no samples. `repeated`: number of keys of which some records that are ok do not
    count. `torn`: the last line has no end and is ignored. `pooled`: number of keys of which several sessions
    count. `is_program`: `path` is that of a program, which turns.py measured."""

    path: str
    commit: str
    cells: list
    left_out: list
    commits: list
    records: int
    repeated: int
    torn: bool
    pooled: int = 0
    is_program: bool = False


def _split_commit(file, commit):
    """Splits PATH@COMMIT into path and commit. If a file with the whole name exists, the name is the path."""
    name = os.fspath(file)
    path, at, behind = name.rpartition("@")
    if not at or os.path.exists(name):
        return name, commit
    if not behind:
        raise lines.RecordError(f"{name}: no such file, and no commit behind the @; give FILE@COMMIT")
    if commit:
        raise lines.RecordError(
            f"{name}: the option names another commit, {commit}; name one commit, behind the @ or by the option"
        )
    return path, behind


def _commits(cells):
    return list(dict.fromkeys(cell.commit for cell in cells))


def _whole_commit(path, start, cells):
    """The only commit that begins with `start`."""
    commits = _commits(cells)
    found = [commit for commit in commits if commit.startswith(start)]
    if not found:
        raise lines.RecordError(f"{path}: no record of commit {start}; there are {', '.join(commits)}")
    if len(found) > 1:
        raise lines.RecordError(f"{path}: commit {start} may be {' or '.join(found)}; give more digits")
    return found[0]


def read_cells(file, commit=""):
    """Reads RecordedCells of a file, given as PATH or PATH@COMMIT. `commit`, or the text behind the @, is the
    beginning of the commit whose records count; without it all records count. Raises RecordError."""
    path, start = _split_commit(file, commit)
    torn = []
    records = [Cell(record, path, line) for line, record in lines.numbered(path, torn.append)]
    if not records:
        raise lines.RecordError(
            f"{path}: {'its only line has no end' if torn else 'has no record of a cell'}; name a file of records"
        )
    if start:
        start = _whole_commit(path, start, records)
        records = [cell for cell in records if cell.commit == start]
    by_key, left_out = {}, []
    for cell in records:
        if cell.status != "ok" or not cell.rounds:
            left_out.append(cell)
        else:
            by_key.setdefault(cell.key, []).append(cell)
    counted = {key: counting(found) for key, found in by_key.items()}
    kept = [pooled(found) if len(found) > 1 else found[0] for found in counted.values()]
    repeated = sum(len(counted[key]) < len(found) for key, found in by_key.items())
    return RecordedCells(
        path,
        start,
        kept,
        left_out,
        _commits(kept),
        len(records),
        repeated,
        bool(torn),
        sum(len(found) > 1 for found in counted.values()),
    )
