# SPDX-License-Identifier: MIT
"""Reads files with records of any kind for a page."""

import dataclasses
import os

from .. import kinds
from ..cell import Cell, superseded
from ..verdicts import RecordedVerdicts
from .other_records import Simulations, shown_ceilings, shown_profile

MAX_CELLS = 6000  # with more, only one record per key is shown
MAX_OTHER_RECORDS = 200  # profiles, and records of ceilings


@dataclasses.dataclass
class Records:
    """files: their names. cells: Cells. profiles, ceilings, simulations: for the page, by other_records.py.
    notes: texts on records left out and incomplete lines."""

    files: list
    cells: list = dataclasses.field(default_factory=list)
    profiles: list = dataclasses.field(default_factory=list)
    ceilings: list = dataclasses.field(default_factory=list)
    simulations: list = dataclasses.field(default_factory=list)
    verdicts: RecordedVerdicts = dataclasses.field(default_factory=RecordedVerdicts)
    notes: list = dataclasses.field(default_factory=list)


def mark_older(cells, key=lambda cell: cell.key):
    """Marks all cells of a key as older, except the last one that is ok, or the last one if none is."""
    newest = {key(cell): cell for cell in sorted(cells, key=lambda cell: cell.status == "ok")}
    for cell in cells:
        cell.is_older = newest[key(cell)] is not cell


def _kept(cells, max_cells, notes):
    """At most `max_cells`. If there are more, first older records are left out, then the last ones."""
    mark_older(cells)
    if len(cells) <= max_cells:
        return cells
    kept = [cell for cell in cells if not cell.is_older]
    if len(kept) < len(cells):
        notes.append(f"{len(cells) - len(kept)} older records of cells that were recorded again are left out")
    left_out = kept[max_cells:]
    if left_out:
        bad = sum(cell.status != "ok" for cell in left_out)
        notes.append(
            f"{len(left_out)} of {len(cells)} records of cells are left out, {bad} of them failed or wrong: a page "
            f"shows at most {max_cells}; give fewer files or fewer lines"
        )
    return kept[:max_cells]


def _add(kind, record, location, records, simulations):
    path, _, line = location.rpartition(":")
    if kind == "cell":
        records.cells.append(Cell(record, path, int(line)))
    elif kind == "verdict":
        records.verdicts.add(record, location)
    elif kind == "simulation":
        simulations.add(record, path)
    elif kind == "profile":
        records.profiles.append(shown_profile(record))
    else:
        records.ceilings.append(shown_ceilings(record))


def read_records(files, max_cells=MAX_CELLS):
    """Records of files with any kinds of records. Raises RecordError for files that cannot be read and for
    other schemas."""
    records, simulations = Records([os.path.basename(file) for file in files]), Simulations()
    for file in files:
        for location, kind, record in kinds.each(os.fspath(file), records.notes.append):
            with kinds.fields_of(kind, location):
                _add(kind, record, location, records, simulations)
    dropped = superseded(records.cells)
    cells = [cell for number, cell in enumerate(records.cells) if number not in dropped]
    records.cells = _kept(cells, max_cells, records.notes)
    records.simulations = simulations.shown()
    left_out = sum(max(len(own) - MAX_OTHER_RECORDS, 0) for own in (records.profiles, records.ceilings))
    if left_out:
        records.notes.append(
            f"{left_out} profiles or records of ceilings are left out: a page shows at most {MAX_OTHER_RECORDS} of each"
        )
        del records.profiles[MAX_OTHER_RECORDS:], records.ceilings[MAX_OTHER_RECORDS:]
    if simulations.left_out:
        records.notes.append(f"the last {simulations.left_out} simulations are left out")
    return records
