# SPDX-License-Identifier: MIT
"""Figures 7 to 13 of the paper, and one more, from our records."""
import numpy

from .drawing import COLOUR_OF, COLOURS, INK, PALE, STAGES, WINNER, Plot, milliseconds, missing
from .folder import SCENES
from .tables import data_path, pick

MAX_COSTS = 6  # in Figures 7 and 10, as in the paper


def published_gproximity(folder):
    cases = [pick(folder.cases(f"cells-{scene}"), "gproximity", "published") for scene in SCENES]
    return [case for case in cases if case]


def figure7(folder):
    """The six largest costs of gProximity in percent, and its launches."""
    cases = published_gproximity(folder)
    if not cases:
        return missing(folder.path, 7, "gProximity's bottlenecks", "no cell of gProximity published has completed")
    plot = Plot(7, 2, 2.6)
    sums = {stage: sum(case.stage(stage) / case.total() for case in cases) for stage in STAGES}
    costs = sorted(sums, key=sums.get, reverse=True)[:MAX_COSTS]
    costs_panel, launches = plot.axes
    left = numpy.zeros(len(cases))
    for stage in costs:
        part = numpy.array([100 * case.stage(stage) / sum(case.stage(name) for name in STAGES) for case in cases])
        costs_panel.barh(range(len(cases)), part, left=left, color=COLOUR_OF[stage], label=stage, height=0.65)
        left += part
    costs_panel.set_yticks(range(len(cases)), [case.scene for case in cases])
    costs_panel.set_xlabel("percent of a frame's stages")
    costs_panel.invert_yaxis()
    costs_panel.legend(ncols=6, loc="lower left", bbox_to_anchor=(0, 1), fontsize=8, handlelength=1)
    for row, case in enumerate(cases):
        counts = {stage: case.stage(stage, "launches") / case.frames for stage in ("refit", "traverse", "balance", "contact")}
        start = 0
        for stage, count in counts.items():
            launches.barh(row, count, left=start, color=COLOUR_OF[stage], height=0.65)
            start += count
        launches.annotate(f" {start:.0f}", (start, row), va="center", fontsize=8)
        plot.rows += [{"scene": case.scene, "stage": stage, "ms_a_frame": 1e3 * case.stage(stage) / case.frames, "launches_a_frame": counts.get(stage),
                       "records": case.locations[0]} for stage in STAGES]
    launches.set_yticks(range(len(cases)), [case.scene for case in cases])
    launches.set_xlabel("launches a frame")
    launches.invert_yaxis()
    worst = max(cases, key=lambda case: case.stage("write") / case.total())
    first = max(STAGES, key=lambda stage: sums[stage])
    return plot.save(folder.path, f"gProximity as published: {first} is its largest cost, and write is {100 * worst.stage('write') / worst.total():.0f} % of {worst.scene}")


def figure8(folder):
    """Stages of gProximity over frames of one scene."""
    case = next((case for case in published_gproximity(folder) if case.scene == "funnel"), None)
    if case is None:
        return missing(folder.path, 8, "gProximity over frames", "no cell of gProximity published on funnel has completed")
    plot = Plot(8, 2, 2.6)
    times, launches = plot.axes
    tops = {}
    for stage in STAGES:
        where = "device_ns" if case.stage(stage, "device_ns") else "host_ns"
        rows = case.per_frame(stage, where)
        if not rows or max(value for _, value in rows) == 0:
            continue
        frames, values = zip(*rows)
        values = 1e3 * numpy.array(values)
        times.plot(frames, values, "o-", markersize=3, color=COLOUR_OF[stage], label=stage)
        tops[stage] = values.sum()
        plot.rows += [{"frame": frame, "stage": stage, "ms": value} for frame, value in zip(frames, values)]
    times.set_yscale("log")
    milliseconds(times)
    times.legend(ncols=5, fontsize=7, loc="lower left", bbox_to_anchor=(0, 1))
    counts = sorted((r["frames"]["first"], sum(s["launches"] for s in r["stages"].values()) / (r["frames"]["last"] - r["frames"]["first"] + 1), r) for r in case.records)
    for first, count, record in counts:
        launches.plot([first, record["frames"]["last"]], [count, count], "o-", markersize=3, color=WINNER)
        plot.rows.append({"frame": first, "stage": "launches", "launches": count})
    launches.set_ylabel("launches a frame")
    launches.set_ylim(bottom=0)
    launches.set_xlabel("frame")
    largest = max(tops, key=tops.get)
    return plot.save(folder.path, f"gProximity as published, {case.scene}, over frames: {largest} costs most, {tops[largest] / sum(tops.values()):.0%} of all stages")


MIN_RANGE = 4  # smallest ratio of the most to the fewest contacts for which an exponent is meaningful


def fit(x, y):
    """Exponent, factor and R^2 of y = a x^b by least squares of logarithms; None for few points or a small range of contacts."""
    x, y = numpy.array(x, float), numpy.array(y, float)
    good = (x > 0) & (y > 0)
    if good.sum() < 10 or numpy.quantile(x[good], 0.95) < MIN_RANGE * numpy.quantile(x[good], 0.05):
        return None
    lx, ly = numpy.log(x[good]), numpy.log(y[good])
    slope, offset = numpy.polyfit(lx, ly, 1)
    spread = ((ly - ly.mean()) ** 2).sum()
    return slope, numpy.exp(offset), 1 - ((ly - slope * lx - offset) ** 2).sum() / spread if spread > 0 else 1.0


def device_seconds(simulation):
    """Seconds of traverse and contact by step."""
    return [t + c for t, c in zip(simulation.curve("stage:traverse"), simulation.curve("stage:contact"))]


def figure9(folder):
    simulations = folder.simulations("sim-")
    if not simulations:
        return missing(folder.path, 9, "Contacts over steps", "no simulation has completed")
    plot = Plot(9, 2, 2.9)
    curves, scaling = plot.axes
    exponents = {}
    for colour, simulation in zip(COLOURS, simulations):
        found, times = simulation.curve("contacts_found"), device_seconds(simulation)
        steps = [step["step"] for step in simulation.steps]
        curves.plot(steps, found, color=colour, label=simulation.scene)
        scaling.plot(found, 1e3 * numpy.array(times), ".", color=colour, markersize=3, alpha=0.6)
        fitted = fit(found, times)
        if fitted:
            exponents[simulation.scene] = fitted
            x = numpy.geomspace(max(min(n for n in found if n > 0), 1), max(found), 30)
            scaling.plot(x, 1e3 * fitted[1] * x**fitted[0], color=colour, linewidth=1, label=f"{simulation.scene}: contacts^{fitted[0]:.2f}, R² {fitted[2]:.2f}")
        plot.rows += [{"scene": simulation.scene, "step": step, "contacts": n, "traverse_and_contact_ms": 1e3 * t,
                       "refit_ms": 1e3 * refit} for step, n, t, refit in zip(steps, found, times, simulation.curve("stage:refit"))]
    curves.set_yscale("symlog", linthresh=100)
    curves.set_xlabel("step")
    curves.set_ylabel("contacts found")
    curves.legend(fontsize=8, ncols=2)
    scaling.set(xscale="log", yscale="log", xlabel="contacts found in a step")
    milliseconds(scaling)
    scaling.set_ylabel("traverse and contact, ms")
    scaling.legend(fontsize=8)
    fits = ", ".join(f"{scene} {values[0]:.2f}" for scene, values in exponents.items())
    return plot.save(folder.path, f"Time of traversal and contacts over a step's contacts: exponents {fits}" if fits else "Contacts of a step, and the time of traversal and contacts: they change too little for a fit")


def costs_of(simulation):
    """Seconds by part: the stages of contact finding, and the other parts of a step."""
    parts = {stage: simulation.stage(stage) for stage in STAGES}
    return parts | {name: simulation.host(name) for name in ("reduce", "assemble", "solve", "move")}


def figure10(folder):
    runs = [run for beginning in ("sim-", "host-", "serial-", "parallel-") for run in folder.simulations(beginning)]
    runs = sorted(runs, key=lambda run: SCENES.index(run.scene))
    if not runs:
        return missing(folder.path, 10, "What simulations cost", "no simulation has completed")
    plot = Plot(10, 1, 1.2 + 0.33 * len(runs))
    ax = plot.axes[0]
    parts = [{name: value / len(run.steps) for name, value in costs_of(run).items()} for run in runs]
    names = [f"{run.scene}, {run.run['devices'][0]['id']}, {data_path(run)}" for run in runs]
    shown = set()
    for row, costs in enumerate(parts):
        left = 0
        for name in sorted(costs, key=costs.get, reverse=True)[:MAX_COSTS]:
            ax.barh(row, 1e3 * costs[name], left=left, color=COLOUR_OF[name], height=0.7, label=None if name in shown else name)
            shown.add(name)
            left += 1e3 * costs[name]
        plot.rows += [{"run": names[row], "cost": name, "ms_a_step": 1e3 * value, "records": runs[row].location} for name, value in costs.items()]
    ax.set_yticks(range(len(runs)), names, fontsize=8)
    ax.invert_yaxis()
    ax.set_xlabel("milliseconds a step, the six largest costs of each")
    ax.legend(ncols=4, fontsize=8, loc="upper left", bbox_to_anchor=(0, -0.18))
    first = max(parts[0], key=parts[0].get)
    return plot.save(folder.path, f"What a step of a simulation costs: {first} is the largest part of {names[0]}")


def figure11(folder):
    pairs = [(folder.simulation(f"sim-{scene}"), folder.simulation(f"host-{scene}")) for scene in ("funnel", "glasses")]
    runs = [run for pair in pairs for run in pair if run]
    if not runs:
        return missing(folder.path, 11, "Stages over steps", "no simulation of funnel or glasses has completed")
    plot = Plot(11, len(runs), 2.5)
    growth = []
    for ax, run in zip(plot.axes, runs):
        steps = [step["step"] for step in run.steps]
        curves = {stage: numpy.array(run.curve(f"stage:{stage}")) for stage in STAGES} | {"solve": numpy.array(run.curve("host:solve"))}
        largest = sorted(curves, key=lambda name: curves[name].sum(), reverse=True)[:MAX_COSTS]
        for name in largest:
            ax.plot(steps, 1e3 * curves[name], color=COLOUR_OF[name], label=name, linewidth=1.2)
        plot.rows += [{"run": f"{run.scene} {run.run['devices'][0]['id']}", "step": step, **{name: 1e3 * values[i] for name, values in curves.items()}}
                      for i, step in enumerate(steps)]
        ax.set_title(f"{run.scene}, {run.run['devices'][0]['name']}", fontsize=9, loc="left", color=INK)
        ax.set_yscale("symlog", linthresh=0.1)
        milliseconds(ax)
        ax.legend(ncols=3, fontsize=7)
        growth.append(f"{largest[0]} for {run.scene} on {run.run['devices'][0]['id']}")
    plot.axes[len(runs) - 1].set_xlabel("step")
    return plot.save(folder.path, f"Stages over steps; the largest: {', '.join(growth)}")


def figure12(folder):
    simulations = folder.simulations("sim-")
    cases = [case for scene in SCENES for case in folder.cases(f"cells-{scene}") if case.settings.get("k") == "8" and case.release_launches is not None]
    if not simulations and not cases:
        return missing(folder.path, 12, "Launches", "nothing has completed")
    plot = Plot(12, 2, 2.8)
    curves, bars = plot.axes
    for colour, simulation in zip(COLOURS, simulations):
        launches = [sum(stage["launches"] for stage in step["stages"].values()) for step in simulation.steps]
        steps = [step["step"] for step in simulation.steps]
        curves.plot(steps, launches, color=colour, label=f"{simulation.scene}, chunked grouped")
        plot.rows += [{"scene": simulation.scene, "method": "chunked grouped", "step": step, "launches": n} for step, n in zip(steps, launches)]
    curves.set(xlabel="step", ylabel="launches")
    curves.set_ylim(bottom=0)
    curves.legend(fontsize=8, ncols=2, loc="lower left", bbox_to_anchor=(0, 1))
    methods = list(dict.fromkeys(case.name for case in cases))
    scenes = [scene for scene in SCENES if any(case.scene == scene for case in cases)]
    for i, method in enumerate(methods):
        own = [(scenes.index(case.scene), case.release_launches / case.frames, case) for case in cases if case.name == method]
        bars.bar([x + 0.2 * (i - 1.5) for x, _, _ in own], [y for _, y, _ in own], width=0.18, color=COLOURS[i % len(COLOURS)], label=method)
        plot.rows += [{"scene": case.scene, "method": method, "launches": y, "counted": "as theirs", "records": case.locations[0]} for _, y, case in own]
    bars.set_xticks(range(len(scenes)), scenes)
    bars.set_ylabel("launches a frame, as theirs")
    bars.set_yscale("log")
    bars.legend(fontsize=8, ncols=2, loc="lower left", bbox_to_anchor=(0, 1))
    largest = max(cases, key=lambda case: case.release_launches / case.frames) if cases else None
    more = f"; {largest.name} takes up to {largest.release_launches / largest.frames:.0f}, on {largest.scene}" if largest else ""
    return plot.save(folder.path, f"Launches: chunked takes a few a step, however many contacts there are{more}")


def figure13(folder):
    cases = folder.cases("thresholds")
    if not cases:
        return missing(folder.path, 13, "Seed thresholds", "no cell of the sweep has completed")
    plot = Plot(13, 2, 2.5)
    minima = []
    for ax, preset in zip(plot.axes, ("published", "grouped")):
        own = sorted((int(case.settings["seed_threshold"]), case) for case in cases if case.preset == preset)
        x = [value for value, _ in own]
        for name, colour in (("traverse", COLOUR_OF["traverse"]), ("seed", "#777777"), ("write", COLOUR_OF["write"])):
            ax.plot(x, [1e3 * case.stage(name) / case.frames for _, case in own], "o-", color=colour, markersize=4, label=name)
        totals = numpy.array([case.total() for _, case in own]) * 1e3
        frames = numpy.array([case.frames for _, case in own])
        low, high = (numpy.array([case.total(which) for _, case in own]) * 1e3 for which in ("low", "high"))
        ax.plot(x, totals / frames, "o-", color=INK, markersize=4, label="whole frame")
        ax.fill_between(x, low / frames, high / frames, color=INK, alpha=0.15, linewidth=0)
        ax.set(xscale="log", yscale="log", xlabel="seed threshold")
        ax.set_title(f"chunked {preset}", fontsize=9, loc="left", color=INK)
        milliseconds(ax)
        ax.legend(ncols=4, fontsize=7)
        if own:
            best = int((totals / frames).argmin())
            ax.plot(x[best], totals[best] / frames[best], "o", color=WINNER, markersize=8, fillstyle="none")
            minima.append(f"{preset} is fastest at {x[best]:.0e}".replace("e+0", "e"))
        plot.rows += [{"preset": preset, "seed_threshold": value, "traverse_ms": 1e3 * case.stage("traverse") / case.frames,
                       "whole_ms": 1e3 * case.total() / case.frames, "low_ms": 1e3 * case.total("low") / case.frames,
                       "high_ms": 1e3 * case.total("high") / case.frames, "seeds": sum(r["work"]["counters"].get("seeds", 0) for r in case.records
                                                                                      if (r["work"] or {}).get("counters")) / case.frames,
                       "records": case.locations[0]} for value, case in own]
    return plot.save(folder.path, f"Seed thresholds on {cases[0].scene}: {'; '.join(minima)}")


def figure14(folder):
    """Chunk bytes of equation (1) and orders of tetrahedra. The paper mentions them but does not measure them."""
    cases = [case for case in folder.cases("chunk-study")]
    if not cases:
        return missing(folder.path, 14, "Chunk bytes and orders of tetrahedra", "no cell of the study has completed")
    values = sorted({case.settings["k"] for case in cases}, key=int)
    plot = Plot(14, len(values), 2.8)
    orders = list(dict.fromkeys(case.settings["builder"] for case in cases))
    minima = []
    for ax, k in zip(plot.axes, values):
        for colour, order in zip(COLOURS, orders):
            own = sorted((case for case in cases if case.settings["k"] == k and case.settings["builder"] == order), key=lambda case: int(case.settings["chunk_bytes"]))
            x = [int(case.settings["chunk_bytes"]) for case in own]
            y, low, high = ([1e3 * case.total(which) / case.frames for case in own] for which in ("median", "low", "high"))
            ax.fill_between(x, low, high, color=colour, alpha=0.2, linewidth=0)
            ax.plot(x, y, "o-", color=colour, markersize=4, label=order)
            plot.rows += [{"k": k, "order": order, "chunk_bytes": bytes_, "ms": ms, "low_ms": l, "high_ms": h, "records": case.locations[0]}
                          for case, bytes_, ms, l, h in zip(own, x, y, low, high)]
        ax.set(xscale="log", yscale="log", xlabel="chunk bytes of equation (1)")
        ax.set_title(f"chunked grouped, k = {k}", fontsize=9, loc="left", color=INK)
        milliseconds(ax)
        ax.legend(ncols=4, fontsize=8)
        best = min((case for case in cases if case.settings["k"] == k), key=lambda case: case.total() / case.frames)
        ax.plot(int(best.settings["chunk_bytes"]), 1e3 * best.total() / best.frames, "o", color=WINNER, markersize=9, fillstyle="none")
        minima.append(f"{best.settings['builder']}, {int(best.settings['chunk_bytes']):,} bytes at k = {k}")
    return plot.save(folder.path, f"Beyond the paper, chunk bytes and orders on {cases[0].scene}: fastest {'; '.join(minima)}")


def all_curves(folder):
    return [make(folder) for make in (figure7, figure8, figure9, figure10, figure11, figure12, figure13, figure14)]
