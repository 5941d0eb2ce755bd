# SPDX-License-Identifier: MIT
"""tandem's side: the program, with one scene of all poses."""

import dataclasses
import json

import numpy

from boxes.program import output
from hydroelastic.polygons import Polygons

OPTIONS = ("--algorithm", "tiled", "--truth", "none", "--no-check", "--no-count", "--quiet")


@dataclasses.dataclass(frozen=True)
class Cell:
    """What runs where. threads: of device host; 0: one per core."""

    precision: str
    device: str = "host"
    threads: int = 1

    @property
    def options(self):
        settings = {
            "contact_rule": "pressure",
            "pressure_slab": "on",
            "precision": self.precision,
            "threads": self.threads,
        }
        words = (("--set", f"{name}={value}") for name, value in settings.items())
        return ["--device", self.device, *(word for pair in words for word in pair)]


class Program:
    """The program at a path, for bodies A and B. Scenes, dumps and records are written into a folder.
    `files`: the meshes, in that folder. `poses`: (frames, 2, 7)."""

    def __init__(self, path, folder, files, modulus, poses):
        self._path, self._folder, self._modulus, self._frames = path, folder, modulus, len(poses)
        bodies = [{"mesh": name, "poses": rows.tolist()} for name, rows in zip("AB", poses.swapaxes(0, 1))]
        meshes = {name: {"file": file.name} for name, file in zip("AB", files)}
        scene = {"meshes": meshes, "bodies": bodies, "frames": len(poses)}
        (folder / "scene.json").write_text(json.dumps(scene), encoding="ascii")

    def _run(self, cell, *options):
        output(
            self._path,
            "run",
            self._folder / "scene.json",
            "--frames",
            f"0:{self._frames - 1}",
            "--pressure",
            self._modulus,
            *cell.options,
            *OPTIONS,
            *options,
        )

    def polygons(self, precision):
        """Polygons of each frame."""
        rows = self._folder / "rows.csv"
        self._run(Cell(precision), "--repeat", "1", "--dump-contacts", rows)
        table = numpy.loadtxt(rows, delimiter=",", skiprows=1, ndmin=2).reshape(-1, 13)
        parts = (table[table[:, 0] == frame] for frame in range(self._frames))
        return [
            Polygons(part[:, [2, 4]].astype("i8"), part[:, 5:8], part[:, 8:11], part[:, 11], part[:, 12])
            for part in parts
        ]

    def seconds(self, cell):
        """Seconds of each frame, of the third replay of all: caches are warm, as in a loop of Drake's."""
        records = self._folder / "records.jsonl"
        self._run(cell, "--repeat", "3", "--out", records)
        record = json.loads(records.read_text(encoding="utf-8").splitlines()[-1])
        records.unlink()
        return [1e-9 * nanoseconds for nanoseconds in record["total_ns"]["frames"][-1]]
