# SPDX-License-Identifier: MIT
"""Reads a folder of 'tandem paper': steps, cells, simulations, and the paper's own tables."""
import csv
import json
import pathlib

from .. import lines

SCENES = ("funnel", "glasses", "colosseum", "plates", "tower")
STEPS_OF_TABLES = 102  # frames 20 to 121 of the paper's Tables 4 and 5
# Kernels that the paper's release has too, to count launches as it does. Our refit has a launch for strips and one for tops; our
# balance has one that plans and one that moves. Our seeds and body pairs have launches where the release works on the host.
RELEASE_KERNELS = ("transform_vertices", "refit_tops", "traverse", "traverse_in_groups", "traverse_queues", "plan_balance", "generate_contacts")


def paper_table(number):
    """Rows of results/paper/tableN.csv as texts. The file is part of the package."""
    for folder in (pathlib.Path(__file__).parent / "data", pathlib.Path(__file__).parents[3] / "results" / "paper"):
        path = folder / f"table{number}.csv"
        if path.exists():
            with open(path, newline="") as file:
                return list(csv.DictReader(file))
    raise lines.RecordError(f"table{number}.csv of the paper is not part of this installation; install the package again")


def number(text):
    """A number of a table of the paper; None for an empty field."""
    return float(text) if text else None


class MeasuredCells:
    """The cells of one scene, algorithm, preset and settings, over one or several ranges of frames, with sums over their frames. Times are
    seconds: medians of the replays, on the device, or on the host for stages without device time."""

    def __init__(self, records, locations):
        self.records, self.locations = records, locations
        first = records[0]
        self.scene, self.algorithm, self.preset, self.settings = first["scene"]["name"], first["algorithm"], first["preset"], first["settings"]
        self.device = first["devices"][0]
        self.frames = sum(r["frames"]["last"] - r["frames"]["first"] + 1 for r in records)
        self.first, self.last = min(r["frames"]["first"] for r in records), max(r["frames"]["last"] for r in records)
        self.status = next((r["status"] for r in records if r["status"] != "ok"), "ok")
        self.scale = STEPS_OF_TABLES / self.frames

    @property
    def name(self):
        return f"{self.algorithm} {self.preset}, k = {self.settings.get('k')}"

    def total(self, which="median"):
        return sum(r["total_ns"][which] for r in self.records) / 1e9

    def stage(self, name, where=None):
        """Sum of a stage. where: device_ns, host_ns, launches, waits or bytes; default: the device's time, or else the host's."""
        def of(stage):
            if where in ("launches", "waits", "bytes"):
                return stage[where]
            device, host = stage["device_ns"]["median"], stage["host_ns"]["median"]
            return (device or host if where is None else stage[where]["median"]) / 1e9
        return sum(of(r["stages"][name]) for r in self.records if name in r["stages"])

    def sum(self, where):
        return sum(stage[where] for r in self.records for stage in r["stages"].values())

    def host_work(self, name):
        """Seconds of host work with that name; None for old records without names of host work."""
        if not all("host_work" in r for r in self.records):
            return None
        return sum(r["host_work"][name]["host_ns"]["median"] for r in self.records if name in r["host_work"]) / 1e9

    @property
    def release_launches(self):
        """Launches counted as in the paper's release; None if no kernel exists there."""
        counts = [r["kernel_times"][name]["launches"] for r in self.records for name in RELEASE_KERNELS if name in (r.get("kernel_times") or {})]
        return sum(counts) if counts and self.algorithm in ("chunked", "gproximity") else None

    @property
    def narrow(self):
        """Seconds of the narrow phase as defined by the paper's Table 3: the whole span without transform, refit and broad phase."""
        return max(self.total() - sum(self.stage(name) for name in ("transform", "refit", "broad")), 0)

    @property
    def batches(self):
        """Number of batches of gProximity, which processes a limited number of body pairs at a time (setting batch)."""
        size = int(self.settings.get("batch") or 0)
        return sum(-(-pairs // size) for r in self.records for pairs in (r["work"] or {}).get("body_pairs") or []) if size else None

    def per_frame(self, name, where="device_ns"):
        """Pairs (frame, seconds) of all frames."""
        rows = []
        for r in self.records:
            column = r["stages"].get(name, {}).get(where, {})
            rows += [(r["frames"]["first"] + i, ns / 1e9) for i, ns in enumerate(column.get("frames", []))]
        return sorted(rows)


class Simulation:
    """The steps of the last session of a file of 'tandem simulate --record'."""

    def __init__(self, lines_of_file, name, location):
        self.name, self.location = name, location
        # Steps of several sessions, of which each continues the one before. A repeated step replaces the earlier one.
        steps = {line["step"]: line for line in lines_of_file if line["kind"] == "step"}
        self.steps = [steps[i] for i in sorted(steps)]
        self.run = [line for line in lines_of_file if line["kind"] == "run"][-1]

    @property
    def scene(self):
        return self.run["scene"]["name"]

    def host(self, name):
        """Seconds of a part on the host; "step" is the total."""
        return sum(step["host_ns"][name] for step in self.steps) / 1e9

    def stage(self, name, where=None):
        of = lambda stage: (stage["device_ns"] or stage["host_ns"]) / 1e9 if where is None else stage[where] / (1e9 if where.endswith("_ns") else 1)
        return sum(of(step["stages"][name]) for step in self.steps if name in step["stages"])

    def curve(self, what):
        """One number per step. what: a field of a step, or "host:NAME" or "stage:NAME" for seconds."""
        if ":" not in what:
            return [step[what] for step in self.steps]
        kind, name = what.split(":")
        if kind == "host":
            return [step["host_ns"][name] / 1e9 for step in self.steps]
        stages = [step["stages"].get(name, {"device_ns": 0, "host_ns": 0}) for step in self.steps]
        return [(stage["device_ns"] or stage["host_ns"]) / 1e9 for stage in stages]


class Folder:
    def __init__(self, path):
        self.path = pathlib.Path(path)
        steps = {step["step"]: step for step in self._json_lines("steps.jsonl")}
        if not steps:
            raise lines.RecordError(f"{path}: has no steps.jsonl; make it with 'tandem paper -o {path}'")
        self.steps = steps
        self.failed = [name for name, step in steps.items() if step["exit"] != 0]
        self._cases = {}

    def _json_lines(self, name):
        path = self.path / name
        if not path.exists():
            return []
        with open(path) as file:
            whole = [line for line in file if line.endswith("\n")]
        try:
            return [json.loads(line) for line in whole]
        except ValueError:
            raise lines.RecordError(f"{path}: a line is not JSON; measure the step again with --again") from None

    def named(self, beginning):
        """Names of completed steps with that beginning, in their order."""
        return [name for name, step in self.steps.items() if name.startswith(beginning) and step["exit"] == 0]

    def cases(self, step):
        """MeasuredCells from the last record of each cell of a step, also of a step that did not complete. Cells of one scene, algorithm, preset and
        settings with different frames form one entry."""
        if step not in self._cases:
            self._cases[step] = self._read_cases(step)
        return list(self._cases[step])

    def _read_cases(self, step):
        path = self.path / "records" / f"{step}.jsonl"
        if not path.exists() or path.stat().st_size == 0:
            return []
        cells = {}
        for record, location in lines.each(path):
            cells[record["key"]] = (record, f"records/{path.name}:{location.rpartition(':')[2]}")
        groups = {}
        for record, location in cells.values():
            settings = {**record["settings"], **record.get("asked", {})}
            key = (record["scene"]["key"], record["algorithm"], record["preset"], record["devices"][0]["id"], tuple(sorted(settings.items())))
            groups.setdefault(key, []).append((record, location))
        cases = [MeasuredCells([r for r, _ in group], [p for _, p in group]) for group in groups.values()
                if all(r["status"] == "failed" or r["total_ns"] for r, _ in group)]
        return [case for case in cases if case.status == "ok"]

    def wrong(self):
        """Pairs (location, message) of all records that failed or are wrong."""
        found = []
        for path in sorted((self.path / "records").glob("*.jsonl")):
            for row, line in enumerate(self._json_lines(f"records/{path.name}"), 1):
                if line.get("status", "ok") != "ok":
                    found.append((f"records/{path.name}:{row}", f"{line['status']}: {line.get('failure') or 'its answer differs from the reference'}"))
        return found

    def simulation(self, step):
        """The simulation of a step; None if it has not completed."""
        if step not in self.named(step):
            return None
        return Simulation(self._json_lines(f"records/{step}.jsonl"), step, f"records/{step}.jsonl")

    def simulations(self, beginning):
        return [self.simulation(name) for name in self.named(beginning)]

    def ceilings(self):
        found = self._json_lines("records/ceilings.jsonl")
        return found[-1] if found else None
