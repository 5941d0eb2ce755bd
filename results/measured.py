# SPDX-License-Identifier: MIT
"""Cells of committed records, for the scripts beside pages that write their tables."""

import functools
import json
import lzma
import pathlib
import statistics
import sys

RESULTS = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(RESULTS.parent / "python"))
from tandem import cell, names
from tandem.resampling import Ratio, median_interval, paired_ratio


def records(path):
    """The records of cells of a file, which may be packed (.xz)."""
    text = (lzma.open(path, "rt") if path.suffix == ".xz" else path.open()).read()
    found = map(json.loads, text.splitlines())
    return [record for record in found if record.get("kind") != "verdict"]


def agrees(record):
    """Whether the cell's answer is equal to the reference's."""
    wrong = [record["agreement"][name] for name in ("missing", "extra", "contact_frames_wrong")]
    return record["status"] == "ok" and wrong == [0, 0, 0]


class Cell(cell.Cell):
    """A cell with milliseconds per frame by round (`total`), and times of stages, from replays that time every
    command."""

    @functools.cached_property
    def total(self):
        return {number: ns / self.frames / 1e6 for number, ns in self.rounds.items()}

    def stage_us(self, names):
        """Microseconds of the device per frame in these stages."""
        stages = self.record["stages"]
        return (
            sum(stages[name]["device_ns"]["median"] for name in names if name in stages) / self.frames / 1e3
        )

    @property
    def launches(self):
        """Per frame."""
        return sum(stage["launches"] for stage in self.record["stages"].values()) / self.frames

    @property
    def origin(self):
        devices = " and ".join(sorted({device["name"] for device in self.record["devices"]}))
        return f"{devices}, commit {self.commit[:7]} of {self.date[:10]}"


def scene_name(scene):
    """How pages name a scene: by its text in a plan, which may be a file, or by its key in a record."""
    return names.scene(pathlib.Path(scene).stem if scene.endswith(".frames") else scene)


def paired(cell, base):
    """The Ratio of the times of a cell to those of `base`, over their common rounds."""
    common = [number for number in cell.total if number in base.total]
    return paired_ratio([base.total[number] for number in common], [cell.total[number] for number in common])


def inverse(ratio):
    return Ratio(1 / ratio.value, 1 / ratio.high, 1 / ratio.low, ratio.log_error)


def text(value):
    return f"{value:.3g}" if value < 100 else f"{value:,.0f}"


def with_interval(ratio):
    """ "1.38 [1.37, 1.40]"."""
    return f"{text(ratio.value)} [{text(ratio.low)}, {text(ratio.high)}]"


def with_width(values):
    """The median with half the width of its interval: "0.348 ± 0.002"."""
    values = list(values)
    low, high = median_interval(values)
    half, middle = (high - low) / 2, statistics.median(values)
    digits = max(0, min(5, 2 - len(str(int(middle))) + 1 if half == 0 else -int(f"{half:e}".split("e")[1])))
    return f"{middle:,.{digits}f} ± {half:.{digits}f}"


def ends(values):
    """ "1.42 to 8.35"; one number if both are written alike."""
    return " to ".join(dict.fromkeys(map(text, (min(values), max(values)))))
