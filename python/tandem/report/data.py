# SPDX-License-Identifier: MIT
"""Makes the data and the parts of a page from records, within a limit of its size."""

import dataclasses
import json

from ..kinds import fields_of
from ..pages.frame import Section
from ..pages.markup import markup
from . import overview, parts
from .answers import answers
from .cells import charted, row
from .conditions import conditions
from .groups import groups_of, is_rankable
from .numbers import ratio_row
from .sentences import cautions, finding, group_sentences, stage_text, summary_sentences
from .sweeps import sweeps_of


@dataclasses.dataclass
class PageData:
    """json: data of the charts. sections: parts of the page. cells: their number. notes: on records that are
    left out. sentences: on each group of cells, and on all together."""

    json: str
    sections: list
    cells: int
    notes: list
    sentences: list

    @property
    def size(self):
        return size_of(self.json) + sum(size_of(markup(section.content)) for section in self.sections)


def dumped(value):
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))


def size_of(text):
    return len(text.encode(errors="replace"))


def _group(group, cells):
    ranked = [
        [one.cell, *ratio_row(one.ratio), one.is_told_apart if one.has_interval else None]
        for one in group.ranked
    ]
    return {"title": group.title, "row": group.row, "ranked": ranked, "stages": stage_text(group, cells)}


def _history(cells):
    """What history.py makes of cells, if several programs recorded one."""
    programs = {(cell.key, cell.program) for cell in cells}
    if len(programs) == len({key for key, _ in programs}):
        return None, []
    from .history import shown_history  # needs scipy

    return shown_history(cells)


def _order(groups, cells):
    """Numbers of cells as tables have them: by group, the fastest first, those that are not ranked last."""
    return [
        number
        for group in groups
        for number in sorted(group.cells, key=lambda at: (not is_rankable(cells[at]), cells[at].ms() or 0))
    ]


def _made(records, differences):
    """PageData of all cells of the records."""
    cells, groups = records.cells, groups_of(records.cells, records.verdicts)
    against = {one["cell"]: one["against"] for one in differences["cells"]} if differences else {}
    labels = {number: label for group in groups for number, label in zip(group.cells, group.labels)}
    shown, charted_cells = [], []
    for number, cell in enumerate(cells):
        with fields_of("cell", cell.location):
            label = labels[number]
            shown.append(row(cell, label, against.get(number)))
            charted_cells.append(charted(cell, label))
    rows = overview.rows_of(groups, cells)
    groups = overview.in_order(groups, rows)
    history, moves = _history(cells)
    methods = overview.methods_of(rows)
    sections = [
        parts.results([*([differences["title"]] if differences else []), *moves], records.notes, bool(cells)),
        *([answers(groups, cells), conditions(cells, cautions(cells))] if cells else []),
        Section("charts", "Charts", is_hidden=True),
        *(
            [parts.tables(rows, methods, cells, [shown[number] for number in _order(groups, cells)])]
            if cells
            else []
        ),
        *([parts.ceilings(records.ceilings)] if records.ceilings else []),
    ]
    data = {
        "cells": charted_cells,
        "overview": overview.charted(rows, methods, finding(groups, cells) if cells else ""),
        "groups": [_group(group, cells) for group in groups],
        "sweeps": sweeps_of(cells, records.verdicts),
        "history": history,
        "differences": differences,
        "profiles": records.profiles,
        "simulations": records.simulations,
    }
    texts = [f"{group.title}: {group_sentences(group, cells)}" for group in groups]
    sentences = [*texts, *summary_sentences(groups, cells), *moves] if cells else []
    return PageData(dumped(data), sections, len(cells), records.notes, sentences)


def data_of(records, max_bytes, differences=None):
    """PageData of at most `max_bytes`. Of larger data the last cells are left out. `differences`: from
    differences.py."""
    made, count, notes = _made(records, differences), len(records.cells), records.notes
    while made.size > max_bytes and made.cells:
        records.cells = records.cells[: int(0.95 * made.cells * max(max_bytes, 0) / made.size)]
        left_out = f"the last {count - len(records.cells)} of {count} cells are left out, so that the page stays small"
        records.notes = [*notes, f"{left_out}; give fewer files or fewer lines"]
        made = _made(records, differences)
    return made
