# SPDX-License-Identifier: MIT
"""Reads a folder of 'tandem paper': steps, cells, simulations, and the paper's own tables."""

import csv
import json
import pathlib

from .. import lines
from .quantities import NotMeasured, batches_of, disturbed_rounds, frame_range, release_launches, rounds_of
from .simulation import Simulation, composed

SCENES = ("funnel", "glasses", "colosseum", "plates", "tower")
STEPS_OF_TABLES = 102  # frames 20 to 121 of the paper's Tables 4 and 5
STEPS_OF_PAPER = 500  # of its simulations


def paper_table(number):
    """Rows of results/paper/tableN.csv as texts. The file is part of the package."""
    for folder in (
        pathlib.Path(__file__).parent / "data",
        pathlib.Path(__file__).parents[3] / "results" / "paper",
    ):
        path = folder / f"table{number}.csv"
        if path.exists():
            with open(path, newline="") as file:
                return list(csv.DictReader(file))
    raise lines.RecordError(
        f"table{number}.csv of the paper is not part of this installation; install the package again"
    )


def number(text):
    """A number of a table of the paper; None for an empty field."""
    return float(text) if text else None


class MeasuredCells:
    """The cells of one scene, algorithm, preset and settings, over one or several ranges of frames, with sums
    over their frames. Times are seconds: medians of the replays, on the device, or on the host for stages
    without device time."""

    def __init__(self, records, locations):
        self.records, self.locations = records, locations
        first = records[0]
        self.scene, self.algorithm, self.preset, self.settings = (
            first["scene"]["name"],
            first["algorithm"],
            first["preset"],
            first["settings"],
        )
        self.device = first["devices"][0]
        self.frames = sum(r["frames"]["last"] - r["frames"]["first"] + 1 for r in records)
        self.first, self.last = (
            min(r["frames"]["first"] for r in records),
            max(r["frames"]["last"] for r in records),
        )
        self.status = next((r["status"] for r in records if r["status"] != "ok"), "ok")
        self.scale = STEPS_OF_TABLES / self.frames

    def total(self, which="median"):
        return sum(r["total_ns"][which] for r in self.records) / 1e9

    def breakdown(self):
        """Seconds of whole frames in the replays that time every command, of which the stages are parts."""
        return sum(r["breakdown_ns"]["median"] for r in self.records) / 1e9

    @property
    def rounds(self):
        """Number of rounds of each frame, the least of all."""
        return min(len(rounds_of(r)) for r in self.records)

    def stage(self, name, where=None):
        """Sum of a stage. where: device_ns, host_ns, launches, waits or bytes; default: the device's time, or
        else the host's."""

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
        return (
            sum(r["host_work"][name]["host_ns"]["median"] for r in self.records if name in r["host_work"])
            / 1e9
        )

    @property
    def release_launches(self):
        """Launches counted as in the paper's release; None if the records have no times of kernels."""
        counts = [count for count in map(release_launches, self.records) if count is not None]
        return sum(counts) if counts else None

    @property
    def batches(self):
        """Number of batches of gProximity in all frames; None if a batch has all body pairs or their number
        is unknown."""
        found = [batches_of(r, frame_range(r)) for r in self.records]
        return sum(found) if all(found) else None

    def per_frame(self, name, where="device_ns"):
        """Pairs (frame, seconds) of all frames."""
        rows = []
        for r in self.records:
            column = r["stages"].get(name, {}).get(where, {})
            rows += [(r["frames"]["first"] + i, ns / 1e9) for i, ns in enumerate(column.get("frames", []))]
        return sorted(rows)


class Folder:
    def __init__(self, path):
        self.path = pathlib.Path(path)
        steps = {step["step"]: step for step in self._json_lines("steps.jsonl")}
        if not steps:
            raise lines.RecordError(f"{path}: has no steps.jsonl; make it with 'tandem paper -o {path}'")
        self.steps, self.size = steps, next(iter(steps.values()))["size"]
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
            raise lines.RecordError(
                f"{path}: a line is not JSON; measure the step again with --again"
            ) from None

    def named(self, beginning):
        """Names of completed steps with that beginning, in their order."""
        return [name for name, step in self.steps.items() if name.startswith(beginning) and step["exit"] == 0]

    def cases(self, step):
        """MeasuredCells from the last record of each cell of a step, also of a step that did not complete.
        Cells of one scene, algorithm, preset and settings with different frames form one entry."""
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
            key = (
                record["scene"]["key"],
                record["algorithm"],
                record["preset"],
                record["devices"][0]["id"],
                tuple(sorted(settings.items())),
            )
            groups.setdefault(key, []).append((record, location))
        cases = [
            MeasuredCells([r for r, _ in group], [p for _, p in group])
            for group in groups.values()
            if all(r["status"] == "failed" or r["total_ns"] for r, _ in group)
        ]
        return [case for case in cases if case.status == "ok"]

    def wrong(self):
        """Pairs (location, message) of all records that failed or are wrong."""
        found = []
        for path in sorted((self.path / "records").glob("*.jsonl")):
            for row, line in enumerate(self._json_lines(f"records/{path.name}"), 1):
                if line.get("status", "ok") != "ok":
                    found.append(
                        (
                            f"records/{path.name}:{row}",
                            f"{line['status']}: {line.get('failure') or 'its answer differs from the reference'}",
                        )
                    )
        return found

    def disturbed(self):
        """(step, number of disturbed rounds, number of rounds) of the steps with disturbed rounds."""
        found = []
        for path in sorted((self.path / "records").glob("*.jsonl")):
            records = [
                line
                for line in self._json_lines(f"records/{path.name}")
                if line.get("conditions") and line.get("total_ns")
            ]
            count = sum(len(disturbed_rounds(record)) for record in records)
            if count:
                found.append((path.stem, count, sum(len(rounds_of(record)) for record in records)))
        return found

    def composition(self, run, step):
        """A simulation with the published data path, composed of `run` and of a step with its frames; None
        without one of them. Raises NotMeasured if they have other contacts."""
        cells = [
            case for case in self.cases(step) if (case.algorithm, case.preset) == ("chunked", "published")
        ]
        return composed(run, cells[0]) if run and cells else None

    def simulation(self, step):
        """The simulation of a step, or "composed-SCENE"; None if it has not completed, or if its records are gone."""
        if step.startswith("composed-"):
            scene = step.removeprefix("composed-")
            return self.composition(self.simulation(f"sim-{scene}"), f"steps-{scene}")
        if step not in self.named(step):
            return None
        lines_of_file = self._json_lines(f"records/{step}.jsonl")
        has_run = any(line["kind"] == "run" for line in lines_of_file)
        return Simulation(lines_of_file, step, f"records/{step}.jsonl") if has_run else None

    def simulations(self, beginning):
        return [run for run in map(self.simulation, self.named(beginning)) if run]

    def composition_or_none(self, run, step):
        """The same, and None if they have other contacts."""
        try:
            return self.composition(run, step)
        except NotMeasured:
            return None

    def compositions(self):
        """The simulations of all scenes that can be composed."""
        return [
            run
            for run in (
                self.composition_or_none(self.simulation(f"sim-{scene}"), f"steps-{scene}")
                for scene in SCENES
            )
            if run
        ]

    def ceilings(self):
        found = self._json_lines("records/ceilings.jsonl")
        return found[-1] if found else None
