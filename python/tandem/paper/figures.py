# SPDX-License-Identifier: MIT
"""Figures 7 to 13 of the paper from our records."""
import numpy

from .drawing import COLOUR_OF, COLOURS, INK, PALE, STAGES, WINNER, Plot, milliseconds, missing
from .folder import SCENES
from .tables import data_path, pick

MAX_COSTS = 6  # of Figures 7 and 10, as in the paper


def published_gproximity(folder):
    ways = [pick(folder.ways(f"cells-{scene}"), "gproximity", "published") for scene in SCENES]
    return [way for way in ways if way]


def figure7(folder):
    """gProximity's six largest costs in percent, and its launches."""
    ways = published_gproximity(folder)
    if not ways:
        return missing(folder.path, 7, "gProximity's bottlenecks", "no cell of gProximity published has ended well")
    plot = Plot(7, 2, 2.6)
    sums = {stage: sum(way.stage(stage) / way.total() for way in ways) for stage in STAGES}
    costs = sorted(sums, key=sums.get, reverse=True)[:MAX_COSTS]
    percent_axis, launches = plot.axes
    left = numpy.zeros(len(ways))
    for stage in costs:
        part = numpy.array([100 * way.stage(stage) / sum(way.stage(name) for name in STAGES) for way in ways])
        percent_axis.barh(range(len(ways)), part, left=left, color=COLOUR_OF[stage], label=stage, height=0.65)
        left += part
    percent_axis.set_yticks(range(len(ways)), [way.scene for way in ways])
    percent_axis.set_xlabel("percent of a frame's stages")
    percent_axis.invert_yaxis()
    percent_axis.legend(ncols=6, loc="lower left", bbox_to_anchor=(0, 1), fontsize=8, handlelength=1)
    for row, way in enumerate(ways):
        counts = {stage: way.stage(stage, "launches") / way.frames for stage in ("refit", "traverse", "balance", "contact")}
        start = 0
        for stage, count in counts.items():
            launches.barh(row, count, left=start, color=COLOUR_OF[stage], height=0.65)
            start += count
        launches.annotate(f" {start:.0f}", (start, row), va="center", fontsize=8)
        plot.rows += [{"scene": way.scene, "stage": stage, "ms_a_frame": 1e3 * way.stage(stage) / way.frames, "launches_a_frame": counts.get(stage),
                       "records": way.places[0]} for stage in STAGES]
    launches.set_yticks(range(len(ways)), [way.scene for way in ways])
    launches.set_xlabel("launches a frame")
    launches.invert_yaxis()
    worst = max(ways, key=lambda way: way.stage("write") / way.total())
    first = max(STAGES, key=lambda stage: sums[stage])
    return plot.save(folder.path, f"gProximity as published: {first} is its largest cost, and write is {100 * worst.stage('write') / worst.total():.0f} % of {worst.scene}")


def figure8(folder):
    """gProximity's stages over frames of one scene."""
    way = next((way for way in published_gproximity(folder) if way.scene == "funnel"), None)
    if way is None:
        return missing(folder.path, 8, "gProximity over frames", "no cell of gProximity published on funnel has ended well")
    plot = Plot(8, 2, 2.6)
    times, launches = plot.axes
    tops = {}
    for stage in STAGES:
        where = "device_ns" if way.stage(stage, "device_ns") else "host_ns"
        rows = way.per_frame(stage, where)
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
    counts = sorted((r["frames"]["first"], sum(s["launches"] for s in r["stages"].values()) / (r["frames"]["last"] - r["frames"]["first"] + 1), r) for r in way.records)
    for first, count, record in counts:
        launches.plot([first, record["frames"]["last"]], [count, count], "o-", markersize=3, color=WINNER)
        plot.rows.append({"frame": first, "stage": "launches", "launches": count})
    launches.set_ylabel("launches a frame")
    launches.set_ylim(bottom=0)
    launches.set_xlabel("frame")
    largest = max(tops, key=tops.get)
    return plot.save(folder.path, f"gProximity as published, {way.scene}, over frames: {largest} costs most, {tops[largest] / sum(tops.values()):.0%} of all stages")


LEAST_RANGE = 4  # of contacts, most over least, from which on an exponent says something


def fit(x, y):
    """Exponent, factor and R^2 of y = a x^b, least squares of logarithms; None for few points or contacts that hardly change."""
    x, y = numpy.array(x, float), numpy.array(y, float)
    good = (x > 0) & (y > 0)
    if good.sum() < 10 or numpy.quantile(x[good], 0.95) < LEAST_RANGE * numpy.quantile(x[good], 0.05):
        return None
    lx, ly = numpy.log(x[good]), numpy.log(y[good])
    slope, offset = numpy.polyfit(lx, ly, 1)
    spread = ((ly - ly.mean()) ** 2).sum()
    return slope, numpy.exp(offset), 1 - ((ly - slope * lx - offset) ** 2).sum() / spread if spread > 0 else 1.0


def device_seconds(simulation):
    """The device time of traverse and contact by step."""
    return [t + c for t, c in zip(simulation.curve("stage:traverse"), simulation.curve("stage:contact"))]


def figure9(folder):
    simulations = folder.simulations("sim-")
    if not simulations:
        return missing(folder.path, 9, "Contacts over steps", "no simulation has ended well")
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
    notes = ", ".join(f"{scene} {values[0]:.2f}" for scene, values in exponents.items())
    return plot.save(folder.path, f"Time of traversal and contacts over a step's contacts: exponents {notes}" if notes else "Contacts of a step, and the time of traversal and contacts: they change too little for a fit")


def costs_of(simulation):
    """Seconds by part: stages of contact finding, and the rest of a step."""
    parts = {stage: simulation.stage(stage) for stage in STAGES}
    return parts | {name: simulation.host(name) for name in ("reduce", "assemble", "solve", "move")}


def figure10(folder):
    runs = [run for beginning in ("sim-", "host-", "serial-", "parallel-") for run in folder.simulations(beginning)]
    runs = sorted(runs, key=lambda run: SCENES.index(run.scene))
    if not runs:
        return missing(folder.path, 10, "What simulations cost", "no simulation has ended well")
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
        plot.rows += [{"run": names[row], "cost": name, "ms_a_step": 1e3 * value, "records": runs[row].place} for name, value in costs.items()]
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
        return missing(folder.path, 11, "Stages over steps", "no simulation of funnel or glasses has ended well")
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
    ways = [way for scene in SCENES for way in folder.ways(f"cells-{scene}") if way.settings.get("k") == "8" and way.theirs is not None]
    if not simulations and not ways:
        return missing(folder.path, 12, "Launches", "nothing has ended well")
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
    methods = list(dict.fromkeys(way.name for way in ways))
    scenes = [scene for scene in SCENES if any(way.scene == scene for way in ways)]
    for i, method in enumerate(methods):
        own = [(scenes.index(way.scene), way.theirs / way.frames, way) for way in ways if way.name == method]
        bars.bar([x + 0.2 * (i - 1.5) for x, _, _ in own], [y for _, y, _ in own], width=0.18, color=COLOURS[i % len(COLOURS)], label=method)
        plot.rows += [{"scene": way.scene, "method": method, "launches": y, "counted": "as theirs", "records": way.places[0]} for _, y, way in own]
    bars.set_xticks(range(len(scenes)), scenes)
    bars.set_ylabel("launches a frame, as theirs")
    bars.set_yscale("log")
    bars.legend(fontsize=8, ncols=2, loc="lower left", bbox_to_anchor=(0, 1))
    most = max(ways, key=lambda way: way.theirs / way.frames) if ways else None
    notes = f"; {most.name} takes up to {most.theirs / most.frames:.0f}, on {most.scene}" if most else ""
    return plot.save(folder.path, f"Launches: chunked takes a few a step, however many contacts there are{notes}")


def figure13(folder):
    ways = folder.ways("thresholds")
    if not ways:
        return missing(folder.path, 13, "Seed thresholds", "no cell of the sweep has ended well")
    plot = Plot(13, 2, 2.5)
    notes = []
    for ax, preset in zip(plot.axes, ("published", "grouped")):
        own = sorted((int(way.settings["seed_threshold"]), way) for way in ways if way.preset == preset)
        x = [value for value, _ in own]
        for name, colour in (("traverse", COLOUR_OF["traverse"]), ("seed", "#777777"), ("write", COLOUR_OF["write"])):
            ax.plot(x, [1e3 * way.stage(name) / way.frames for _, way in own], "o-", color=colour, markersize=4, label=name)
        totals = numpy.array([way.total() for _, way in own]) * 1e3
        frames = numpy.array([way.frames for _, way in own])
        low, high = (numpy.array([way.total(which) for _, way in own]) * 1e3 for which in ("low", "high"))
        ax.plot(x, totals / frames, "o-", color=INK, markersize=4, label="whole frame")
        ax.fill_between(x, low / frames, high / frames, color=INK, alpha=0.15, linewidth=0)
        ax.set(xscale="log", yscale="log", xlabel="seed threshold")
        ax.set_title(f"chunked {preset}", fontsize=9, loc="left", color=INK)
        milliseconds(ax)
        ax.legend(ncols=4, fontsize=7)
        if own:
            best = int((totals / frames).argmin())
            ax.plot(x[best], totals[best] / frames[best], "o", color=WINNER, markersize=8, fillstyle="none")
            notes.append(f"{preset} is fastest at {x[best]:.0e}".replace("e+0", "e"))
        plot.rows += [{"preset": preset, "seed_threshold": value, "traverse_ms": 1e3 * way.stage("traverse") / way.frames,
                       "whole_ms": 1e3 * way.total() / way.frames, "low_ms": 1e3 * way.total("low") / way.frames,
                       "high_ms": 1e3 * way.total("high") / way.frames, "seeds": sum(r["work"]["counters"].get("seeds", 0) for r in way.records
                                                                                      if (r["work"] or {}).get("counters")) / way.frames,
                       "records": way.places[0]} for value, way in own]
    return plot.save(folder.path, f"Seed thresholds on {ways[0].scene}: {'; '.join(notes)}")


def figure14(folder):
    """Not of the paper: equation (1)'s chunk bytes, and orders of tetrahedra, which its text names and does not measure."""
    ways = [way for way in folder.ways("chunk-study")]
    if not ways:
        return missing(folder.path, 14, "Chunk bytes and orders of tetrahedra", "no cell of the study has ended well")
    values = sorted({way.settings["k"] for way in ways}, key=int)
    plot = Plot(14, len(values), 2.8)
    orders = list(dict.fromkeys(way.settings["builder"] for way in ways))
    notes = []
    for ax, k in zip(plot.axes, values):
        for colour, order in zip(COLOURS, orders):
            own = sorted((way for way in ways if way.settings["k"] == k and way.settings["builder"] == order), key=lambda way: int(way.settings["chunk_bytes"]))
            x = [int(way.settings["chunk_bytes"]) for way in own]
            y, low, high = ([1e3 * way.total(which) / way.frames for way in own] for which in ("median", "low", "high"))
            ax.fill_between(x, low, high, color=colour, alpha=0.2, linewidth=0)
            ax.plot(x, y, "o-", color=colour, markersize=4, label=order)
            plot.rows += [{"k": k, "order": order, "chunk_bytes": bytes_, "ms": ms, "low_ms": l, "high_ms": h, "records": way.places[0]}
                          for way, bytes_, ms, l, h in zip(own, x, y, low, high)]
        ax.set(xscale="log", yscale="log", xlabel="chunk bytes of equation (1)")
        ax.set_title(f"chunked grouped, k = {k}", fontsize=9, loc="left", color=INK)
        milliseconds(ax)
        ax.legend(ncols=4, fontsize=8)
        best = min((way for way in ways if way.settings["k"] == k), key=lambda way: way.total() / way.frames)
        ax.plot(int(best.settings["chunk_bytes"]), 1e3 * best.total() / best.frames, "o", color=WINNER, markersize=9, fillstyle="none")
        notes.append(f"{best.settings['builder']}, {int(best.settings['chunk_bytes']):,} bytes at k = {k}")
    return plot.save(folder.path, f"Beyond the paper, chunk bytes and orders on {ways[0].scene}: fastest {'; '.join(notes)}")


def all_curves(folder):
    return [make(folder) for make in (figure7, figure8, figure9, figure10, figure11, figure12, figure13, figure14)]
