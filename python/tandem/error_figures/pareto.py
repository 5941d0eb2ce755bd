# SPDX-License-Identifier: MIT
"""Time over errors, one column per scene. Pareto-optimal cells are joined by a line and have names."""

import collections
import math
import textwrap

import matplotlib.pyplot as plt

from .panels import few_ticks, note
from .points import OF_CONTACTS, depth, ends, label, normal, short_words, sweep_text, swept

MAX_SCENES = 4
MAX_NAMES = 5  # per panel
PALE, FRONT = "0.7", "#0b5394"

# A kind of error over which time is drawn. `value` takes a point. `without`: settings that do not affect it.
# `step`: factor between two named points, at least. `gain`: what a smaller value means.
Error = collections.namedtuple("Error", "value without title gain step")
ERRORS = (
    Error(
        lambda p: p.truth["candidate_ratio"],
        OF_CONTACTS,
        "candidates per meeting pair",
        "fewer candidates",
        1.01,
    ),
    Error(depth, (), "depth error, 99th percentile, / L", "less error", 2),
    Error(normal, (), "normal error, 99th percentile, degrees", "less error", 2),
)


def frontier(points, value, step):
    """The Pareto-optimal points in time and value, by time. Each value is smaller than the one before by a
    factor of at least `step`."""
    best, line = float("inf"), []
    for p in sorted(points, key=lambda p: (p.ms(), value(p))):
        if value(p) * step <= best:
            best = value(p)
            line.append(p)
    return line


def _most_distinct(line, value):
    """At most MAX_NAMES points of a frontier: its ends and the points after its largest steps."""
    if len(line) <= MAX_NAMES:
        return line
    steps = sorted(
        range(1, len(line) - 1), key=lambda i: math.log(value(line[i - 1]) / value(line[i])), reverse=True
    )
    return [line[i] for i in sorted({0, len(line) - 1, *steps[: MAX_NAMES - 2]})]


def _alike(point, points, value):
    """Number of other points with overlapping intervals of time and a value that differs by less than a
    thousandth."""
    low, high = ends(point)
    return sum(
        q is not point
        and ends(q)[0] <= high
        and ends(q)[1] >= low
        and abs(value(q) / value(point) - 1) < 1e-3
        for q in points
    )


def _message(line, names, value, gain):
    first, last = line[0], line[-1]
    if first is last:
        return f"{names[first]}: the fastest, and nothing is better"
    less = value(first) / value(last)
    return (
        f"{names[first]}: the fastest; {names[last]}: {f'{less:.2f}' if less < 10 else f'{less:.0e}'} times {gain} for "
        f"{last.ms() / first.ms():.2f} times the time"
    )


def _draw_all(axes, points, value):
    """Draws all points in a pale colour, hollow ones for cells that miss pairs."""
    for group, hollow in (
        ([p for p in points if p.missed == 0], False),
        ([p for p in points if p.missed > 0], True),
    ):
        axes.hlines(
            [value(p) for p in group], *([ends(p)[i] for p in group] for i in (0, 1)), color=PALE, lw=0.8
        )
        axes.plot(
            [p.ms() for p in group],
            [value(p) for p in group],
            "o",
            ms=3.5,
            mec=PALE,
            mfc="none" if hollow else PALE,
            ls="",
        )
    axes.set(xscale="log", yscale="log")


def _draw_front(axes, points, value, line, names):
    """Draws the frontier with its line and names."""
    middle = math.sqrt(min(q.ms() for q in points) * max(q.ms() for q in points))
    axes.plot(
        [p.ms() for p in line],
        [value(p) for p in line],
        color=FRONT,
        lw=0.7,
        drawstyle="steps-post",
        zorder=0,
    )
    for p in line:
        more = _alike(p, [q for q in points if q.missed == 0], value)
        axes.hlines(value(p), *ends(p), color=FRONT, lw=1.6)
        axes.plot(p.ms(), value(p), "o", ms=5, color=FRONT)
        late = p.ms() > middle
        axes.annotate(
            names[p] + (f" (and {more} alike)" if more else ""),
            (p.ms(), value(p)),
            xytext=(-3 if late else 3, 5),
            textcoords="offset points",
            ha="right" if late else "left",
            fontsize=7,
            color=FRONT,
        )


def _scatter(axes, points, error):
    """Draws a panel. Names those points of the frontier that gain the error's step, by the settings in which
    they differ."""
    value = error.value
    axes.set(xlabel="ms per frame", ylabel=error.title)
    known = [p for p in points if value(p) is not None]
    points = [p for p in known if value(p) > 0 and p.ms() > 0]
    if not points:
        note(
            axes,
            "nothing to draw: all are 0"
            if known
            else "nothing to draw: no cell was asked for this (--truth contacts)",
        )
        return
    _draw_all(axes, points, value)
    line = _most_distinct(frontier([p for p in points if p.missed == 0], value, error.step), value)
    if line:
        distinguishing = swept(line, error.without) or swept(points, error.without)
        names = {p: short_words(p, distinguishing) or label(p) for p in line}
        _draw_front(axes, points, value, line, names)
        axes.set_title(
            "\n".join(textwrap.wrap(_message(line, names, value, error.gain), 80)), fontsize=8, loc="left"
        )
    axes.margins(x=0.1, y=0.15)
    few_ticks(axes)
    values = [value(p) for p in points]
    if max(values) < 2 * min(values):  # avoids ticks that differ in the sixth digit
        axes.set_ylim(min(values) / 2, max(values) * 2)


def _column(panels, scene, own):
    for axes, error in zip(panels, ERRORS):
        _scatter(axes, own, error)
    title = f"{scene}: {sweep_text(swept(own)) or 'one cell'}. Pale: beaten in both; hollow: misses pairs that meet; bars: 95 % of the median"
    panels[-1].text(
        0,
        -0.32,
        "\n".join(textwrap.wrap(title, 100)),
        transform=panels[-1].transAxes,
        fontsize=7,
        va="top",
        color="0.3",
    )


def scenes_of(points):
    """Names of the scenes, without hard ones."""
    return [s for s in dict.fromkeys(p.scene for p in points) if not s.startswith("hard")]


def draw(points):
    """Draws the figure of the first MAX_SCENES scenes. Returns it with its points, or None if there is no
    scene for it."""
    shown = scenes_of(points)[:MAX_SCENES]
    if not shown:
        return None
    figure, axes = plt.subplots(
        len(ERRORS), len(shown), figsize=(6.4 * len(shown), 9), squeeze=False, layout="constrained"
    )
    for column, scene in zip(axes.T, shown):
        _column(column, scene, [p for p in points if p.scene == scene])
    return figure, [p for p in points if p.scene in shown]
