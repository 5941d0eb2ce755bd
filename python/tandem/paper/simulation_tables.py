# SPDX-License-Identifier: MIT
"""Tables 3, 6 and 7: whole simulations. Runs of one scene are compared over the steps that all of them
have."""

from .folder import PAPERS_SOLVER, STEPS_OF_PAPER, paper_table
from .methods import columns_of, timers
from .simulation import composed_share_of
from .tables import Table, ordered, paper_rows, ratio, written

KINDS = (PAPERS_SOLVER, "host-", "serial-", "parallel-")
COMMON = (
    "Rows of one scene are sums over the same steps from step 0, as many as its shortest run has (column steps). The paper's are of 500 steps. Rows with 'composed' "
    "are frames of that recording, measured with the published path, beside the solver of the recording; each counts for the steps nearest to it, and their minutes are 500 times the mean step."
)


def common_runs(folder, kinds=KINDS):
    """The simulations of these kinds, each cut to the steps that all runs with its label have."""
    runs = [run for kind in kinds for run in folder.simulations(kind)]
    shortest = {
        label: min(len(run.steps) for run in runs if run.label == label)
        for label in {run.label for run in runs}
    }
    return [run.first(shortest[run.label]) for run in runs]


def _without_phases(simulation):
    """Seconds of initialization and narrow phase of steps that were not timed as the release does: transform
    and refit on the device, and the rest."""
    start = simulation.stage("transform") + simulation.stage("refit")
    return {"initialization": start, "narrow": simulation.host("narrow") - start}


def percentages(simulation):
    """Percent of the total time by part, from sums over all steps, as in the paper's Table 3."""
    known = {} if "initialization" in simulation.steps[0]["host_ns"] else _without_phases(simulation)
    seconds = lambda name: sum(map(simulation.host, timers()[name].get("step", [name])))
    return {
        column: 100 * (known[name] if name in known else seconds(name)) / seconds("total")
        for name, column in columns_of(3).items()
        if name != "total"
    }


def data_path(simulation):
    settings = simulation.run["settings"]
    published = settings.get("residency") == "published"
    return f"published, conversion {settings.get('convert', 'serial')}" if published else "resident"


def _minutes(run, seconds):
    """Minutes of a sum over the steps of a run; of a composed one for all steps of the paper."""
    return seconds / 60 * (STEPS_OF_PAPER / len(run.steps) if run.is_composed else 1)


def _row(run, **columns):
    steps = (
        f"{len(run.steps)} of {run.steps[0]['step']}:{run.steps[-1]['step']}"
        if run.is_composed
        else len(run.steps)
    )
    return {
        "scene": run.label,
        "source": "ours",
        "device": run.run["devices"][0]["id"],
        "method": run.method,
        "data_path": data_path(run) + (", composed" if run.is_composed else ""),
        **columns,
        "steps": steps,
        "records": run.location,
    }


def _composition_note(folder):
    """How near frames that were measured apart, with the other parts of a simulation that ran with the
    published path, are to that simulation."""
    texts = []
    for real in folder.simulations("serial-"):
        scene = real.name.removeprefix("serial-")
        made = folder.composition_or_none(real, f"check-{scene}")
        value, count = composed_share_of(real, made) if made else (None, 0)
        if count:
            texts.append(
                f"In {count} steps of {scene}, frames measured apart take {written(value)} times as long, with the other parts of a simulation with the published path, "
                "as that simulation."
            )
    return tuple(texts)


def _convergence_note(runs):
    """The deepest overlap of each run, and its steps whose solver reached the limit of its passes."""
    texts = []
    for run in runs:
        limit = run.run.get("dynamics", {}).get("iterations")
        if limit is None or any("deepest_m" not in step for step in run.steps):
            continue
        capped = sum(step["iterations"] >= float(limit) for step in run.steps)
        texts.append(
            f"{run.name} {written(max(step['deepest_m'] for step in run.steps))} m, {capped} of {len(run.steps)}"
        )
    return (
        (f"Deepest overlap, and steps whose solver reached its limit of passes: {'; '.join(texts)}.",)
        if texts
        else ()
    )


def table3(folder):
    columns = [column for name, column in columns_of(3).items() if name != "total"]
    rows = paper_rows(paper_table(3), {"total_min": "total_min", **{name: name for name in columns}})
    rows += [
        _row(run, total_min=_minutes(run, run.host("step")), **percentages(run))
        for run in common_runs(folder) + folder.compositions()
    ]
    for row in rows:
        row["collision_percent"] = sum(row[name] or 0 for name in columns if name != "solver_percent")
        row.setdefault("steps", STEPS_OF_PAPER)
    return Table(
        3,
        "Parts of the time of a simulation",
        ordered(rows),
        (
            COMMON,
            "The paper's are means of ten runs of its published path; ours are one run each, with the settings of the paper's solver, on one thread as the "
            "paper's. No record says what else ran on the machine beside the solver, so that minutes and shares are provisional.",
            "Composed rows have initialization and narrow phase as the release times them, if the records have these phases. Other rows have transform and refit on the "
            "device as initialization.",
            *_convergence_note(folder.simulations(PAPERS_SOLVER)),
            *_composition_note(folder),
        ),
    )


def table6(folder):
    rows = paper_rows(
        paper_table(6),
        {name: name for name in ("total_min", "read_min", "write_min", "read_percent", "write_percent")},
    )
    for run in common_runs(folder) + folder.compositions():
        total, read, write = run.host("step"), run.stage("read", "device_ns"), run.stage("write", "device_ns")
        rows.append(
            _row(
                run,
                total_min=_minutes(run, total),
                read_min=_minutes(run, read),
                write_min=_minutes(run, write),
                read_percent=100 * read / total,
                write_percent=100 * write / total,
            )
        )
    for row in rows:
        row.setdefault("steps", STEPS_OF_PAPER)
    return Table(
        6, "Transfers of a simulation", ordered(rows), (COMMON, "Device times of uploads and downloads.")
    )


def table7(folder):
    names = ("transform", "refit", "traverse", "contact")
    rows = paper_rows(paper_table(7), {f"{name}_min": f"{name}_min" for name in names})
    runs = common_runs(folder, (PAPERS_SOLVER, "host-", "serial-")) + folder.compositions()
    rows += [_row(run, **{f"{name}_min": _minutes(run, run.stage(name)) for name in names}) for run in runs]
    for row in rows:
        row["traverse_over_contact"] = ratio(row["traverse_min"], row["contact_min"])
        row.setdefault("steps", STEPS_OF_PAPER)
    return Table(
        7,
        "Kernels of a simulation",
        ordered(rows),
        (COMMON, "Device times; a resident frame of rigid bodies is transformed in its refit."),
    )
