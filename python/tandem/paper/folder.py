# SPDX-License-Identifier: MIT
"""Reads a folder of 'tandem paper': steps, cells, simulations, and the paper's own tables."""

import csv
import json
import lzma
import os
import pathlib

from .. import lines
from ..cell import disturbed_rounds, each
from .quantities import NotMeasured, batches_of, frame_range
from .simulation import Simulation, composed

SCENES = ("funnel", "glasses", "colosseum", "plates", "tower")
STEPS_OF_TABLES = 102  # frames 20 to 121 of the paper's Tables 4 and 5
STEPS_OF_PAPER = 500  # of its simulations
PAPERS_SOLVER = "solver-"  # beginning of the names of simulations with the settings of the paper's solver


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


class Case:
    """The Cells of one scene, algorithm, preset and settings, over one or several ranges of frames, with sums
    over their frames. Times are seconds: medians of the replays, on the device, or on the host for stages
    without device time."""

    def __init__(self, cells, folder):
        self.cells, first = cells, cells[0]
        self.locations = [f"{os.path.relpath(cell.path, folder)}:{cell.line}" for cell in cells]
        self.scene, self.algorithm, self.preset = first.scene_name, first.algorithm, first.preset
        self.settings, self.device = first.settings, first.record["devices"][0]
        self.frames = sum(cell.frames for cell in cells)
        self.first, self.last = (
            min(cell.first_frame for cell in cells),
            max(cell.last_frame for cell in cells),
        )
        self.scale = STEPS_OF_TABLES / self.frames

    def total(self, which="median"):
        return sum(cell.record["total_ns"][which] for cell in self.cells) / 1e9

    def breakdown(self):
        """Seconds of whole frames in the replays that time every command, of which the stages are parts."""
        return sum(cell.record["breakdown_ns"]["median"] for cell in self.cells) / 1e9

    @property
    def rounds(self):
        """Number of rounds of each frame, the least of all."""
        return min(len(cell.rounds) for cell in self.cells)

    def _stages(self, name):
        return [cell.record["stages"][name] for cell in self.cells if name in cell.record["stages"]]

    def stage(self, name, where=None):
        """Seconds of a stage. where: device_ns or host_ns; default: the device's time, or else the host's."""

        def of(stage):
            device, host = stage["device_ns"]["median"], stage["host_ns"]["median"]
            return (device or host if where is None else stage[where]["median"]) / 1e9

        return sum(map(of, self._stages(name)))

    def sum(self, where):
        """Launches, waits or bytes of all stages."""
        return sum(cell.of_stages(where) for cell in self.cells)

    @property
    def release_launches(self):
        """Launches counted as in the paper's release; None if the records have no times of kernels."""
        counts = [cell.release_launches for cell in self.cells if cell.release_launches is not None]
        return sum(counts) if counts else None

    @property
    def batches(self):
        """Number of batches of gProximity in all frames; None if a batch has all body pairs or their number
        is unknown."""
        found = [batches_of(cell, frame_range(cell)) for cell in self.cells]
        return sum(found) if all(found) else None

    def per_frame(self, name, where="device_ns"):
        """Pairs (frame, seconds) of all frames."""
        rows = []
        for cell in self.cells:
            column = cell.record["stages"].get(name, {}).get(where, {})
            rows += [(cell.first_frame + i, ns / 1e9) for i, ns in enumerate(column.get("frames", []))]
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

    def stored(self, name):
        """Path of a file of the folder, which may be compressed: then it is NAME.xz. None without it."""
        paths = (self.path / name, self.path / f"{name}.xz")
        return next((path for path in paths if path.exists()), None)

    def text_lines(self, name):
        """Lines of a file of the folder, an incomplete last one left out; [] without the file."""
        path = self.stored(name)
        if path is None:
            return []
        try:
            with (lzma.open if path.suffix == ".xz" else open)(path, "rt") as file:
                return [line for line in file if line.endswith("\n")]
        except (lzma.LZMAError, EOFError):
            raise lines.RecordError(f"{path}: is not a whole file of xz; compress it again") from None

    def _json_lines(self, name):
        text = self.text_lines(name)
        try:
            return [json.loads(line) for line in text]
        except ValueError:
            raise lines.RecordError(
                f"{self.stored(name)}: a line is not JSON; measure the step again with --again"
            ) from None

    def named(self, beginning):
        """Names of completed steps with that beginning, in their order."""
        return [name for name, step in self.steps.items() if name.startswith(beginning) and step["exit"] == 0]

    def cases(self, step):
        """Cases from the last record of each cell of a step, also of a step that did not complete.
        Cells of one scene, algorithm, preset and settings with different frames form one entry."""
        if step not in self._cases:
            self._cases[step] = self._read_cases(step)
        return list(self._cases[step])

    def _read_cases(self, step):
        path = self.path / "records" / f"{step}.jsonl"
        if not path.exists() or path.stat().st_size == 0:
            return []
        cells, groups = {cell.key: cell for cell in each(path)}, {}
        for cell in cells.values():
            settings = tuple(sorted(cell.asked.items()))
            key = (cell.scene, cell.algorithm, cell.preset, cell.record["devices"][0]["id"], settings)
            groups.setdefault(key, []).append(cell)
        return [
            Case(group, self.path)
            for group in groups.values()
            if all(cell.status == "ok" and cell.record["total_ns"] for cell in group)
        ]

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
            measured = [
                line
                for line in self._json_lines(f"records/{path.name}")
                if line.get("conditions") and line.get("total_ns")
            ]
            count = sum(len(disturbed_rounds(line)) for line in measured)
            if count:
                found.append((path.stem, count, sum(line["sampling"]["rounds"] for line in measured)))
        return found

    def composition(self, run, step):
        """A simulation with the published data path, composed of `run` and of a step with its frames; None
        without one of them. Raises NotMeasured if they have other contacts."""
        cells = [
            case for case in self.cases(step) if (case.algorithm, case.preset) == ("chunked", "published")
        ]
        return composed(run, cells[0]) if run and cells else None

    def simulation(self, step):
        """The simulation of a step, or "composed-SCENE"; None if it has not completed, or if its records are
        gone."""
        if step.startswith("composed-"):
            scene = step.removeprefix("composed-")
            return self.composition(self.simulation(f"{PAPERS_SOLVER}{scene}"), f"steps-{scene}")
        if step not in self.named(step):
            return None
        place = f"records/{step}.jsonl"
        lines_of_file = self._json_lines(place)
        has_run = any(line["kind"] == "run" for line in lines_of_file)
        stored = self.stored(place)
        return Simulation(lines_of_file, step, f"records/{stored.name}") if has_run else None

    def profiles(self, step):
        """(line, record) of the profiles of a step."""
        numbered = enumerate(self._json_lines(f"records/{step}.jsonl"), 1)
        return [(line, record) for line, record in numbered if record["status"] == "ok"]

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
                self.composition_or_none(self.simulation(f"{PAPERS_SOLVER}{scene}"), f"steps-{scene}")
                for scene in SCENES
            )
            if run
        ]

    def ceilings(self):
        found = self._json_lines("records/ceilings.jsonl")
        return found[-1] if found else None
