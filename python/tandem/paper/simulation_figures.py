# SPDX-License-Identifier: MIT
"""Figures 9 to 11 from our simulations, with the paper's numbers of Tables 1, 3 and 7 beside them."""

import numpy

from .drawing import (
    COLOUR_OF,
    COLOURS,
    INK,
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
from .simulation_tables import common_runs, data_path, percentages
from .tables import written

PARTS = {
    "solver": "solve",
    "initialization": "refit",
    "broad": "broad",
    "narrow": "traverse",
    "contact_reduction": "reduce",
}  # of Table 3, and their colours


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
    runs = [run for run in folder.simulations("sim-") if run.scene in SCENES]
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
    text = (
        f"device time grows with contacts, exponents {fits}"
        if fits
        else "they change too little to fit device time to them"
    )
    return plot.save(folder.path, f"Contacts of our steps (dashed: the paper's medians of 500 steps): {text}")


def _bars_of_10(runs):
    """(label, {part: percent}, milliseconds a step, records): our runs and the paper's device, scene by scene."""
    rows = []
    for scene in SCENES:
        for run in [run for run in runs if run.scene == scene]:
            path = data_path(run).replace(", conversion", "") + (", composed" if run.is_composed else "")
            parts = {name.removesuffix("_percent"): value for name, value in percentages(run).items()}
            rows.append(
                (
                    f"{scene}, {run.run['devices'][0]['id']}, {path}, {len(run.steps)} steps",
                    parts,
                    1e3 * run.host("step") / len(run.steps),
                    run.location,
                )
            )
        for row in [row for row in paper_table(3) if row["gpu"] == GPU and row["scene"] == scene]:
            parts = {part: number(row[f"{part}_percent"]) or 0 for part in PARTS}
            rows.append(
                (
                    f"{scene}, paper's {GPU}, {STEPS_OF_PAPER} steps",
                    parts,
                    6e4 * number(row["total_min"]) / STEPS_OF_PAPER,
                    "results/paper/table3.csv",
                )
            )
    return rows


def figure10(folder):
    runs = common_runs(folder) + folder.compositions()
    if not runs:
        return missing(folder.path, 10, "What simulations cost", "no simulation has completed")
    rows = _bars_of_10(runs)
    plot = Plot(10, 1, 1.4 + 0.3 * len(rows))
    ax = plot.axes[0]
    left = numpy.zeros(len(rows))
    for part, colour in PARTS.items():
        values = numpy.array([parts[part] for _, parts, *_ in rows])
        ax.barh(
            range(len(rows)),
            values,
            left=left,
            color=COLOUR_OF[colour],
            height=0.7,
            label=part.replace("_", " "),
        )
        left += values
    for row, (label, parts, step_ms, records) in enumerate(rows):
        ax.annotate(f" {written(float(f'{step_ms:.3g}'))} ms", (100, row), va="center", fontsize=8)
        plot.rows += [
            {"run": label, "part": part, "percent": value, "ms_a_step": step_ms, "records": records}
            for part, value in parts.items()
        ]
    ax.set_yticks(range(len(rows)), [label for label, *_ in rows], fontsize=8)
    ax.set(xlabel="percent; at the right, ms a step", xlim=(0, 125))
    ax.set_xticks(range(0, 101, 20))
    ax.invert_yaxis()
    legend_above(ax, 2)
    solver = {
        who: [parts["solver"] for label, parts, *_ in rows if ("paper's" in label) == (who == "paper")]
        for who in ("ours", "paper")
    }
    text = {who: f"{min(values):.0f} to {max(values):.0f} %" for who, values in solver.items() if values}
    return plot.save(
        folder.path,
        f"Parts of a simulated step: the solver takes {text['ours']} of ours"
        + (f", and {text['paper']} of the paper's" if "paper" in text else ""),
    )


def figure11(folder):
    runs = [
        run
        for run in _measured(folder, common_runs(folder, ("sim-", "host-")))
        if run.scene in ("funnel", "glasses")
    ]
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
