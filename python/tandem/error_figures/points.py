# SPDX-License-Identifier: MIT
"""Finished cells with errors against the truth, as data of the figures, and the settings in which they
differ."""

import re

from .. import cell_rows, kinds, lines
from ..varying import varying

SIZES = {"float": 2.0**-24, "double": 2.0**-53}
OF_CONTACTS = ("decision", "contact_rule")


class Point:
    """A finished cell: those values of its record that the figures use."""

    _unique_settings = {}

    def __init__(self, record):
        settings = {**record["settings"], **record.get("asked", {})}
        # Equal settings are stored once, because they need most of the memory for long files.
        self.settings = self._unique_settings.setdefault(tuple(sorted(settings.items())), settings)
        self.scene = record["scene"]["key"]
        self.kind = (
            "constructed"
            if self.scene.startswith("hard")
            else "random"
            if record["scene"]["name"] == "pile"
            else "resting"
        )
        self.device = "+".join(
            f"{device['name']} {device['id'].split(':')[0]}" for device in record["devices"]
        )
        self.label = f"{record['algorithm']} {record['preset']}"
        frames, total = cell_rows.frames_of(record), record["total_ns"]
        self.ms = total["median"] / 1e6 / frames
        self.low, self.high = (total.get(name, total["median"]) / 1e6 / frames for name in ("low", "high"))
        self._read_errors(record["error"]["truth"])
        found = re.match(r"hard:([^:,]+)", self.scene)
        self.family = found.group(1) if found else None
        found = re.search(r"difficulty=([^,]+)", self.scene)
        self.difficulty = float(found.group(1)) if found else None

    def _read_errors(self, truth):
        self.missed = truth["missed_touching"] + truth["missed_overlapping"]
        self.meeting = truth["touching"] + truth["overlapping"] + self.missed
        self.candidates, self.false = truth["candidates"], truth["false"]
        self.ratio = truth["candidate_ratio"]
        contacts = truth["contacts"] or {}
        self.depth, self.normal, self.volume = (
            (contacts.get(name) or {}).get("p99")
            for name in ("depth_ulps", "normal_degrees", "volume_relative")
        )
        if self.depth is not None:
            self.depth *= SIZES[self.settings["precision"]]

    def row(self):
        """The row of this point in the data of a figure."""
        return {
            "scene": self.scene,
            "kind": self.kind,
            "device": self.device,
            "cell": self.label,
            **self.settings,
            "ms": self.ms,
            "meeting": self.meeting,
            "missed": self.missed,
            "candidates": self.candidates,
            "false": self.false,
            "ratio": self.ratio,
            "depth_p99_of_L": self.depth,
            "normal_p99_degrees": self.normal,
            "volume_p99_relative": self.volume,
        }


def read(files, torn):
    """Reads Points, and counts cells with a truth that are left out. Raises RecordError, also if there is no
    point."""
    points, left_out = [], 0
    for file in files:
        for location, kind, record in kinds.each(file, torn):
            with kinds.fields_of(kind, location):
                if kind != "cell" or not (record["error"] or {}).get("truth"):
                    continue
                if record["status"] == "ok" and "median" in (record["total_ns"] or {}):
                    points.append(Point(record))
                else:
                    left_out += 1
    if not points:
        raise lines.RecordError("no record has errors against the truth; make some with 'tandem accuracy'")
    return points, left_out


def swept(points, without=()):
    """{name: values} of cells, devices, and settings of one algorithm and preset that have several values."""
    distinct = {(id(p.settings), p.label, p.device): p for p in points}.values()
    families = (
        pair
        for p in distinct
        for pair in ((None, (("cell", p.label), ("device", p.device))), (p.label, p.settings.items()))
    )
    found = {}
    for (_, name), own in varying(families).items():
        if name not in without:
            found.setdefault(name, {}).update(own)
    return {name: sorted(own, key=lambda value: (len(value), value)) for name, own in found.items()}


def words(point, names):
    """Values of the given names of a point, as text."""
    own = {"cell": point.label, "device": point.device}
    return " ".join(
        own[name] if name in own else f"{name}={point.settings[name]}"
        for name in names
        if name in own or name in point.settings
    )


def short_words(point, names):
    """As words(), but only numbers have the names of their settings."""
    return " ".join(
        word if word.split("=")[-1][:1].isdigit() else word.split("=")[-1]
        for word in words(point, names).split()
    )


def sweep_text(names):
    """The values of each name as text; the first and the last one if there are many."""
    return "; ".join(
        f"{name} {', '.join(values) if len(values) < 8 else f'{values[0]} to {values[-1]} ({len(values)} values)'}"
        for name, values in names.items()
    )
