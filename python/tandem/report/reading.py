# SPDX-License-Identifier: MIT
"""Reads files with records of any kind for a page."""

import dataclasses
import os

from .. import kinds, lines
from ..cell import Cell
from ..verdicts import RecordedVerdicts
from .other_records import Simulations, shown_ceilings, shown_profile

WHAT_TO_GIVE = "give files that 'tandem run --out', 'profile --out', 'simulate --record' or 'devices --measure --out' wrote"
MAX_CELLS = 6000  # with more, only one record per key is shown
MAX_OTHER_RECORDS = 200  # profiles, and records of ceilings
LISTS = {"cell": "cells", "profile": "profiles", "simulation": "simulations", "ceilings": "ceilings"}


@dataclasses.dataclass
class Records:
    """cells: Cells. cell_records: number of all records of cells; an interrupted record and its
    continuation count as one. paths: of all files. files: the name and the numbers of records of each kind for each file. notes:
    texts on records left out and incomplete lines."""

    cells: list = dataclasses.field(default_factory=list)
    cell_records: int = 0
    profiles: list = dataclasses.field(default_factory=list)
    ceilings: list = dataclasses.field(default_factory=list)
    simulations: list = dataclasses.field(default_factory=list)
    verdicts: RecordedVerdicts = dataclasses.field(default_factory=RecordedVerdicts)
    files: list = dataclasses.field(default_factory=list)
    paths: list = dataclasses.field(default_factory=list)
    notes: list = dataclasses.field(default_factory=list)


def _is_copy(cell, other):
    return (
        cell.run is not None
        and cell.run == other.run
        and cell.samples_by_round == other.samples_by_round
        and cell.status == other.status
    )


class _Kept:
    """Cells by number, in the order of their records. With more than `max_cells`, keeps only one per
    key. Leaves out copies, records that another record of the same key continues, and records of interrupted
    cells before a later one."""

    def __init__(self, max_cells):
        self.max_cells, self.one_per_key = max_cells, False
        self.cells, self.numbers_by_key = {}, {}
        self.records = self.added = self.older = self.left_out = self.left_out_wrong = 0

    def add(self, cell):
        numbers = self.numbers_by_key.get(cell.key, [])
        if any(
            self.cells[number].continues(cell) or _is_copy(cell, self.cells[number]) for number in numbers
        ):
            return
        interrupted = [
            number
            for number in numbers
            if cell.continues(self.cells[number]) or cell.remeasures(self.cells[number])
        ]
        self._remove(interrupted)
        self.records += 1 - len(interrupted)
        if not self.one_per_key and len(self.cells) == self.max_cells:
            self._keep_newest()
        numbers = self.numbers_by_key.get(cell.key, [])
        if self.one_per_key and numbers:
            self._replace(numbers[0], cell)
        elif len(self.cells) == self.max_cells:
            self.left_out += 1
            self.left_out_wrong += cell.status != "ok"
        else:
            self.added += 1
            self.cells[self.added] = cell
            self.numbers_by_key.setdefault(cell.key, []).append(self.added)

    def _remove(self, numbers):
        for number in numbers:
            self.numbers_by_key[self.cells.pop(number).key].remove(number)

    def _replace(self, number, cell):
        self.older += 1
        if cell.status == "ok" or self.cells[number].status != "ok":
            self.cells[number] = cell

    def mark_older(self):
        """Marks all records of a key as older, except the last one that is ok, or the last one if none is."""
        for numbers in self.numbers_by_key.values():
            good = [number for number in numbers if self.cells[number].status == "ok"]
            newest = (good or numbers or [None])[-1]
            for number in numbers:
                self.cells[number].is_older = number != newest

    def _keep_newest(self):
        """Removes older records. From this call on, keeps one record per key."""
        self.one_per_key = True
        self.mark_older()
        older = [number for number, cell in self.cells.items() if cell.is_older]
        self.older += len(older)
        self._remove(older)

    def notes(self):
        if self.older:
            yield f"{self.older} older records of cells that were recorded again are left out"
        if self.left_out:
            yield (
                f"{self.left_out} of {self.records} records of cells are left out, {self.left_out_wrong} of them failed or wrong: a page "
                f"shows at most {self.max_cells}; give fewer files or fewer lines"
            )


def _checked(text, location):
    return kinds.checked(text, location, WHAT_TO_GIVE)


class _Reader:
    """Reads several files into one Records."""

    def __init__(self, max_cells):
        self.records, self.cells, self.simulations = Records(), _Kept(max_cells), Simulations()
        self.left_out = 0

    def read(self, path):
        self.records.paths.append(os.fspath(path))
        self.records.files.append({"name": os.path.basename(path), **dict.fromkeys(LISTS.values(), 0)})
        number, before = 0, len(self.records.notes)
        for number, (kind, record) in lines.numbered(path, self.records.notes.append, _checked):
            try:
                self._add(kind, record, path, number)
            except lines.RecordError:
                raise
            except lines.FIELD_ERRORS:
                raise lines.RecordError(
                    f"{path}:{number}: a record that lacks fields of its schema; {WHAT_TO_GIVE}"
                ) from None
        if number == 0 and len(self.records.notes) > before:
            raise lines.RecordError(f"{path}: its only line has no end; name a file of records")

    def _add(self, kind, record, path, line):
        if kind == "verdict":
            self.records.verdicts.add(record, f"{path}:{line}")
            return
        self.records.files[-1][LISTS[kind]] += 1
        if kind == "cell":
            self.cells.add(Cell(record, path, line))
        elif kind == "simulation":
            self.simulations.add(record, path)
        else:
            shown = shown_profile(record, path) if kind == "profile" else shown_ceilings(record)
            others = getattr(self.records, LISTS[kind])
            others.append(shown)
            self.left_out += len(others) > MAX_OTHER_RECORDS
            del others[MAX_OTHER_RECORDS:]

    def finish(self):
        records, cells = self.records, self.cells
        cells.mark_older()
        records.cells, records.cell_records = list(cells.cells.values()), cells.records
        records.simulations = self.simulations.shown()
        records.notes += cells.notes()
        if self.left_out:
            records.notes.append(
                f"{self.left_out} profiles or records of ceilings are left out: a page shows at most {MAX_OTHER_RECORDS} of each"
            )
        if self.simulations.left_out:
            records.notes.append(f"the last {self.simulations.left_out} simulations are left out")
        return records


def read_records(files, max_cells=MAX_CELLS):
    """Records of files with any kinds of records. Raises RecordError for files that cannot be read and for
    other schemas."""
    reader = _Reader(max_cells)
    for file in files:
        reader.read(file)
    return reader.finish()
