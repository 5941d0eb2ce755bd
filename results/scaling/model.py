#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""model.py: writes the tables between <!-- model: NAME --> and <!-- end --> of results/scaling/README.md: a
model of the time of a frame on a device, from records of one device, of several devices and of ranks, and
tables of the microbenchmarks of the partitioner and the ghost lists. The fit is one of non-negative least
squares of relative errors, stage by stage, over all records of one device, algorithm, k and settings."""

import dataclasses
import json
import math
import pathlib
import re
import statistics
import sys

import numpy as np
import scipy.optimize

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER.parent))
from measured import RESULTS, frames_of, records
from tandem import markdown

FILES = (*sorted((RESULTS / "h100x2").glob("*.jsonl")), FOLDER / "ranks.jsonl")
GROUP = "tiled resident, k = 18, slabs=three"  # of the table of coefficients
STAGES = {
    "refit": ("refit",),
    "broad": ("broad",),
    "walk": ("seed", "traverse", "balance"),
    "contact": ("contact",),
}
GROUPING = ("slabs", "builder", "schedule", "descent", "contact_rule")  # settings that change coefficients
TILE = 32  # bodies per tile of the broad stage


@dataclasses.dataclass
class Load:
    """Work and time of one device in a mean frame: counts, microseconds by part, and total. `exchange`:
    (messages, bytes, microseconds) of a rank."""

    counts: dict
    us: dict
    total: float
    exchange: tuple = None


@dataclasses.dataclass
class Record:
    """The loads of a completed cell, and the time of its frames."""

    loads: list
    frame_us: float
    scene: dict
    device_bytes: float
    pairs: float
    is_ranks: bool


def _mean(values):
    return sum(values) / len(values) if isinstance(values, list) else values


def _part_times(stages, frames):
    """Microseconds of each part by the clock of the device, or by that of the host for devices without one
    (host, PoCL)."""
    return {
        part: sum(stages[s] for s in names if s in stages) / frames / 1e3 for part, names in STAGES.items()
    }


def _load(counts, times, total, frames, exchange=None):
    times["host"] = max(total - sum(times.values()), 0.0)
    if exchange:
        exchange = (
            exchange["messages"] / frames,
            exchange["bytes"] / frames,
            exchange["host_ns"] / frames / 1e3,
        )
    return Load(counts, times, total, exchange)


def counts_of(scene, bodies, own, body_pairs, pairs, *, is_sorted, known=None):
    """Counts of a device with `bodies` bodies, of which it owns `own`. `known`: number of bodies whose poses
    the host has for the device; default: all of the scene."""
    tiles = lambda n: math.ceil(n / TILE)
    return {
        "bodies": bodies,
        "own": own,
        "tetrahedra": scene["tetrahedra"] * bodies / scene["bodies"],
        "tile_pairs": tiles(own) * tiles(bodies),
        "body_pairs": body_pairs,
        "pairs": pairs,
        "scene_bodies": scene["bodies"] if known is None else known,
        "sorted": scene["bodies"] if is_sorted else 0,
    }


def _load_alone(record, frames):
    work, bodies = record["work"], record["scene"]["bodies"]
    stages = {name: stage["device_ns"]["median"] for name, stage in record["stages"].items()}
    is_sorted = record["settings"].get("broad") == "device"
    pairs = _mean(work["body_pairs"]), _mean(work["candidate_pairs"])
    counts = counts_of(record["scene"], bodies, bodies, *pairs, is_sorted=is_sorted)
    return _load(counts, _part_times(stages, frames), record["total_ns"]["median"] / frames / 1e3, frames)


def _load_of_part(record, one, frames):
    """The load of one of several devices."""
    stages = {name: stage["device_ns"] for name, stage in one["stages"].items()}
    bodies, own = _mean(one["bodies"]), record["scene"]["bodies"] / len(record["partition"]["devices"])
    known = bodies if record.get("ranks") else None
    pairs = _mean(one["body_pairs"]), _mean(one["candidate_pairs"])
    counts = counts_of(record["scene"], bodies, own, *pairs, is_sorted=False, known=known)
    total = one["ns"]["median"] / frames / 1e3
    return _load(counts, _part_times(stages, frames), total, frames, one["exchange"])


def loads_of(record):
    """The Record of a cell's JSON record."""
    frames, parts = frames_of(record), record.get("partition")
    loads = [_load_of_part(record, one, frames) for one in parts["devices"]] if parts else None
    return Record(
        loads or [_load_alone(record, frames)],
        record["total_ns"]["median"] / frames / 1e3,
        record["scene"],
        (record.get("preparation") or {}).get("device_bytes"),
        _mean(record["work"]["candidate_pairs"]),
        record.get("ranks") is not None,
    )


def group_of(record):
    """Name of the group with which a record shares coefficients: devices, algorithm, preset and the settings
    of GROUPING."""
    settings, names = record["settings"], sorted({d["name"] for d in record["devices"]})
    more = "".join(f", {name}={settings[name]}" for name in GROUPING if name in settings)
    return f"{' and '.join(names)}, {record['algorithm']} {record['preset']}, k = {settings['k']}{more}"


def groups_of(found):
    """Records by group: completed cells with times of devices, without those of preset published."""
    groups = {}
    for record in found:
        is_timed = record["status"] == "ok" and record["devices"][0].get("clock") is not None
        if is_timed and record["preset"] != "published":
            groups.setdefault(group_of(record), []).append(loads_of(record))
    return groups


# Counts on which the time of each part of a frame depends. Each part also has a constant, for launches and
# waits.
PARTS = {
    "refit": ("tetrahedra",),
    "broad": ("tile_pairs",),
    "walk": ("body_pairs", "pairs"),
    "contact": ("pairs",),
    "host": ("bodies", "scene_bodies", "sorted"),
}
EXCHANGE = ("messages", "bytes")


def non_negative(columns, measured):
    """Non-negative least squares of relative errors."""
    weighted = columns / measured[:, None]
    scale = np.abs(weighted).max(0)
    return scipy.optimize.nnls(weighted / scale, np.ones(len(measured)))[0] / scale


@dataclasses.dataclass
class Term:
    """A fitted time in microseconds: a constant, and one coefficient per count in `per`. `errors`: relative
    error of each load."""

    fixed: float
    per: dict
    errors: list

    def us(self, counts):
        return self.fixed + sum(value * counts[name] for name, value in self.per.items())


def fitted(names, counts, measured):
    """The Term of those counts that differ between loads. Leaves out constant counts, whose coefficients
    cannot be determined."""
    varying = [name for name in names if len({round(c[name], 6) for c in counts}) > 1]
    columns = np.array([[1.0, *(c[name] for name in varying)] for c in counts])
    measured = np.array(measured)
    found = non_negative(columns, measured)
    return Term(found[0], dict(zip(varying, found[1:])), list(np.abs(columns @ found / measured - 1)))


class Model:
    """The model of a group: one Term per part, one for messages between ranks, one for device memory in
    bytes. `errors`: relative error of each record's frame."""

    def __init__(self, records):
        self.records = records
        loads = [one for record in records for one in record.loads]
        self.parts = {}
        for part, names in PARTS.items():
            own = [one for one in loads if one.us[part] > 0]
            if own:
                self.parts[part] = fitted(names, [one.counts for one in own], [one.us[part] for one in own])
        self.exchange = self._fit_exchange(loads)
        self.memory = self._fit_memory()
        self.errors = [self.frame_us(record) / record.frame_us - 1 for record in records]

    @staticmethod
    def _fit_exchange(loads):
        own = [one.exchange for one in loads if one.exchange and one.exchange[2] > 0]
        counts = [dict(zip(EXCHANGE, exchange)) for exchange in own]
        return fitted(EXCHANGE, counts, [exchange[2] for exchange in own]) if own else None

    def _fit_memory(self):
        """Device bytes per placed tetrahedron and per candidate pair. Each device of a process has all
        bodies. Records of ranks have no bytes."""
        own = [r for r in self.records if r.device_bytes and not r.is_ranks]
        counts = [{"tetrahedra": len(r.loads) * r.scene["tetrahedra"], "pairs": r.pairs} for r in own]
        return fitted(("tetrahedra", "pairs"), counts, [r.device_bytes for r in own]) if own else None

    def device_us(self, counts):
        return sum(term.us(counts) for term in self.parts.values())

    def frame_us(self, record):
        """Time of the slowest device by the model, with the measured time of messages."""
        return max(
            self.device_us(one.counts) + (one.exchange[2] if one.exchange else 0) for one in record.loads
        )


class EveryRank:
    """Nanoseconds per body in the largest scene that ranks ran. `own`: the check whether an own body is still
    near, with waits, per own body. `beyond`: the time of a frame beyond that of its slowest rank, per body of
    the scene."""

    def __init__(self, records):
        largest = max((r for r in records if r.is_ranks), key=lambda r: r.scene["bodies"])
        self.bodies, self.ranks = largest.scene["bodies"], len(largest.loads)
        self.own = 1e3 * min(one.exchange[2] / one.counts["own"] for one in largest.loads)
        slowest = max(one.total + one.exchange[2] for one in largest.loads)
        self.beyond = 1e3 * max(largest.frame_us - slowest, 0) / self.bodies


def every_rank(groups):
    """EveryRank of the group whose ranks had the most bodies, the best basis for many bodies."""
    largest = lambda records: max((r.scene["bodies"] for r in records if r.is_ranks), default=0)
    return EveryRank(max(groups.values(), key=largest))


def _are_sufficient(found):
    loads = [load.counts for record in found for load in record.loads]
    return len({(round(counts["tetrahedra"]), round(counts["pairs"])) for counts in loads}) >= 3


def fit(groups):
    """Models of the groups on GPUs with GROUP in their names that have enough records."""
    chosen = {name: own for name, own in groups.items() if GROUP in name and not name.startswith("host ")}
    return {name: Model(own) for name, own in chosen.items() if _are_sufficient(own)}


WHAT = {
    "fixed": "a frame",
    "tetrahedra": "a tetrahedron placed",
    "tile_pairs": "a pair of tiles of 32 bodies",
    "body_pairs": "a pair of bodies",
    "pairs": "a candidate pair",
    "bodies": "a body placed",
    "scene_bodies": "a body of the scene that the process has",
    "sorted": "a body that the host sorts",
    "messages": "a message",
    "bytes": "a byte sent",
}


def _table(heads, rows):
    return markdown.table(heads, rows, numeric=True).rstrip("\n")


def _three_digits(value):
    return "0" if value == 0 else f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def _in_unit(us):
    """Microseconds as text, in the unit that gives a value of at least 1."""
    for unit, scale in (("ms", 1e-3), ("us", 1.0), ("ns", 1e3), ("ps", 1e6)):
        if us * scale >= 1 or unit == "ps":
            return f"{_three_digits(us * scale)} {unit}"


def _percent(value):
    if value < 1e-9:
        return "0"
    return f"{100 * value:.2g} %" if value < 0.995 else f"{100 * value:.0f} %"


def _errors(errors):
    """Texts of their number, their median and their maximum."""
    return [str(len(errors)), _percent(statistics.median(errors)), _percent(max(errors))]


def _rows(model):
    terms = {**model.parts, **({"exchange": model.exchange} if model.exchange else {})}
    for part, term in terms.items():
        values = [
            f"{_in_unit(value)} {WHAT[name]}"
            for name, value in (("fixed", term.fixed), *term.per.items())
            if value > 0
        ]
        yield [part, ", ".join(values), *_errors(term.errors)]
    yield ["**whole frames**", "the slowest device", *_errors([abs(e) for e in model.errors])]
    if model.memory:
        own = model.memory
        values = [f"{_three_digits(value)} bytes {WHAT[name]}" for name, value in own.per.items()]
        yield [
            "memory",
            ", ".join([*([f"{own.fixed / 1e6:,.0f} MB"] if own.fixed else []), *values]),
            *_errors(own.errors),
        ]


def coefficients(models):
    """One table per group."""
    texts = [
        f"{name}: {len(model.records)} records.\n\n"
        + _table(["part", "takes", "measured", "median error", "worst"], list(_rows(model)))
        for name, model in models.items()
    ]
    return "\n\n".join(texts)


def ranks_table(every):
    rows = [
        ["checking whether an own body is still near, waits included", every.own],
        ["a frame beyond the time of its slowest rank, per body of the scene", every.beyond],
    ]
    return f"{every.ranks} ranks, {every.bodies:,} bodies:\n\n" + _table(
        ["what", "ns a body"], [[what, f"{value:.3g}"] for what, value in rows]
    )


def _iterations(found, name):
    """(numbers in the name, benchmark) of all runs of that name, sorted by the numbers."""
    own = [one for one in found if one["run_type"] == "iteration" and one["name"].startswith(f"{name},")]
    numbers = lambda one: [int(number) for number in re.findall(r"/(\d+)", one["name"])]
    return sorted(((numbers(one), one) for one in own), key=lambda pair: pair[0])


def partitions(found):
    """Tables of microbenchmarks of many ranks in one process (tests/bench/partition.cpp)."""
    rows = {"partition": [], "ghosts": []}
    for (parts, each, *_), one in _iterations(found, "partition"):
        us, most = one["real_time"] * 1e3 / parts / each, one["own_most"] / each
        own = [f"{parts:,}", f"{each:,}", f"{one['real_time'] / 1e3:.2f}", f"{us:.1f}", f"{most:.2f}"]
        rows["partition"].append([*own, *_ghosts(each, one)])
    for (ranks, each, *_), one in _iterations(found, "ghosts"):
        kilobytes = [f"{one['setup_bytes_most'] / 1e3:,.0f}", f"{one['frame_bytes_most'] / 1e3:,.1f}"]
        own = [f"{ranks:,}", f"{each:,}", *_ghosts(each, one), f"{one['neighbours_mean']:.1f}"]
        rows["ghosts"].append([*own, *kilobytes])
    ghosts = ["ghost bodies, mean", "most", "mean, of own^(2/3)"]
    heads = {
        "partition": ["parts", "bodies a part", "seconds", "us a body", "most bodies over mean", *ghosts],
        "ghosts": ["ranks", "bodies a rank", *ghosts, "ranks that own them", "KB sent at the set-up, most"]
        + ["KB a frame, most"],
    }
    return {name: _table(heads[name], rows[name]) for name in heads}


def _ghosts(each, one):
    mean, most = one["ghosts_mean"], one["ghosts_most"]
    return [f"{mean:,.0f}", f"{most:,.0f}", f"{mean / each ** (2 / 3):.1f}"]


def tables():
    """Texts by the names of their marks."""
    groups = groups_of(record for path in FILES for record in records(path))
    return {
        "coefficients": coefficients(fit(groups)),
        "every rank": ranks_table(every_rank(groups)),
        **partitions(json.loads((RESULTS / "cpu/bench.json").read_text())["benchmarks"]),
    }


if __name__ == "__main__":
    markdown.rewrite(FOLDER / "README.md", "model", tables())
