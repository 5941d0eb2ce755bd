# SPDX-License-Identifier: MIT
"""Draws all figures and writes their data beside them."""

import csv

import matplotlib
import matplotlib.pyplot as plt

from ..csv_fields import fields
from ..files import check_output, save_svg
from . import bars, cliffs, pareto
from .points import row, swept

SHOWN = ("k", "axes", "precision", "rounding", "decision", "contact_rule")
STYLE = {
    "svg.hashsalt": "tandem",
    "font.size": 8,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "legend.frameon": False,
}


def _write_data(path, points):
    settings = [*SHOWN, *(name for name in swept(points, ("cell", "device")) if name not in SHOWN)]
    rows = [row(p) for p in points]
    names = list(rows[0])
    first, last = names[: names.index("cell") + 1], names[names.index("ms") :]
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, [*first, *settings, *last], extrasaction="ignore", restval="")
        writer.writeheader()
        writer.writerows(map(fields, rows))


def _save(folder, name, drawn):
    """Writes a figure and its data. Returns a list with the name of its file, empty if there is no figure."""
    if drawn is None:
        return []
    figure, points = drawn
    for ending in ("svg", "csv"):
        check_output(folder / f"{name}.{ending}")
    save_svg(figure, folder / f"{name}.svg", metadata={"Date": None}, bbox_inches="tight")
    plt.close(figure)
    _write_data(folder / f"{name}.csv", points)
    return [f"{name}.svg"]


def figures(points, folder):
    """Draws all figures. Returns a text with their names, and one about scenes that are not drawn. Raises
    OSError."""
    matplotlib.use("svg")
    with matplotlib.rc_context(STYLE):
        figures_by_name = {"bars": bars, "cliffs": cliffs, "pareto": pareto}
        names = [
            file
            for name, module in figures_by_name.items()
            for file in _save(folder, name, module.draw(points))
        ]
    scenes = len(pareto.scenes_of(points))
    return ", ".join(
        names
    ), f"; pareto has the first {pareto.MAX_SCENES} scenes of {scenes}" if scenes > pareto.MAX_SCENES else ""
