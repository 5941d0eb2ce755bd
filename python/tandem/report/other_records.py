# SPDX-License-Identifier: MIT
"""Data of profiles, ceilings and simulations for the page. Each function raises one of lines.FIELD_ERRORS for
a record that lacks fields of its schema."""

import dataclasses
import os

from .. import names
from ..fields import at, checked, needed
from .conditions import conditions_text
from .numbers import is_number, rounded

KERNEL_NUMBERS = """
    share launches bytes operations bytes_per_s operations_per_s of_bytes of_operations over_floor
    occupancy
""".split()
CEILINGS = ("bytes_per_s", "cached_bytes_per_s", "operations_per_s")
HOST_PARTS = ("broad", "narrow", "reduce", "assemble", "solve", "move")
MAX_RUNS, MAX_STEPS = 40, 600


def _device_text(device):
    return f"{needed(device, 'id')} ({needed(device, 'name')})"


def _name(record):
    name = (
        f"{names.method(needed(record, 'algorithm'), needed(record, 'preset'))}, k = {record['settings'].get('k', '?')}, "
        f"{names.scene(needed(record, 'scene', 'key'))}, on {_device_text(record['devices'][0])}"
    )
    return name if record["status"] == "ok" else f"{needed(record, 'status')}: {name}"


def _numbers(part, fields):
    """{field: its number with six digits, or None}"""
    return {field: rounded(part[field]) if is_number(part.get(field)) else None for field in fields}


def _kernel(kernel):
    texts = {name: needed(kernel, name) for name in ("entry", "stage")}
    ms = [needed(kernel, "device_ns", name, kind="number") / 1e6 for name in ("median", "low", "high")]
    return texts | _numbers(kernel, KERNEL_NUMBERS) | {"ms": ms, "bound": kernel.get("bound")}


def _ceiling_conditions(record):
    """Where the ceilings of a profile are from, and under which conditions they hold."""
    ceilings = record["ceilings"]
    origin, date = needed(ceilings, "from"), needed(ceilings, "date")
    if origin != "measured":
        return f"from {os.path.basename(origin)}, measured {date}; the file's record has their conditions"
    cached = needed(ceilings, "cached_bytes", kind="number")
    cache = f"; that of cached bytes with {cached:,.0f} bytes" if cached else ""
    return f"measured before the kernels in the same run, {date}{cache}. Conditions of the run: {conditions_text(record)}"


def shown_profile(record):
    """A profile for the page."""
    return {
        "name": _name(record),
        "ceilings": _numbers(record["ceilings"], CEILINGS),
        "conditions": _ceiling_conditions(record),
        "kernels": list(map(_kernel, record["kernels"])),
    }


def shown_ceilings(record):
    device, environment = record["device"], record["environment"]
    commit = f"{environment.get('commit') or 'unknown'}{', with changes' if environment.get('dirty') else ''}"
    conditions = {
        "measured on": needed(environment, "date"),
        **{name: needed(device, name) for name in ("driver", "compiler")},
        "commit": commit,
    }
    values = {
        name: rounded(needed(record, name, "median", kind="number"))
        for name in sorted(record)
        if at(record, name, "median") is not None
    }
    return {"device": _device_text(device), "conditions": conditions, "values": values}


@dataclasses.dataclass
class _Run:
    """Steps of one session; every `stride`-th step if there are more than MAX_STEPS. kept: rows [step, ms by
    part..., contacts found, contacts kept]."""

    name: str
    status: str = "not ended"
    failure: str = ""
    steps: int = 0
    stride: int = 1
    kept: list = dataclasses.field(default_factory=list)

    def add(self, step):
        self.steps += 1
        if (self.steps - 1) % self.stride:
            return
        self.kept.append(step)
        if len(self.kept) == MAX_STEPS:
            self.stride *= 2
            self.kept = self.kept[::2]

    def shown(self):
        return {name: value for name, value in vars(self).items() if name != "stride"} | {"parts": HOST_PARTS}


def _step(line):
    times = [rounded(needed(line, "host_ns", part, kind="number") / 1e6) for part in HOST_PARTS]
    step, *contacts = (
        needed(line, name, kind="integer") for name in ("step", "contacts_found", "contacts_kept")
    )
    return [step, *times, *contacts]


class Simulations:
    """Collects records of simulations as curves of bounded length, one per session."""

    def __init__(self):
        self._runs = {}

    def add(self, line, path):
        run = self._runs.setdefault(
            (path, checked(line.get("session", ""), "session")), _Run(os.path.basename(path))
        )
        if line["kind"] == "step":
            run.add(_step(line))
            return
        run.name = f"{names.scene(needed(line, 'scene', 'key'))}, contacts by {_name(line)}"
        run.status = needed(line, "status") or "not ended"
        if isinstance(line.get("failure"), str):
            run.failure = line["failure"]

    def shown(self):
        return [run.shown() for run in list(self._runs.values())[:MAX_RUNS]]

    @property
    def left_out(self):
        return max(len(self._runs) - MAX_RUNS, 0)
