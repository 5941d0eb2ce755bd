# SPDX-License-Identifier: MIT
"""The parts of the page that need no scripts: the place of the first charts, and the tables."""

from ..pages.frame import Section
from ..pages.markup import element, paragraphs
from ..pages.tables import table
from .cells import COLUMNS
from .methods import drawings_of
from .overview import times

CELLS = "A heading sorts; a cell's name shows its settings, conditions and command."
NO_CELLS = "There are no cells in these files."


def results(leads, notes, has_cells):
    """The first part, whose charts scripts add. `leads`: sentences above them; `notes`: on what is left out."""
    shown = [element("p", f"Left out: {note}.", class_="bad") for note in notes]
    shown += paragraphs(leads, "lead") if has_cells else [element("p", NO_CELLS)]
    return Section("results", "Results", shown)


def tables(rows, methods, cells, shown):
    """`rows`, `methods`: from overview.py; `shown`: rows of all cells."""
    every = table("Every cell", COLUMNS, shown, notes=[CELLS], anchor="every", sorts=True)
    drawings = drawings_of(cells)
    return Section("cells", "Tables", [times(rows, methods, cells) if rows else None, drawings, every])


def ceilings(devices):
    """`devices`: from other_records.shown_ceilings."""
    rows = [
        [name.replace("_", " "), *(device[part].get(name, "not known") for device in devices)]
        for part in ("values", "conditions")
        for name in dict.fromkeys(name for device in devices for name in device[part])
    ]
    label = "Medians of the measurements of each device, and their conditions"
    shown = table(label, ["measured", *(device["device"] for device in devices)], rows)
    return Section("others", "Ceilings of devices", shown)
