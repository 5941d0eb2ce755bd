# SPDX-License-Identifier: MIT
"""The parts of the page that need no scripts: summary, table of cells, ceilings."""

from ..pages.frame import Section
from ..pages.markup import element, items, paragraphs
from ..pages.tables import table
from .cells import COLUMNS
from .methods import drawings_of

SHOWN_GROUPS = 10  # of the summary; readers open the others
HOW = (
    "Comparisons are between cells of one scene, frame range, devices, bounds and output. Brackets are 95 % intervals, each of one "
    "comparison. Two cells are not told apart if the interval of their ratio contains 1."
)
CELLS = "A heading sorts; a cell's name shows its settings, conditions and command."


def summary(groups, sentences, words, notes, differences):
    """`sentences`: those on each group; `words`: those on all together. Groups with a comparison or an error
    come first."""
    shown = [element("p", f"Left out: {note}.", class_="bad") for note in notes]
    if not groups:
        return Section("summary", "Summary", [*shown, element("p", "There are no cells in these files.")])
    leads = [differences["title"]] if differences else []
    lines = sorted(zip(groups, sentences), key=lambda pair: not pair[0].is_informative)
    lines = [[element("strong", f"{group.title}: "), sentence] for group, sentence in lines]
    rest = lines[SHOWN_GROUPS:]
    more = (
        element("details", element("summary", f"{len(rest)} more comparisons"), items(rest)) if rest else None
    )
    shown += [*paragraphs([*leads, *words], "lead"), items(lines[:SHOWN_GROUPS]), more]
    return Section("summary", "Summary", [*shown, element("p", HOW, class_="quiet")])


def cells(rows, algorithms):
    """`rows`: of all cells; `algorithms`: names of theirs."""
    shown = table("Every cell", COLUMNS, rows, heading=False, notes=[CELLS], sorts=True)
    return Section("cells", "Every cell", [*drawings_of(algorithms), shown])


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
