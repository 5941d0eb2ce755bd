# SPDX-License-Identifier: MIT
"""Figures 7, 8 and 12 to 14 from our records of frames, with the paper's numbers of Table 5 beside them."""

import numpy

from . import sweep_figures
from .comparison_tables import PARTS
from .drawing import (
    COLOUR_OF,
    COLOURS,
    PALE,
    STAGES,
    WINNER,
    Plot,
    legend_above,
    log_axis,
    milliseconds,
    missing,
)
from .folder import SCENES, STEPS_OF_PAPER, STEPS_OF_TABLES, number, paper_table
from .methods import found, name_of
from .tables import written

MAX_COSTS = 6  # as in the paper
GPU = "K40c"  # of the paper's devices, the one whose launch geometry preset published has


def published(folder, algorithm):
    """The published cases of an algorithm, k = 8, by scene."""
    wanted = {"algorithm": algorithm, "preset": "published", "k": "8"}
    cases = {scene: found(folder, f"cells-{scene}", scene, wanted) for scene in SCENES}
    return {scene: case for scene, case in cases.items() if case}


def of_paper(algorithm):
    """({stage: seconds}, launches) of a step of the paper's Table 5 on GPU, by scene."""
    rows = [row for row in paper_table(5) if row["gpu"] == GPU and row["algorithm"] == algorithm]
    return {
        row["scene"]: (
            {stage: (number(row[f"{stage}_s"]) or 0) / STEPS_OF_TABLES for stage in PARTS},
            number(row["launches"]) / STEPS_OF_TABLES,
        )
        for row in rows
    }


def _figure7_rows(cases):
    """(label, {stage: seconds a frame}, launches a frame, records) of our cells and of the paper, scene by
    scene."""
    theirs, rows = of_paper("gproximity"), []
    for scene, case in cases.items():
        rows.append(
            (
                f"{scene}, ours",
                {stage: case.stage(stage) / case.frames for stage in STAGES},
                case.release_launches / case.frames,
                case.locations[0],
            )
        )
        if scene in theirs:
            rows.append((f"{scene}, paper's {GPU}", *theirs[scene], "results/paper/table5.csv"))
    return rows


def _draw_costs(ax, percents):
    """Draws the largest stages of each row in percent."""
    total = lambda stage: sum(percent[stage] for percent in percents)
    left = numpy.zeros(len(percents))
    for stage in sorted(STAGES, key=total, reverse=True)[:MAX_COSTS]:
        part = numpy.array([percent[stage] for percent in percents])
        ax.barh(range(len(percents)), part, left=left, color=COLOUR_OF[stage], label=stage, height=0.7)
        left += part
    ax.set_xlabel("percent of a frame's stages, the six largest")
    legend_above(ax, 6)


def figure7(folder):
    """The six largest costs of gProximity in percent, and its launches."""
    rows = _figure7_rows(published(folder, "gproximity"))
    if not rows:
        return missing(
            folder.path, 7, "gProximity's bottlenecks", "no cell of gProximity published has completed"
        )
    plot = Plot(7, 2, 3.2)
    costs_panel, launches = plot.axes
    percents = [
        {stage: 100 * seconds.get(stage, 0) / sum(seconds.values()) for stage in STAGES}
        for _, seconds, _, _ in rows
    ]
    _draw_costs(costs_panel, percents)
    launches.barh(
        range(len(rows)),
        [count for _, _, count, _ in rows],
        color=[PALE if "paper" in label else WINNER for label, *_ in rows],
        height=0.7,
    )
    launches.set(xscale="log", xlabel="launches a frame, as the release counts")
    log_axis(launches.xaxis)
    for ax in plot.axes:
        ax.set_yticks(range(len(rows)), [label for label, *_ in rows], fontsize=8)
        ax.invert_yaxis()
    for (label, seconds, count, records), percent in zip(rows, percents):
        plot.rows += [
            {
                "scene": label,
                "stage": stage,
                "ms_a_frame": 1e3 * seconds.get(stage, 0),
                "percent": percent[stage],
                "launches_a_frame": count,
                "records": records,
            }
            for stage in STAGES
        ]
    spans = {
        who: [percent["write"] for (label, *_), percent in zip(rows, percents) if who in label]
        for who in ("ours", "paper")
    }
    text = {who: f"{min(own):.0f} to {max(own):.0f} %" for who, own in spans.items() if own}
    title = f"gProximity as published, with a bounded queue array: write takes {text['ours']} of its stages"
    return plot.save(
        folder.path,
        title
        + (f", and {text['paper']} on the paper's {GPU} with its whole array" if "paper" in text else ""),
    )


def _draw_launches(plot, ax, case):
    """Draws launches a frame of each range of frames."""
    counts = sorted(
        (cell.first_frame, cell.last_frame, cell.of_stages("launches") / cell.frames) for cell in case.cells
    )
    ax.plot(
        [(first + last) / 2 for first, last, _ in counts],
        [count for *_, count in counts],
        "o-",
        markersize=3,
        color=WINNER,
    )
    plot.rows += [{"frame": first, "stage": "launches", "launches": count} for first, _, count in counts]
    ax.set(ylabel="launches a frame", xlabel="frame")
    ax.set_ylim(bottom=0)


def figure8(folder):
    """Stages of gProximity over frames of the funnel; dotted: the paper's means."""
    case = published(folder, "gproximity").get("funnel")
    if case is None:
        return missing(
            folder.path,
            8,
            "gProximity over frames",
            "no cell of gProximity published on funnel has completed",
        )
    plot = Plot(8, 2, 2.9)
    times, launches = plot.axes
    theirs, _ = of_paper("gproximity")["funnel"]
    tops = {}
    for stage in STAGES:
        rows = case.per_frame(stage, "device_ns" if case.stage(stage, "device_ns") else "host_ns")
        if not rows or max(value for _, value in rows) == 0:
            continue
        frames, values = zip(*rows)
        values = 1e3 * numpy.array(values)
        times.plot(frames, values, "o-", markersize=3, color=COLOUR_OF[stage], label=stage)
        if theirs.get(stage):
            times.axhline(1e3 * theirs[stage], color=COLOUR_OF[stage], linestyle=":", linewidth=1)
        tops[stage] = values.sum()
        plot.rows += [
            {
                "frame": frame,
                "stage": stage,
                "ms": value,
                "paper_ms": 1e3 * theirs[stage] if stage in theirs else None,
            }
            for frame, value in zip(frames, values)
        ]
    times.set_yscale("log")
    milliseconds(times)
    legend_above(times, 6)
    log_axis(times.yaxis)
    _draw_launches(plot, launches, case)
    largest = max(tops, key=tops.get)
    return plot.save(
        folder.path,
        f"gProximity as published, {case.scene}, bounded queue array: {largest} takes most, {100 * tops[largest] / sum(tops.values()):.0f} % of all stages "
        f"(dotted: means of the paper's {GPU}, whole array, steps 20 to 121)",
    )


def _launches(folder):
    """{method: {scene: (launches a frame, records)}}, k = 8: as the release counts, or all kernels of a
    method that it does not have."""
    rows = {}
    for scene in SCENES:
        for case in folder.cases(f"cells-{scene}") + folder.cases(f"resident-{scene}"):
            if case.settings.get("k") == "8":
                count = case.release_launches
                name = name_of(case) if count is not None else f"{name_of(case)}, all kernels"
                rows.setdefault(name, {})[scene] = (
                    (case.sum("launches") if count is None else count) / case.frames,
                    case.locations[0],
                )
    for algorithm in ("chunked", "gproximity") if rows else ():
        rows[f"paper's {GPU}, {algorithm}".replace("gp", "gP")] = {
            scene: (count, "results/paper/table5.csv") for scene, (_, count) in of_paper(algorithm).items()
        }
    return rows


def figure12(folder):
    simulations, methods = folder.simulations("sim-"), _launches(folder)
    if not simulations and not methods:
        return missing(folder.path, 12, "Launches", "nothing has completed")
    plot = Plot(12, 2, 3.1)
    curves, bars = plot.axes
    for colour, run in zip(COLOURS, [run.first(STEPS_OF_PAPER) for run in simulations]):
        launches = [sum(stage["launches"] for stage in step["stages"].values()) for step in run.steps]
        curves.plot(
            [step["step"] for step in run.steps],
            launches,
            color=colour,
            label=f"{run.label}, {run.run['algorithm']} {run.run['preset']}",
        )
        plot.rows += [
            {"scene": run.label, "method": run.method, "step": step["step"], "launches": n}
            for step, n in zip(run.steps, launches)
        ]
    curves.set(xlabel="step", ylabel="launches, all kernels")
    curves.set_ylim(bottom=0)
    legend_above(curves, 2)
    width = 0.8 / max(len(methods), 1)
    for i, (method, counts) in enumerate(methods.items()):
        bars.bar(
            [SCENES.index(scene) + width * (i - (len(methods) - 1) / 2) for scene in counts],
            [count for count, _ in counts.values()],
            width=0.9 * width,
            color=COLOURS[i % len(COLOURS)],
            label=method,
        )
        plot.rows += [
            {"scene": scene, "method": method, "launches": count, "records": location}
            for scene, (count, location) in counts.items()
        ]
    bars.set_xticks(range(len(SCENES)), SCENES)
    bars.set(ylabel="launches a frame", yscale="log")
    log_axis(bars.yaxis)
    legend_above(bars, 3)
    largest = max(
        (
            (count, method, scene)
            for method, counts in methods.items()
            if "paper's " + GPU not in method
            for scene, (count, _) in counts.items()
        ),
        default=None,
    )
    more = (
        f"; the most are {written(float(round(largest[0])))} of {largest[1]} on {largest[2]}"
        if largest
        else ""
    )
    return plot.save(
        folder.path, f"Launches of each step of our simulations, and of each method with k = 8{more}"
    )


def all_of_frames(folder):
    return {
        int(make.__name__[6:]): make(folder)
        for make in (figure7, figure8, figure12, sweep_figures.figure13, sweep_figures.figure14)
    }
