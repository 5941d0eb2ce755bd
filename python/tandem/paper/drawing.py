# SPDX-License-Identifier: MIT
"""Common parts of the figures: size, colours, and the CSV file beside each. A title says what a figure shows; it stands
above the image on the page, and in the image only as its name."""

import csv
import dataclasses
import textwrap

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams.update(
    {
        "svg.hashsalt": "tandem",
        "svg.fonttype": "none",
        "savefig.dpi": 150,
        "font.size": 9,
        "legend.frameon": False,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "font.family": "sans-serif",
    }
)
import matplotlib.pyplot as plt
from matplotlib import ticker

from ..csv_fields import fields
from ..files import save_svg
from ..plots import COLOURS, INK, PALE, WINNER
from .tables import short

WIDTH = 6.6  # inches: two thirds of a printed page; the page shows it no smaller, so that texts stay readable
STAGES = "transform refit broad seed traverse balance contact preprocess postprocess read write".split()
COLOUR_OF = dict(
    zip(
        STAGES,
        (
            "#777777",
            "#56b4e9",
            "#999999",
            "#bbbbbb",
            "#0072b2",
            "#f0e442",
            "#009e73",
            "#cc79a7",
            "#66507a",
            "#e69f00",
            "#d55e00",
        ),
    )
)
MARKERS = dict(zip(STAGES, "osPxv^D<>pX"))
COLOUR_OF |= {"solve": "#333333", "assemble": "#aaaaaa", "reduce": "#8c6d31", "move": "#dddddd"}


@dataclasses.dataclass
class Figure:
    number: int
    title: str
    rows: list  # of the CSV
    missing: str = ""  # the reason if it could not be drawn


class Plot:
    """A figure with several panels under construction, with the rows of its CSV file."""

    def __init__(self, number, panels=1, height=3.2, columns=1, heights=None):
        """heights: of each row of panels, if they differ."""
        self.number = number
        heights = heights or [height] * -(-panels // columns)
        self.figure, axes = plt.subplots(
            len(heights),
            columns,
            figsize=(WIDTH, sum(heights)),
            height_ratios=heights,
            layout="constrained",
            squeeze=False,
        )
        self.axes = list(axes.flat)
        for spare in self.axes[panels:]:
            spare.set_visible(False)
        self.rows = []

    def save(self, folder, title):
        save_svg(self.figure, folder / f"figure{self.number}.svg", metadata={"Date": None, "Title": title})
        plt.close(self.figure)
        write_rows(folder, self.number, self.rows)
        return Figure(self.number, title, self.rows)


def write_rows(folder, number, rows):
    columns = list(dict.fromkeys(name for row in rows for name in row)) or ["missing"]
    with open(folder / f"figure{number}.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows([fields({name: short(row.get(name)) for name in columns}) for row in rows])


def missing(folder, number, title, why):
    """Draws a figure that has only the reason why it cannot be drawn."""
    plot = Plot(number, height=1.4)
    plot.axes[0].axis("off")
    plot.axes[0].text(0, 0.5, "\n".join(textwrap.wrap(why, 90)), color=INK, va="center")
    plot.rows = [{"missing": why}]
    return dataclasses.replace(plot.save(folder, title), missing=why)


def log_axis(axis):
    """A logarithmic axis with ticks at 1, 2 and 5 of each power of ten if it is short, so that it has
    several, and without exponents if there is room."""
    low, high = sorted(axis.get_view_interval())
    is_short = low > 0 and high / low < 300
    axis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5) if is_short else (1,), numticks=12))
    if high < 1e6:
        axis.set_major_formatter(
            ticker.FuncFormatter(lambda value, _: f"{value:,.0f}" if value >= 1 else f"{value:g}")
        )
    axis.set_minor_locator(ticker.NullLocator())


def symlog_axis(ax, threshold):
    """A vertical axis from 0, linear up to a threshold and logarithmic above."""
    ax.set_yscale("symlog", linthresh=threshold)
    ax.set_ylim(bottom=0)


def legend_above(ax, ncols):
    """A legend above the axes, which the layout keeps whole."""
    ax.legend(
        ncols=ncols, fontsize=8, loc="lower left", bbox_to_anchor=(0, 1), handlelength=1.2, columnspacing=1.2
    )


def milliseconds(ax):
    ax.set_ylabel("milliseconds")
    ax.grid(alpha=0.25)
