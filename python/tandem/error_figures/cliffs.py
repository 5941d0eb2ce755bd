# SPDX-License-Identifier: MIT
"""Errors over difficulty, one panel per family of hard scenes."""

import textwrap

import matplotlib.pyplot as plt

from .panels import note
from .points import OF_CONTACTS, depth, difficulty, family, sweep_text, swept


def _rule_of(point):
    return " ".join(point.asked[s] for s in ("contact_rule", "decision", "precision") if s in point.asked)


def _worst(points):
    """The largest value at each difficulty, of pairs (difficulty, value)."""
    line = {}
    for at, value in points:
        line[at] = max(value, line.get(at, value))
    return sorted(line.items())


def _lines(own, bounds_of, bounds, rules):
    """The lines of a panel, each as (style, label, points)."""
    made = [
        (
            f"C{i % 10}-o",
            f"missed, {name}",
            _worst((difficulty(p), p.missed / max(p.meeting, 1)) for p in own if bounds_of(p) == name),
        )
        for i, name in enumerate(bounds)
    ]
    made += [
        (
            f"C{5 + i % 5}--",
            f"depth, {name}",
            _worst((difficulty(p), depth(p)) for p in own if _rule_of(p) == name and depth(p) is not None),
        )
        for i, name in enumerate(rules)
    ]
    return [line for line in made if line[2]]


def _panel(panel, own, lines):
    """Draws one family: missed pairs and errors of depths over difficulty."""
    if not any(p.meeting for p in own):
        note(panel, "nothing to draw: no pairs meet")
        return
    for style, label, line in lines:
        panel.plot(*zip(*line), style, ms=2.5, lw=0.8, label=label)
    # Safe and directed bounds are certified to miss nothing at any difficulty (algorithms/bounds/README.md).
    panel.axhspan(-5e-9, 2e-9, color="0.85", label="certified: safe, directed")
    difficulties = sorted({difficulty(p) for p in own})
    if difficulties[0] > 0 and difficulties[-1] >= 100 * difficulties[0]:
        panel.set_xscale("log")
    panel.set_yscale("symlog", linthresh=1e-8)
    panel.set_ylim(-5e-9, 2)
    panel.set_yticks([0, 1e-8, 1e-6, 1e-4, 1e-2, 1])
    panel.tick_params(labelsize=6)


def _families(points):
    """Points by family, for families with several difficulties."""
    families = {}
    for p in points:
        if family(p) and difficulty(p) is not None:
            families.setdefault(family(p), []).append(p)
    return {name: own for name, own in families.items() if len({difficulty(p) for p in own}) > 1}


def _title(figure, axes, points, bounds_settings, columns):
    handles = {
        label: handle for panel in axes.flat for handle, label in zip(*panel.get_legend_handles_labels())
    }
    figure.legend(
        handles.values(), handles.keys(), loc="lower center", ncol=6, fontsize=7, bbox_to_anchor=(0.5, 1.0)
    )
    rest = sweep_text(swept(points, (*bounds_settings, *OF_CONTACTS)))
    text = "difficulty; solid: share of meeting pairs missed; dashed: depth error (99th percentile, / L)" + (
        f"; worst over {rest}" if rest else ""
    )
    figure.supxlabel("\n".join(textwrap.wrap(text, 40 * columns)), fontsize=8)


def draw(points):
    """Draws the figure. Returns it with its points, or None if there is no family for it."""
    families = _families(points)
    if not families:
        return None
    points = [p for own in families.values() for p in own]
    bounds_settings = ["rounding", *(name for name in ("axes", "placement") if name in swept(points))]
    bounds_of = lambda p: " ".join(p.asked[name] for name in bounds_settings if name in p.asked)
    columns = min(4, len(families))
    rows = -(-len(families) // columns)
    figure, axes = plt.subplots(
        rows, columns, figsize=(3 * columns, 1.9 * rows), squeeze=False, layout="constrained"
    )
    for panel in axes.flat[len(families) :]:
        panel.axis("off")
    # Equal bounds and rules have equal colours in all families.
    bounds, rules = sorted({bounds_of(p) for p in points}), sorted({_rule_of(p) for p in points})
    for panel, (name, own) in zip(axes.flat, families.items()):
        _panel(panel, own, _lines(own, bounds_of, bounds, rules))
        panel.set_title(name, fontsize=8)
    _title(figure, axes, points, bounds_settings, columns)
    return figure, points
