# SPDX-License-Identifier: MIT
"""Figures 7, 8 and 12 to 14 from our records of frames, with the paper's numbers of Table 5 beside them."""

import statistics

import numpy

from . import sweep_figures
from .comparison_tables import PARTS
from .drawing import (
    COLOUR_OF,
    COLOURS,
    MARKERS,
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
from .quantities import batches_of
from .tables import simulations

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


def _batches(case):
    """Batches of each frame of gProximity; empty if unknown."""
    found = {
        frame: batches_of(cell, (frame, frame))
        for cell in case.cells
        for frame in range(cell.first_frame, cell.last_frame + 1)
    }
    return found if all(found.values()) else {}


def _upload_of_array(folder, cases):
    """(seconds of the upload of the whole queue array that the release allocates on this device, its records), to add
    to each batch of the cases; None if the upload or the batches are unknown."""
    cells = [
        case
        for step in ("array", "array-again")
        for case in folder.cases(step)
        if case.settings.get("queue_bytes") == "device"
    ]
    if not cells or not all(map(_batches, [*cases, *cells])):
        return None
    seconds = statistics.median(case.stage("write") / case.batches for case in cells)
    return seconds, cells[0].locations[0]


def _array_text(upload):
    return "its whole queue array, composed" if upload else "a bounded queue array"


def _own_row(scene, case, upload):
    """A row of _figure7_rows() of ours: with the upload of the whole array for each batch, if it is known."""
    seconds = {stage: case.stage(stage) / case.frames for stage in STAGES}
    records = case.locations[0]
    if upload:
        seconds["write"] += upload[0] * sum(_batches(case).values()) / case.frames
        records += f" {upload[1]}"
    return f"{scene}, ours", seconds, case.release_launches / case.frames, records


def _figure7_rows(cases, upload):
    """(label, {stage: seconds per frame}, launches per frame, records) of our cells and of the paper, scene by
    scene."""
    theirs, rows = of_paper("gproximity"), []
    for scene, case in cases.items():
        rows.append(_own_row(scene, case, upload))
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


def _bounded(cases):
    """The sizes of the queue arrays of our cells in words."""
    sizes = dict.fromkeys(case.settings.get("queue_bytes", "") for case in cases)
    return ", ".join(f"{int(size) / 2**20:g} MiB" if size.isdigit() else size for size in sizes)


def figure7(folder):
    """The six largest costs of gProximity in percent, and its launches."""
    cases = published(folder, "gproximity")
    upload = _upload_of_array(folder, cases.values())
    rows = _figure7_rows(cases, upload)
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
    launches.set(xscale="log", xlabel=f"launches per frame; ours with an array of {_bounded(cases.values())}")
    log_axis(launches.xaxis)
    for ax in plot.axes:
        ax.set_yticks(range(len(rows)), [label for label, *_ in rows], fontsize=8)
        ax.invert_yaxis()
    for (label, seconds, count, records), percent in zip(rows, percents):
        plot.rows += [
            {
                "scene": label,
                "stage": stage,
                "ms_per_frame": 1e3 * seconds.get(stage, 0),
                "percent": percent[stage],
                "launches_per_frame": count,
                "records": records,
            }
            for stage in STAGES
        ]
    spans = {
        who: [percent["write"] for (label, *_), percent in zip(rows, percents) if who in label]
        for who in ("ours", "paper")
    }
    text = {who: f"{min(own):.0f} to {max(own):.0f} %" for who, own in spans.items() if own}
    title = f"gProximity as published, with {_array_text(upload)}: write takes {text['ours']} of its stages"
    more = f", and {text['paper']} on the paper's {GPU}" if "paper" in text else ""
    return plot.save(folder.path, title + more)


def _draw_launches(plot, ax, case):
    """Draws launches per frame of each range of frames."""
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
    ax.set(ylabel="launches per frame", xlabel=f"frame; with an array of {_bounded([case])}")
    ax.set_ylim(bottom=0)


def _stage_by_frame(case, stage, upload):
    """(frames, milliseconds) of a stage; write with the upload of the whole array for each batch, if it is known."""
    rows = case.per_frame(stage, "device_ns" if case.stage(stage, "device_ns") else "host_ns")
    frames, values = [frame for frame, _ in rows], numpy.array([1e3 * seconds for _, seconds in rows])
    if upload and stage == "write":
        batches = _batches(case)
        values += [1e3 * upload[0] * batches[frame] for frame in frames]
    return frames, values


def _draw_means(ax, means):
    """Marks the paper's means at the right of the axes, each with its name beside it, which keeps its distance from
    the others."""
    low, high = ax.get_ylim()
    gap, least = (high / low) ** 0.06, low
    for stage, ms in sorted(means.items(), key=lambda item: item[1]):
        style = {"color": COLOUR_OF[stage], "markersize": 5, "fillstyle": "none", "clip_on": False}
        ax.plot(1.02, ms, MARKERS[stage], transform=ax.get_yaxis_transform(), **style)
        least = max(ms, least * gap)
        line = {"arrowstyle": "-", "color": COLOUR_OF[stage], "linewidth": 0.8, "shrinkA": 1, "shrinkB": 3}
        where = {"xycoords": ax.get_yaxis_transform(), "textcoords": ax.get_yaxis_transform(), "va": "center"}
        ax.annotate(
            stage, (1.02, ms), (1.06, least), arrowprops=line, annotation_clip=False, fontsize=8, **where
        )


def figure8(folder):
    """Stages of gProximity over frames of the funnel; hollow marks: the paper's means."""
    case = published(folder, "gproximity").get("funnel")
    if case is None:
        return missing(
            folder.path,
            8,
            "gProximity over frames",
            "no cell of gProximity published on funnel has completed",
        )
    plot, upload = Plot(8, 2, 2.9), _upload_of_array(folder, [case])
    times, launches = plot.axes
    means = {stage: 1e3 * seconds for stage, seconds in of_paper("gproximity")["funnel"][0].items()}
    sums = {}
    for stage in STAGES:
        frames, values = _stage_by_frame(case, stage, upload)
        if not frames or max(values) == 0:
            continue
        times.plot(
            frames,
            values,
            MARKERS[stage] + "-",
            markersize=5,
            color=COLOUR_OF[stage],
            label=stage,
            linewidth=1,
        )
        sums[stage] = values.sum()
        plot.rows += [
            {"frame": frame, "stage": stage, "ms": value, "paper_ms": means.get(stage)}
            for frame, value in zip(frames, values)
        ]
    times.set_yscale("log")
    milliseconds(times)
    legend_above(times, 6)
    log_axis(times.yaxis)
    _draw_means(times, {stage: ms for stage, ms in means.items() if ms and stage in sums})
    _draw_launches(plot, launches, case)
    largest = max(sums, key=sums.get)
    return plot.save(
        folder.path,
        f"gProximity as published, {case.scene}, with {_array_text(upload)}: {largest} takes {100 * sums[largest] / sum(sums.values()):.0f} % of all stages "
        f"(hollow marks at the right: means of the paper's {GPU}, steps 20 to 121)",
    )


def _launches(folder):
    """{method: {scene: (launches per frame, records)}}, k = 8: as the release counts, or all kernels of a
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
    runs, methods = simulations(folder), _launches(folder)
    if not runs and not methods:
        return missing(folder.path, 12, "Launches", "nothing has completed")
    plot = Plot(12, 2, 3.1)
    curves, bars = plot.axes
    for colour, run in zip(COLOURS, [run.first(STEPS_OF_PAPER) for run in runs]):
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
    bars.set(ylabel="launches per frame", yscale="log")
    log_axis(bars.yaxis)
    legend_above(bars, 3)
    return plot.save(folder.path, "Launches of each step of our simulations, and of each method with k = 8")


def all_of_frames(folder):
    return {
        int(make.__name__[6:]): make(folder)
        for make in (figure7, figure8, figure12, sweep_figures.figure13, sweep_figures.figure14)
    }
