# SPDX-License-Identifier: MIT
"""Tables of simulations: fractions of time by stage of each run, and runs that have not ended."""

import statistics

from .naming import Named, labels
from .wording import number, table, verdict


class Run(Named):
    """A run of a simulation: the steps that one process recorded."""

    HEADS = [
        "scene",
        "method",
        "device",
        "steps",
        "ms a step",
        "total s",
        "warm-up s",
        "initialization",
        "broad",
        "narrow",
        "contact reduction",
        "solver and its rows",
        "motion",
        "contacts found / kept",
        "notes",
    ]

    def __init__(self, record, devices, steps):
        super().__init__(record, devices, record["dynamics"])
        host, total = record["host_ns"], record["host_ns"]["total"]
        part = lambda ns: f"{100 * ns / total:.1f} %" if total else "-"
        start = record["initialize_device_ns"]
        warm_up = record.get("warm_up_ns")
        self.texts = [
            f"{record['steps']}",
            number(statistics.median(steps) / 1e6) if steps else "-",
            f"{total / 1e9:.3g}",
            "" if warm_up is None else f"{warm_up / 1e9:.3g}",
            part(start),
            part(host["broad"]),
            part(host["narrow"] - start),
            part(host["reduce"]),
            part(host["assemble"] + host["solve"]),
            part(host["move"]),
            f"{record['contacts_found_median']:.0f} / {record['contacts_kept_median']:.0f}",
            verdict(record),
        ]


class Simulations:
    """Runs, and by file and session the steps of runs whose own line has not been read yet."""

    def __init__(self):
        self.runs, self.steps = [], {}

    def add(self, record, file, devices):
        session = (file, record.get("session"))
        if record["kind"] == "step":
            self.steps.setdefault(session, []).append(record["host_ns"]["step"])
        else:
            self.runs.append(Run(record, devices, self.steps.pop(session, [])))

    def text(self, devices):
        texts = ""
        if self.runs:
            rows = [
                [run.heading, *name, *run.texts] for run, name in zip(self.runs, labels(self.runs, devices))
            ]
            texts = "\n### Simulations\n\n" + table(Run.HEADS, rows)
        unfinished = {file: own for (file, _), own in self.steps.items()}
        for file, steps in unfinished.items():
            texts += f"\n{file}: {len(steps)} steps of a simulation that has not ended, {number(statistics.median(steps) / 1e6)} ms a step, median.\n"
        return texts
