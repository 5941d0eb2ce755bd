# SPDX-License-Identifier: MIT
"""Makes the data and the parts of a page from records, within a limit of its size."""

import dataclasses
import json

from ..kinds import fields_of
from ..pages.markup import markup
from . import parts
from .cells import charted, curve, details, row
from .groups import groups_of
from .leads import title, which_text
from .numbers import ratio_row
from .sentences import group_sentences, named_cells, summary_sentences
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


def dumped(value):
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))


def size_of(text):
    return len(text.encode(errors="replace"))


def _group(group, cells):
    named = named_cells(group, cells)
    ranked = [
        [one.cell, *ratio_row(one.ratio), one.is_told_apart if one.has_interval else None]
        for one in group.ranked
    ]
    which = "" if group.answers_differ else which_text(named)
    return {
        "title": group.title,
        "ranked": ranked,
        "lead": title(named, group.answers_differ),
        "which": which,
    }


def _history(cells):
    """What history.py makes of cells, if several programs recorded one."""
    programs = {(cell.key, cell.program) for cell in cells}
    if len(programs) == len({key for key, _ in programs}):
        return None, []
    from .history import shown_history  # needs scipy

    return shown_history(cells)


class _Cells:
    """What a page has of cells: `data` for charts, `rows` of the table, and `size` in bytes. Details and curves
    come with fit()."""

    def __init__(self, cells, verdicts):
        self.cells, self.groups = cells, groups_of(cells, verdicts)
        labels = {
            number: label or cells[number].algorithm
            for group in self.groups
            for number, label in zip(group.cells, group.labels)
        }
        self.rows, self.details, charts = [], [None] * len(cells), []
        for number, cell in enumerate(cells):
            with fields_of("cell", cell.location):
                self.rows.append(row(cell, labels[number]))
                charts.append(charted(cell, labels[number]))
        history, moves = _history(cells)
        self.words = [*summary_sentences(self.groups, cells), *moves]
        self.sentences = [group_sentences(group, cells) for group in self.groups]
        self.data = {
            "cells": charts,
            "groups": [_group(group, cells) for group in self.groups],
            "sweeps": sweeps_of(cells, verdicts),
            "history": history,
        }
        shown = self.summary([], None).content, parts.cells_part(self.rows, self.details).content
        self.size = sum(map(size_of, (dumped(self.data), *map(markup, shown))))

    def summary(self, notes, differences):
        return parts.summary(self.groups, self.sentences, self.words, notes, differences)

    def fit(self, free_bytes, against):
        """Adds details and curves of cells as far as they fit. Returns the number of those left out."""
        left_out = 0
        for number, cell in enumerate(self.cells):
            with fields_of("cell", cell.location):
                shown = details(cell, against.get(number)), curve(cell)
            for value, kept, name in zip(
                shown, (self.details, self.data["cells"][number]), (number, "curve")
            ):
                size = size_of(dumped(value)) if value else 0
                if size > free_bytes:
                    left_out += 1
                else:
                    free_bytes -= size
                    kept[name] = value
        return left_out


def _fitting_cells(records, max_bytes, against):
    """_Cells of the first cells, as many as fit. Adds notes on what is left out."""
    all_cells = len(records.cells)
    made = _Cells(records.cells, records.verdicts)
    while made.size > max_bytes and records.cells:
        kept = int(0.95 * len(records.cells) * max(max_bytes, 0) / made.size)
        records.cells = records.cells[:kept]
        made = _Cells(records.cells, records.verdicts)
    if len(records.cells) < all_cells:
        records.notes.append(
            f"the last {all_cells - len(records.cells)} of {all_cells} cells are left out, so that the page stays small; "
            "give fewer files or fewer lines"
        )
    left_out = made.fit(max_bytes - made.size, against)
    if left_out:
        records.notes.append(
            f"times by frame or details of some cells are left out ({left_out} of them), so that the page stays small"
        )
    return made


def data_of(records, max_bytes, differences=None):
    """PageData of at most about `max_bytes`. Larger data are cut: curves and details of cells are left out
    first, then the last cells. `differences`: from differences.py."""
    rest = {name: getattr(records, name) for name in ("profiles", "simulations")} | {
        "differences": differences
    }
    against = {one["cell"]: one["against"] for one in (differences or {"cells": ()})["cells"]}
    made = _fitting_cells(records, max_bytes - size_of(dumped(rest)), against)
    sections = [made.summary(records.notes, differences)]
    sections.append(parts.Section("charts", "Charts", is_hidden=True))
    if made.rows:
        sections.append(parts.cells_part(made.rows, made.details))
    if records.ceilings:
        sections.append(parts.ceilings(records.ceilings))
    json_text = dumped(made.data | rest)
    sentences = [f"{group.title}: {words}" for group, words in zip(made.groups, made.sentences)] + made.words
    return PageData(json_text, sections, len(records.cells), records.notes, sentences)
