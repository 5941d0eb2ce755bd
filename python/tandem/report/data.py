# SPDX-License-Identifier: MIT
"""Makes the JSON text of records for a page, within a limit of its size."""

import dataclasses
import json

from .. import lines
from .groups import groups_of
from .leads import title, which_text
from .numbers import rounded
from .reading import WHAT_TO_GIVE
from .rows import COLUMNS, curve, rounds, row
from .sentences import group_sentences, named_cells, summary_sentences
from .sweeps import sweeps_of

LABEL_AND_GROUP_BYTES = 80  # estimate per cell
SHARED = [column for column, (is_shared, _) in enumerate(COLUMNS.values()) if is_shared]


@dataclasses.dataclass
class PageData:
    """The JSON text, the number of its cells, notes on records that are left out, and the page's sentences on
    each group of cells and on all together."""

    json: str
    cells: int
    notes: list
    sentences: list


def dumped(value):
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))


def size_of(text):
    return len(text.encode(errors="replace"))


class _Interned:
    """Repeated values, each stored once. A number refers to each."""

    def __init__(self):
        self.values, self.bytes, self._numbers = [], 2, {}

    def number(self, value):
        text = dumped(value)
        if text not in self._numbers:
            self._numbers[text] = len(self.values)
            self.values.append(value)
            self.bytes += size_of(text) + 1
        return self._numbers[text]

    def row(self, row):
        """The row with numbers instead of values in SHARED columns; None stays None."""
        return [
            self.number(value) if column in SHARED and value is not None else value
            for column, value in enumerate(row)
        ]


def _shown(cell, records):
    """The row, the curve and the rounds of a cell. Raises RecordError."""
    try:
        return row(cell, records.paths.index(cell.path)), curve(cell), rounds(cell)
    except lines.FIELD_ERRORS:
        raise lines.RecordError(
            f"{cell.location}: a record that lacks fields of its schema; {WHAT_TO_GIVE}"
        ) from None


def _fitting_cells(records, max_bytes, values):
    """Rows with interned values, curves and rounds of those cells that fit. The last cells are left out, with a
    note, if there are too many."""
    size, shown, cells = 0, [], records.cells
    for cell in cells:
        own, *times = _shown(cell, records)
        shown.append((values.row(own), *times))
        size += size_of(dumped(shown[-1][0])) + LABEL_AND_GROUP_BYTES
        if size + values.bytes > max_bytes:
            shown.pop()
            records.cells = cells[: len(shown)]
            records.notes.append(
                f"the last {len(cells) - len(shown)} of {len(cells)} cells are left out, so that the page stays small; "
                "give fewer files or fewer lines"
            )
            break
    return shown


def _group(group, cells):
    ranked = [
        [
            one.cell,
            rounded(one.ratio.value),
            rounded(one.ratio.low),
            rounded(one.ratio.high),
            one.is_told_apart if one.has_interval else None,
        ]
        for one in group.ranked
    ]
    named = named_cells(group, cells)
    return {
        "title": group.title,
        "cells": group.cells,
        "ranked": ranked,
        "differ": group.answers_differ,
        "words": group_sentences(group, cells),
        "lead": {
            "title": title(named, group.answers_differ),
            "which": "" if group.answers_differ else which_text(named),
        },
    }


class _Details:
    """Details of cells, shown as far as they fit."""

    def __init__(self, free_bytes):
        self.free_bytes, self.missing = free_bytes, 0

    def fitting(self, values):
        """The values in their order, with None for values that do not fit."""
        return [value if self._fits(size_of(dumped(value)) + 1) else None for value in values]

    def _fits(self, size):
        if size > self.free_bytes:
            self.missing += 1
            return False
        self.free_bytes -= size
        return True


def _history(cells):
    """What history.py makes of cells, if several programs recorded one."""
    programs = {(cell.key, cell.program) for cell in cells}
    if len(programs) == len({key for key, _ in programs}):
        return None, []
    from .history import shown_history  # needs scipy

    return shown_history(cells)


def _cell_data(records, values, max_bytes):
    """All data of cells on the page."""
    shown = _fitting_cells(records, max_bytes, values)
    cells, rows = records.cells, [own for own, *_ in shown]
    groups = groups_of(cells, records.verdicts)
    for group in groups:
        for number, label in zip(group.cells, group.labels):
            rows[number].append(label)
    history, moves = _history(cells)
    made = {
        "fields": list(COLUMNS),
        "shared": [name for name, (is_shared, _) in COLUMNS.items() if is_shared],
        "values": values.values,
        "history": history,
        "words": [*summary_sentences(groups, cells), *moves],
        "groups": [_group(group, cells) for group in groups],
        "sweeps": sweeps_of(cells, records.verdicts),
        "cells": rows,
        "older": [number for number, cell in enumerate(cells) if cell.is_older],
    }
    used = (
        sum(size_of(dumped(made[name])) for name in ("cells", "groups", "sweeps", "history")) + values.bytes
    )
    details = _Details(max(max_bytes - used, 0))
    made |= {
        "curves": details.fitting([own for _, own, _ in shown]),
        "rounds": details.fitting([own for *_, own in shown]),
    }
    if details.missing:
        records.notes.append(
            f"times by frame or by round of some cells are left out ({details.missing} lists), so that the page stays small"
        )
    return made


def data_of(records, max_bytes, program, date):
    """PageData of at most about `max_bytes`: cells with their groups and sentences, profiles, ceilings,
    simulations. Larger data are cut: curves and rounds are left out first, then the last cells. `program` and
    `date`: version of the program and time, for the page."""
    rest = {"profiles": records.profiles, "ceilings": records.ceilings, "simulations": records.simulations}
    cell_bytes = max(max_bytes - sum(size_of(dumped(part)) for part in rest.values()), 0)
    made = {"program": program, "date": date} | _cell_data(records, _Interned(), cell_bytes) | rest
    made |= {"files": records.files, "cell_records": records.cell_records, "notes": records.notes}
    sentences = [f"{group['title']}: {group['words']}" for group in made["groups"]] + made["words"]
    return PageData(dumped(made), len(records.cells), records.notes, sentences)
