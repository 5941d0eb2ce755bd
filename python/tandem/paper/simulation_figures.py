# SPDX-License-Identifier: MIT
"""Figures 9 to 11 from our simulations, with the paper's numbers of Tables 1, 3 and 7 beside them."""

import numpy

from .drawing import (
    COLOUR_OF,
    COLOURS,
    INK,
    PALE,
    STAGES,
    Plot,
    legend_above,
    log_axis,
    milliseconds,
    missing,
    symlog_axis,
)
from .figures import GPU, MAX_COSTS
from .folder import SCENES, STEPS_OF_PAPER, number, paper_table
from .measures import MIN_RANGE
from .tables import simulations


def fit(x, y):
    """Exponent, factor and R^2 of y = a x^b by least squares of logarithms; None for few points or a small
    range of contacts."""
    x, y = numpy.array(x, float), numpy.array(y, float)
    good = (x > 0) & (y > 0)
    if good.sum() < 10 or numpy.quantile(x[good], 0.95) < MIN_RANGE * numpy.quantile(x[good], 0.05):
        return None
    lx, ly = numpy.log(x[good]), numpy.log(y[good])
    slope, offset = numpy.polyfit(lx, ly, 1)
    spread = ((ly - ly.mean()) ** 2).sum()
    return (
        slope,
        numpy.exp(offset),
        1 - ((ly - slope * lx - offset) ** 2).sum() / spread if spread > 0 else 1.0,
    )


def device_seconds(simulation):
    """Seconds of traverse and contact by step."""
    return [t + c for t, c in zip(simulation.curve("stage:traverse"), simulation.curve("stage:contact"))]


def _curves_of_9(ax, run, colour, median):
    """Contacts kept over steps; dashed: the paper's median."""
    ax.plot([step["step"] for step in run.steps], run.curve("contacts_kept"), color=colour, label=run.scene)
    if median:
        ax.axhline(1e3 * median, color=colour, linestyle="--", linewidth=1)


def _scaling_of_9(ax, run, colour):
    found, times = run.curve("contacts_found"), device_seconds(run)
    ax.plot(found, 1e3 * numpy.array(times), ".", color=colour, markersize=3, alpha=0.6)
    fitted = fit(found, times)
    if fitted:
        x = numpy.geomspace(max(min(n for n in found if n > 0), 1), max(found), 30)
        ax.plot(
            x,
            1e3 * fitted[1] * x ** fitted[0],
            color=colour,
            linewidth=1,
            label=f"{run.scene}: contacts^{fitted[0]:.2f}, R² {fitted[2]:.2f}",
        )
    return fitted


def _measured(folder, runs):
    """The runs; in place of one that can be composed, its composition, whose stages are those of the device."""
    composed = {run.scene: run for run in folder.compositions()}
    return [composed.get(run.scene, run) for run in runs]


def figure9(folder):
    runs = [run for run in simulations(folder) if run.scene in SCENES]
    if not runs:
        return missing(folder.path, 9, "Contacts over steps", "no simulation has completed")
    plot = Plot(9, 2, 3.1)
    curves, scaling = plot.axes
    medians = {row["scene"]: number(row["median_contacts_a_step_thousand"]) for row in paper_table(1)}
    exponents = {}
    for colour, run, measured in zip(COLOURS, runs, _measured(folder, runs)):
        _curves_of_9(curves, run, colour, medians.get(run.scene))
        exponents[run.scene] = _scaling_of_9(scaling, measured, colour)
        run = measured
        columns = zip(
            run.steps,
            run.curve("contacts_found"),
            run.curve("contacts_kept"),
            device_seconds(run),
            run.curve("stage:refit"),
        )
        plot.rows += [
            {
                "scene": run.scene,
                "step": step["step"],
                "contacts": found,
                "contacts_kept": kept,
                "traverse_and_contact_ms": 1e3 * t,
                "refit_ms": 1e3 * refit,
            }
            for step, found, kept, t, refit in columns
        ]
    symlog_axis(curves, 100)
    curves.set(xlabel="step", ylabel="contacts kept", xlim=(0, STEPS_OF_PAPER))
    legend_above(curves, 4)
    scaling.set(xscale="log", yscale="log", xlabel="contacts found in a step")
    milliseconds(scaling)
    scaling.set_ylabel("traverse and contact, ms")
    log_axis(scaling.xaxis)
    log_axis(scaling.yaxis)
    if any(exponents.values()):
        legend_above(scaling, 2)
    fits = ", ".join(f"{scene} {values[0]:.2f}" for scene, values in exponents.items() if values)
    text = f"fitted exponents: {fits}" if fits else "they change too little for a fit"
    return plot.save(
        folder.path,
        f"Contacts kept in our steps (dashed: the paper's medians), and device time over contacts found ({text})",
    )


def _bars_of_10(run):
    """(label, {stage: seconds}, records): all steps of the run, or of the paper if the run is composed, and the paper's
    devices with the numbers of its Tables 6 and 7."""
    scale = STEPS_OF_PAPER / len(run.steps) if run.is_composed else 1
    own = {stage: scale * run.stage(stage) for stage in STAGES}
    rows = [(f"ours, {run.run['devices'][0]['name']}", own, run.location)]
    transfers = {row["gpu"]: row for row in paper_table(6) if row["scene"] == run.scene}
    for kernels in [row for row in paper_table(7) if row["scene"] == run.scene]:
        columns = kernels | transfers[kernels["gpu"]]
        seconds = {stage: 60 * (number(columns.get(f"{stage}_min")) or 0) for stage in STAGES}
        rows.append(
            (f"paper's {kernels['gpu']}", seconds, "results/paper/table6.csv results/paper/table7.csv")
        )
    return rows


def _largest_costs(bars):
    """The stages with the largest shares of all bars."""
    share = lambda stage: sum(
        seconds[stage] / (sum(seconds.values()) or 1) for rows in bars for _, seconds, _ in rows
    )
    return sorted(STAGES, key=share, reverse=True)[:MAX_COSTS]


def _draw_costs(ax, rows, largest):
    """Bars of the largest costs and of the sum of all others."""
    left = numpy.zeros(len(rows))
    parts = [(stage, [stage], COLOUR_OF[stage]) for stage in largest]
    parts.append(("others", [stage for stage in STAGES if stage not in largest], PALE))
    for name, stages, colour in parts:
        values = numpy.array([sum(seconds[stage] for stage in stages) for _, seconds, _ in rows])
        ax.barh(range(len(rows)), values, left=left, color=colour, height=0.7, label=name)
        left += values
    ax.set_yticks(range(len(rows)), [label for label, *_ in rows], fontsize=8)
    ax.set_ylim(max(len(rows), 2) - 0.5, -0.5)


def figure10(folder):
    """The largest costs of collision detection in seconds, a panel for each scene."""
    runs = _measured(folder, [run for run in simulations(folder) if run.scene in SCENES])
    if not runs:
        return missing(folder.path, 10, "What simulations cost", "no simulation has completed")
    bars = [_bars_of_10(run) for run in runs]
    largest = _largest_costs(bars)
    plot = Plot(10, len(bars), heights=[0.8 + 0.2 * len(rows) for rows in bars])
    for ax, run, rows in zip(plot.axes, runs, bars):
        _draw_costs(ax, rows, largest)
        steps = f"{len(run.steps)} of {STEPS_OF_PAPER}" if run.is_composed else len(run.steps)
        ax.set_title(f"{run.scene}, ours from {steps} steps", fontsize=9, loc="right", color=INK)
        plot.rows += [
            {"scene": run.scene, "run": label, "cost": stage, "seconds": seconds[stage], "records": records}
            for label, seconds, records in rows
            for stage in STAGES
        ]
    plot.axes[len(bars) - 1].set_xlabel("seconds")
    legend_above(plot.axes[0], 4)
    return plot.save(
        folder.path,
        "The six largest costs of collision detection in simulations, without the solver (the paper's tables lack preprocess and postprocess)",
    )


def figure11(folder):
    runs = _measured(folder, [run for run in simulations(folder) if run.scene in ("funnel", "glasses")])
    runs.sort(key=lambda run: run.scene)
    if not runs:
        return missing(
            folder.path, 11, "Stages over steps", "no simulation of funnel or glasses has completed"
        )
    plot = Plot(11, len(runs), 2.8)
    theirs = {row["scene"]: row for row in paper_table(7) if row["gpu"] == GPU}
    growth = []
    for ax, run in zip(plot.axes, runs):
        curves = {stage: numpy.array(run.curve(f"stage:{stage}")) for stage in STAGES} | {
            "solve": numpy.array(run.curve("host:solve"))
        }
        largest = sorted(curves, key=lambda name: curves[name].sum(), reverse=True)[:MAX_COSTS]
        for name in largest:
            ax.plot(
                [step["step"] for step in run.steps],
                1e3 * curves[name],
                color=COLOUR_OF[name],
                label=name,
                linewidth=1.2,
            )
        for name in [name for name in ("refit", "traverse", "contact") if name in largest]:
            ax.axhline(
                6e4 * number(theirs[run.scene][f"{name}_min"]) / STEPS_OF_PAPER,
                color=COLOUR_OF[name],
                linestyle=":",
                linewidth=1,
            )
        plot.rows += [
            {
                "run": f"{run.scene} {run.run['devices'][0]['id']}",
                "step": step["step"],
                **{name: 1e3 * values[i] for name, values in curves.items()},
            }
            for i, step in enumerate(run.steps)
        ]
        ax.set_title(f"{run.scene}, {run.run['devices'][0]['name']}", fontsize=9, loc="right", color=INK)
        symlog_axis(ax, 0.1)
        milliseconds(ax)
        legend_above(ax, 3)
        growth.append(f"{largest[0]} for {run.scene} on {run.run['devices'][0]['id']}")
    plot.axes[len(runs) - 1].set_xlabel("step")
    return plot.save(
        folder.path,
        f"Stages of our steps (dotted: means of the paper's {GPU} over 500 steps); the largest: {', '.join(growth)}",
    )


def all_of_simulations(folder):
    return {int(make.__name__[6:]): make(folder) for make in (figure9, figure10, figure11)}
