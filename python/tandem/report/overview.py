# SPDX-License-Identifier: MIT
"""The first screen of the page: a row for each comparison, with the fastest cell of each method, as data of a chart and
as a table that needs no script."""

import dataclasses

from .. import names
from ..pages.markup import element
from ..pages.tables import Column, number_text, table
from .leads import is_leader
from .sentences import best_of_methods, method_of

MAX_ROWS = 30  # of the chart
MAX_TABLE_ROWS = 200


@dataclasses.dataclass
class Row:
    """marks: {method: number of its fastest cell}; wrong: {method: that of a wrong cell that has
    times}. leaders: the methods of the fastest cell, and of those that nothing tells apart from it."""

    group: object
    marks: dict
    wrong: dict
    leaders: list

    def least(self, cells):
        """Milliseconds per frame of the fastest cell, wrong ones only if there is no other."""
        return min(cells[number].ms() for number in (self.marks or self.wrong).values())


def _row(group, cells):
    best = {
        name: one for name, one in best_of_methods(group, cells).items() if cells[one.cell].ms() is not None
    }
    leaders = (
        []
        if group.answers_differ
        else [name for name, one in best.items() if is_leader(one, group.ranked[0])]
    )
    wrong = {}
    for one in group.cells:
        if cells[one].status == "wrong" and cells[one].ms() is not None and not cells[one].is_older:
            wrong.setdefault(method_of(cells[one]), one)
    return Row(group, {name: one.cell for name, one in best.items()}, wrong, leaders)


def rows_of(groups, cells):
    """Rows by time; those that compare something come before the others."""
    rows = [_row(group, cells) for group in groups]
    rows = [row for row in rows if row.marks or row.wrong]
    return sorted(rows, key=lambda row: (not row.group.is_informative, row.least(cells)))


def in_order(groups, rows):
    """The groups in the order of their rows; those without a row last."""
    place = {id(row.group): number for number, row in enumerate(rows)}
    return sorted(groups, key=lambda group: place.get(id(group), len(rows)))


def methods_of(rows):
    """The methods of the rows, in the order of all pages."""
    return names.in_order(name for row in rows for name in (*row.marks, *row.wrong))


def charted(rows, methods, title):
    """The data of the chart."""
    shown = [
        {
            "name": row.group.row,
            "key": row.group.key,
            "leaders": [name in row.leaders for name in methods],
            "marks": [row.marks.get(name) for name in methods],
            "wrong": [row.wrong.get(name) for name in methods],
        }
        for row in rows[:MAX_ROWS]
    ]
    return {"title": title, "methods": methods, "rows": shown, "left": len(rows) - len(shown)}


def _value(row, method, cells):
    if method in row.marks:
        ms = number_text(cells[row.marks[method]].ms())
        return element("strong", ms) if method in row.leaders else ms
    return element("span", "wrong", class_="bad") if method in row.wrong else ""


def times(rows, methods, cells):
    """The table of milliseconds per frame. The fastest of a row is bold."""
    columns = [Column("scene", style="name"), *(Column(name, True) for name in methods)]
    left = len(rows) - MAX_TABLE_ROWS
    notes = [
        "The fastest cell of each method. The fastest method of a row is bold, and so are those that cannot be told apart from it."
    ]
    notes += [f"{left} more rows are left out."] if left > 0 else []
    shown = [
        [element("span", row.group.row, title=row.group.key), *(_value(row, name, cells) for name in methods)]
        for row in rows[:MAX_TABLE_ROWS]
    ]
    return table("Milliseconds per frame", columns, shown, notes=notes)
