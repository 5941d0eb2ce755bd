# SPDX-License-Identifier: MIT
"""Functions for panels of several figures."""

import matplotlib.ticker


def note(panel, text):
    """Writes a text into an empty panel."""
    panel.text(
        0.5,
        0.5,
        text,
        transform=panel.transAxes,
        ha="center",
        va="center",
        fontsize=7,
        color="0.4",
        wrap=True,
    )
    panel.set(xticks=[], yticks=[])


def few_ticks(axes):
    """Sets ticks with plain numbers on axes that span too few powers of ten."""
    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        if low > 0 and high < 50 * low:
            axis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1, 2, 5)))
            axis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda value, _: f"{value:g}"))
            axis.set_minor_formatter(matplotlib.ticker.NullFormatter())
