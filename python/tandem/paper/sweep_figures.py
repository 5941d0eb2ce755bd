# SPDX-License-Identifier: MIT
"""Figures 13 and 14: seed thresholds, and chunk bytes with orders of tetrahedra."""

import numpy

from ..fields import at
from .drawing import COLOUR_OF, COLOURS, INK, WINNER, Plot, legend_above, log_axis, milliseconds, missing
from .methods import name_of
from .tables import written


def _threshold(case):
    return int(case.settings["seed_threshold"])


def _threshold_panel(ax, x, own):
    """Draws times over thresholds. Returns the fastest threshold."""
    for name, colour in (
        ("traverse", COLOUR_OF["traverse"]),
        ("seed", "#777777"),
        ("write", COLOUR_OF["write"]),
    ):
        ax.plot(
            x,
            [1e3 * case.stage(name) / case.frames for case in own],
            "o-",
            color=colour,
            markersize=4,
            label=name,
        )
    median, low, high = (
        numpy.array([1e3 * case.total(which) / case.frames for case in own])
        for which in ("median", "low", "high")
    )
    ax.plot(x, median, "o-", color=INK, markersize=4, label="whole frame")
    ax.fill_between(x, low, high, color=INK, alpha=0.15, linewidth=0)
    ax.set(xscale="log", yscale="log", xlabel="seed threshold")
    ax.set_title(name_of(own[0]), fontsize=9, loc="right", color=INK)
    milliseconds(ax)
    log_axis(ax.xaxis)
    log_axis(ax.yaxis)
    legend_above(ax, 4)
    best = int(median.argmin())
    ax.plot(x[best], median[best], "o", color=WINNER, markersize=8, fillstyle="none")
    return x[best]


def figure13(folder):
    # With 0, another setting chooses the level.
    cases = sorted(filter(_threshold, folder.cases("thresholds")), key=_threshold)
    presets = [
        preset for preset in ("published", "paper", "grouped") if any(case.preset == preset for case in cases)
    ]
    if not presets:
        return missing(folder.path, 13, "Seed thresholds", "no cell of the sweep has completed")
    plot = Plot(13, len(presets), 2.7)
    minima = []
    for ax, preset in zip(plot.axes, presets):
        own = [case for case in cases if case.preset == preset]
        x = [_threshold(case) for case in own]
        minima.append(f"{name_of(own[0])} at {written(_threshold_panel(ax, x, own))}")
        plot.rows += [
            {
                "method": name_of(case),
                "seed_threshold": value,
                "traverse_ms": 1e3 * case.stage("traverse") / case.frames,
                "whole_ms": 1e3 * case.total() / case.frames,
                "low_ms": 1e3 * case.total("low") / case.frames,
                "high_ms": 1e3 * case.total("high") / case.frames,
                "seeds": sum(
                    cell.record["work"]["counters"].get("seeds", 0)
                    for cell in case.cells
                    if at(cell.record, "work", "counters")
                )
                / case.frames,
                "samples": case.rounds,
                "records": case.locations[0],
            }
            for value, case in zip(x, own)
        ]
    span = f"{written(_threshold(cases[0]))} to {written(_threshold(cases[-1]))}"
    return plot.save(
        folder.path,
        f"Seed thresholds of {span} on {cases[0].scene}; the least median: {'; '.join(minima)} (the paper's, of 1 to 1,000,000,000, are bars without numbers)",
    )


def _chunk_panel(plot, ax, cases, k):
    """Draws a frame's time over chunk bytes by order. Returns the fastest in words."""
    own_k = [case for case in cases if case.settings["k"] == k]
    for colour, order in zip(COLOURS, sorted({case.settings["builder"] for case in own_k})):
        own = sorted(
            (case for case in own_k if case.settings["builder"] == order),
            key=lambda case: int(case.settings["chunk_bytes"]),
        )
        x = [int(case.settings["chunk_bytes"]) for case in own]
        y, low, high = (
            [1e3 * case.total(which) / case.frames for case in own] for which in ("median", "low", "high")
        )
        ax.fill_between(x, low, high, color=colour, alpha=0.2, linewidth=0)
        ax.plot(x, y, "o-", color=colour, markersize=4, label=order)
        plot.rows += [
            {
                "k": k,
                "method": name_of(case),
                "order": order,
                "chunk_bytes": bytes_,
                "ms": ms,
                "low_ms": l,
                "high_ms": h,
                "records": case.locations[0],
            }
            for case, bytes_, ms, l, h in zip(own, x, y, low, high)
        ]
    ax.set(xscale="log", yscale="log", xlabel="chunk bytes of equation (1)")
    ax.set_title(f"{name_of(own_k[0])}, k = {k}", fontsize=9, loc="right", color=INK)
    milliseconds(ax)
    log_axis(ax.xaxis)
    log_axis(ax.yaxis)
    legend_above(ax, 4)
    best = min(own_k, key=lambda case: case.total() / case.frames)
    ax.plot(
        int(best.settings["chunk_bytes"]),
        1e3 * best.total() / best.frames,
        "o",
        color=WINNER,
        markersize=9,
        fillstyle="none",
    )
    return f"{best.settings['builder']}, {int(best.settings['chunk_bytes']):,} bytes with k = {k}"


def figure14(folder):
    """Chunk bytes of equation (1) and orders of tetrahedra. The paper mentions them but does not measure them."""
    cases = folder.cases("chunk-study")
    if not cases:
        return missing(
            folder.path, 14, "Chunk bytes and orders of tetrahedra", "no cell of the study has completed"
        )
    panels = sorted(
        {(case.preset, case.settings["k"]) for case in cases}, key=lambda panel: (panel[0], int(panel[1]))
    )
    plot = Plot(14, len(panels), 3.0)
    minima = [
        _chunk_panel(plot, ax, [case for case in cases if case.preset == preset], k)
        for ax, (preset, k) in zip(plot.axes, panels)
    ]
    return plot.save(
        folder.path,
        f"Beyond the paper, chunk bytes and orders on {cases[0].scene}, with the least medians: {'; '.join(minima)}",
    )
