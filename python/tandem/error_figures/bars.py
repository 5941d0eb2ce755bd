# SPDX-License-Identifier: MIT
"""Bars of missed pairs, false pairs and time of every configuration, one column per kind of scene."""

import matplotlib.pyplot as plt

from .panels import note
from .points import OF_CONTACTS, swept, words
from .points import kind as kind_of

KINDS = ("random", "resting", "constructed")
MAX_BARS = 200  # per kind of scene


def _sums_of(own):
    """Numbers of missed, meeting, false and candidate pairs of a configuration, and the mean time over its
    scenes."""
    return (
        *(sum(getattr(p, name) for p in own) for name in ("missed", "meeting")),
        *(sum(p.truth[name] for p in own) for name in ("false", "candidates")),
        sum(p.ms() for p in own) / len(own),
    )


def _column(column, configurations):
    """Draws the three panels of one kind of scene."""
    sums = [_sums_of(own) for own in configurations.values()]
    positions = range(len(sums))
    for panel, values, title, colour in (
        (column[0], [m / max(n, 1) for m, n, *_ in sums], "share of meeting pairs missed", "C0"),
        (column[1], [f / max(c, 1) for *_, f, c, _ in sums], "share of candidates that do not meet", "C1"),
        (column[2], [t for *_, t in sums], "ms per frame, mean over scenes", "C2"),
    ):
        panel.bar(positions, values, color=colour)
        panel.set_ylabel(title, fontsize=7)
    if any(n for _, n, *_ in sums):
        bounds = [3 / n if m == 0 and n else 0 for m, n, *_ in sums]
        column[0].bar(
            positions, bounds, fill=False, edgecolor="C0", ls=":", label="none missed: 95 % bound 3 / n"
        )
        column[0].set(yscale="log", ylim=(1e-8, 1))
        column[0].legend(fontsize=6)
    else:
        note(column[0], "nothing to draw: no pairs meet")
    if not any(c for *_, c, _ in sums):
        note(column[1], "nothing to draw: no candidates")
    column[2].set_xticks(
        list(positions), [" ".join(filter(None, c)) for c in configurations], rotation=90, fontsize=6
    )


def _configurations(points):
    """Points as {kind: {configuration: points}}, in the order of the bars."""
    rest = swept(points, ("k", "precision", "rounding"))
    kinds = {kind: {} for kind in KINDS if any(kind_of(p) == kind for p in points)}
    for p in sorted(
        points,
        key=lambda p: (
            int(p.asked["k"]),
            p.asked["precision"] == "double",
            p.asked["rounding"],
            words(p, rest),
        ),
    ):
        kinds[kind_of(p)].setdefault(
            (p.asked["k"], p.asked["precision"], p.asked["rounding"], words(p, rest)), []
        ).append(p)
    return kinds


def draw(points):
    """The figure and its points."""
    base = {
        s: points[0].asked.get(s) for s in OF_CONTACTS
    }  # the bars do not depend on contacts: one value of each of these settings is enough
    points = [p for p in points if all(p.asked.get(s) == v for s, v in base.items())]
    kinds = _configurations(points)
    width = max(4.5, *(0.14 * min(MAX_BARS, len(own)) for own in kinds.values()))
    figure, axes = plt.subplots(
        3, len(kinds), figsize=(width * len(kinds), 7), squeeze=False, sharex="col", layout="constrained"
    )
    for column, (kind, configurations) in zip(axes.T, kinds.items()):
        _column(column, dict(list(configurations.items())[:MAX_BARS]))
        more = (
            f", the first {MAX_BARS} of {len(configurations)} configurations"
            if len(configurations) > MAX_BARS
            else ""
        )
        column[0].set_title(f"{kind} scenes{more}")
    return figure, points
