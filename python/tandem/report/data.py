# SPDX-License-Identifier: MIT
"""The records of a page as JSON text that fits it."""
import dataclasses
import json

from .groups import groups_of
from .numbers import rounded
from .sentences import group_sentences, summary_sentences
from .shown_cells import FIELDS

LABEL_AND_GROUP_BYTES = 80  # about so many a cell
SHARED = [place for place, is_shared in enumerate(FIELDS.values()) if is_shared]


@dataclasses.dataclass
class PageData:
    """The JSON text, how many cells are shown, and notes about what was left out."""
    json: str
    cells: int
    notes: list


def dumped(value):
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))


def size_of(text):
    return len(text.encode(errors="replace"))


class _Interned:
    """Values that occur again and again, each once: what refers to one is its number."""

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
        """The row with numbers in place of what cells share; None stays None."""
        return [self.number(value) if place in SHARED and value is not None else value for place, value in enumerate(row)]


def _fitting_cells(records, room, values):
    """How many cells there is room for, with their rows interned. The last ones are left out where there is none, and a note says how many."""
    size = 0
    for kept, cell in enumerate(records.cells):
        cell.row = values.row(cell.row)
        size += size_of(dumped(cell.row)) + LABEL_AND_GROUP_BYTES
        if size + values.bytes > room:
            records.notes.append(f"the last {len(records.cells) - kept} of {len(records.cells)} cells are left out, so that the page stays small; "
                                 "give fewer files, or the lines that matter")
            return records.cells[:kept]
    return records.cells


def _group(group, cells):
    ranked = [[one.cell, rounded(one.ratio.value), rounded(one.ratio.low), rounded(one.ratio.high), one.is_distinguished] for one in group.ranked]
    return {"title": group.title, "cells": group.cells, "ranked": ranked, "differ": group.answers_differ, "words": group_sentences(group, cells)}


class _Details:
    """What is shown of cells where there is room."""

    def __init__(self, room):
        self.room, self.missing = room, 0

    def fitting(self, values):
        """The values in their order, None where one does not fit any more."""
        return [value if self._fits(size_of(dumped(value)) + 1) else None for value in values]

    def _fits(self, size):
        if size > self.room:
            self.missing += 1
            return False
        self.room -= size
        return True


def _made_of_cells(records, values, room):
    """All that the page has of cells."""
    cells = records.cells = _fitting_cells(records, room, values)
    groups = groups_of(cells)
    for group in groups:
        for number, label in zip(group.cells, group.labels):
            cells[number].row.append(label)
    made = {"fields": list(FIELDS), "shared": [name for name, is_shared in FIELDS.items() if is_shared], "values": values.values,
            "words": summary_sentences(groups, cells), "groups": [_group(group, cells) for group in groups],
            "cells": [cell.row for cell in cells], "older": [number for number, cell in enumerate(cells) if cell.is_older]}
    used = size_of(dumped(made["cells"])) + size_of(dumped(made["groups"])) + values.bytes
    details = _Details(max(room - used, 0))
    made |= {"curves": details.fitting([cell.curve for cell in cells]), "rounds": details.fitting([cell.rounds for cell in cells])}
    if details.missing:
        records.notes.append(f"times by frame or by round of some cells are left out ({details.missing} lists), so that the page stays small")
    return made


def data_of(records, most_bytes, program, date):
    """PageData of about `most_bytes` at most: cells with their groups and sentences, profiles, ceilings, simulations. What there is no room
    for is left out: curves and rounds first, then cells, the last ones first. `program` and `date` say what made the page, and when."""
    rest = {"profiles": records.profiles, "ceilings": records.ceilings, "simulations": records.simulations}
    room = max(most_bytes - sum(size_of(dumped(part)) for part in rest.values()), 0)
    made = {"program": program, "date": date} | _made_of_cells(records, _Interned(), room) | rest
    made |= {"files": records.files, "cell_records": records.cell_records, "notes": records.notes}
    return PageData(dumped(made), len(records.cells), records.notes)
