# SPDX-License-Identifier: MIT
"""Work and time of each device in a mean frame of a record: counts, and microseconds by part."""

import dataclasses
import math

from .. import cell_rows, kinds

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
    scene, work = record["scene"], record["work"]
    stages = {name: stage["device_ns"]["median"] for name, stage in record["stages"].items()}
    counts = counts_of(
        scene,
        scene["bodies"],
        scene["bodies"],
        _mean(work["body_pairs"]),
        _mean(work["candidate_pairs"]),
        is_sorted=record["settings"].get("broad") == "device",
    )
    return _load(counts, _part_times(stages, frames), record["total_ns"]["median"] / frames / 1e3, frames)


def _load_of_part(record, one, frames):
    """The load of one of several devices."""
    stages, scene = {name: stage["device_ns"] for name, stage in one["stages"].items()}, record["scene"]
    counts = counts_of(
        scene,
        _mean(one["bodies"]),
        scene["bodies"] / len(record["partition"]["devices"]),
        _mean(one["body_pairs"]),
        _mean(one["candidate_pairs"]),
        is_sorted=False,
        known=_mean(one["bodies"]) if record.get("ranks") else None,
    )
    return _load(
        counts, _part_times(stages, frames), one["ns"]["median"] / frames / 1e3, frames, one["exchange"]
    )


def loads_of(record):
    """The Record of a cell's JSON record. Raises one of lines.FIELD_ERRORS."""
    frames, parts = cell_rows.frames_of(record), record.get("partition")
    loads = (
        [_load_alone(record, frames)]
        if parts is None
        else [_load_of_part(record, one, frames) for one in parts["devices"]]
    )
    return Record(
        loads,
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


def read(paths, torn):
    """Records by group. Takes completed cells with times of devices, without those of preset published.
    Raises RecordError."""
    groups = {}
    for path in paths:
        for location, kind, record in kinds.each(path, torn):
            with kinds.fields_of("cell", location):
                if (
                    kind == "cell"
                    and record["status"] == "ok"
                    and record["preset"] != "published"
                    and record["devices"][0].get("clock") is not None
                ):
                    groups.setdefault(group_of(record), []).append(loads_of(record))
    return groups
