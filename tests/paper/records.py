# SPDX-License-Identifier: MIT
"""Made-up records of cells and simulations, in a folder of 'tandem paper', for tests of its verdicts."""

import json

from tandem.paper.quantities import resolved

FULL_STEPS = 500
SCENE_KEYS = {
    "funnel": "recording:x,of=funnel:bodies=1@0",
    "glasses": "recording:x,of=glasses:bodies=1@0",
    "colosseum": "recording:x,of=colosseum:a=1@0",
    "plates": "plates:count=3",
    "tower": "recording:x,of=tower:a=1@0",
    "jammed funnel": "recording:x,of=funnel:bodies=1@0",
    "jammed glasses": "recording:x,of=glasses:bodies=1@0",
    "jacks 0.05": "pile:bodies=2,mesh=jack,density=0.05,x",
    "jacks 0.2": "pile:bodies=2,mesh=jack,density=0.2,x",
}


GPROXIMITY = {"group_size": "992", "local_queue": "1023", "groups": "0"}  # launch geometry of its preset


def times(values):
    """Nanoseconds of a stage or of whole frames, one value for each round."""
    ordered = sorted(values)
    return {
        "samples": list(values),
        "rounds": list(range(len(values))),
        "median": ordered[len(ordered) // 2],
        "low": ordered[0],
        "high": ordered[-1],
        "frames": [values[0]],
    }


def record(scene, wanted, count):
    """A record without times. wanted: algorithm, preset and settings; count: number of rounds."""
    settings = {name: value for name, value in wanted.items() if name not in ("algorithm", "preset")}
    return {
        "schema": 4,
        "key": json.dumps([scene, wanted]),
        "session": "s",
        "status": "ok",
        "algorithm": wanted["algorithm"],
        "preset": wanted.get("preset", "paper"),
        "settings": {"batch": "1", "queue_bytes": "67108864", **GPROXIMITY, "copies": "pair", **settings},
        "asked": {},
        "scene": {
            "name": scene,
            "key": SCENE_KEYS[scene],
            "digest": scene,
            "bodies": 1,
            "vertices": 1,
            "tetrahedra": 1,
        },
        "frames": {"first": 0, "last": FULL_STEPS - 1},
        "devices": [{"id": "cuda:0", "name": "GPU", "driver": "1", "kind": "gpu", "compute_units": 14}],
        "environment": {"commit": "1", "dirty": False},
        "conditions": {"disturbed": []},
        "total_ns": {**times([10**9] * count), "frames": [[10**9 / FULL_STEPS] * FULL_STEPS] * count},
        "breakdown_ns": {**times([10**9] * count), "frames": [10**9 / FULL_STEPS] * FULL_STEPS},
        "stages": {},
        "kernel_times": {},
        "host_work": {},
        "phases": {},
        "work": {
            "batches": FULL_STEPS,
            "counters": {},
            "contacts": [1] * FULL_STEPS,
            "candidate_pairs": [1] * FULL_STEPS,
            "body_pairs": [1] * FULL_STEPS,
        },
        "agreement": None,
    }


def _stage(made, name, values):
    made["stages"][name] = {
        "device_ns": {**times(values), "frames": [values[0] / FULL_STEPS] * FULL_STEPS},
        "host_ns": {**times([0] * len(values)), "frames": [0] * FULL_STEPS},
        "launches": 0,
        "waits": 0,
        "bytes": 0,
    }


def set_quantity(made, name, values):
    """Gives a record a quantity of tandem.paper.quantities: nanoseconds for each round, or the first value as
    a count."""
    kind, _, rest = resolved(name).partition(":")
    first = rest.split("+")[0]
    if kind == "largest":
        set_quantity(made, first, values)
    elif kind == "sum":
        *others, last = rest.split("+")
        known = [made["stages"][name]["device_ns"]["samples"] for name in others if name in made["stages"]]
        set_quantity(made, last, [value - sum(parts) for value, *parts in zip(values, *known)])
    elif kind == "frame":
        made["total_ns"] = {
            **times(values),
            "frames": [[value / FULL_STEPS] * FULL_STEPS for value in values],
        }
    elif kind == "breakdown":
        made["breakdown_ns"] = {**times(values), "frames": [values[0] / FULL_STEPS] * FULL_STEPS}
    elif kind == "stages":
        _stage(made, first, values)
    elif kind == "host work":
        made["host_work"][first] = {"host_ns": times(values)}
    elif kind == "phases":
        frames = [values[0] / FULL_STEPS] * FULL_STEPS
        made["phases"][first] = {"host_ns": {**times(values), "frames": frames}}
    elif kind == "release launches":
        made["kernel_times"]["traverse"] = {"launches": values[0]}
    elif kind == "counter":
        made["work"]["counters"][rest] = values[0]
    elif kind in ("contacts", "body pairs"):
        made["work"][kind.replace(" ", "_")] = [values[0] / FULL_STEPS] * FULL_STEPS
    elif kind == "batches":
        made["work"]["batches"] = values[0] * FULL_STEPS
    elif kind in ("bodies", "vertices", "tetrahedra"):
        made["scene"][kind] = round(values[0])
    else:  # launches and bytes of a stage
        made["stages"].setdefault(
            first, {"device_ns": times([0]), "host_ns": times([0]), "launches": 1, "waits": 0, "bytes": 0}
        )
        made["stages"][first]["launches" if kind == "launches" else "bytes"] = values[0]


def step(number, **fields):
    """A step of a simulation: nanoseconds of parts and stages."""
    host = {name: 10**6 for name in ("step", "broad", "narrow", "reduce", "assemble", "solve", "move")}
    stages = {
        name: {"device_ns": 10**6, "host_ns": 0, "launches": 1}
        for name in ("transform", "refit", "traverse", "contact", "read", "write")
    }
    for name, ns in fields.pop("stages", {}).items():
        stages[name]["device_ns"] = ns
    return {
        "kind": "step",
        "step": number,
        "host_ns": host | fields.pop("host", {}),
        "stages": stages,
        "contacts_found": number + 1,
        "contacts_kept": number + 1,
        **fields,
    }


def simulation(scene, steps, device="cuda:0"):
    run = {
        "kind": "run",
        "scene": {"name": scene, "bodies": 1},
        "algorithm": "chunked",
        "preset": "paper",
        "settings": {"k": "8"},
        "devices": [{"id": device, "name": "GPU"}],
    }
    return [*steps, run]


def write_folder(path, files, size="full"):
    """A folder of 'tandem paper': files are lists of records by the name of their step."""
    (path / "records").mkdir(parents=True, exist_ok=True)
    for name, records in files.items():
        (path / "records" / f"{name}.jsonl").write_text("".join(json.dumps(one) + "\n" for one in records))
    lines = [
        {
            "step": name,
            "exit": 0,
            "size": size,
            "seconds": 1,
            "says": "",
            "command": "",
            "commit": "",
            "dirty": False,
            "date": "2026-01-01",
            "device": "cuda:0",
        }
        for name in files or ["none"]
    ]
    (path / "steps.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    return path
