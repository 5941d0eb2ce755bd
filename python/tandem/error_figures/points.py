# SPDX-License-Identifier: MIT
"""Finished cells with errors against the truth, and what the figures show of them."""

import re

from .. import kinds, lines
from ..cell import Cell
from ..names import method
from ..varying import varying

SIZES = {"float": 2.0**-24, "double": 2.0**-53}
OF_CONTACTS = ("decision", "contact_rule")


def kind(cell):
    """The kind of a cell's scene."""
    if cell.scene.startswith("hard"):
        return "constructed"
    return "random" if cell.scene_name == "pile" else "resting"


def device(cell):
    return "+".join(f"{device['name']} {device['id'].split(':')[0]}" for device in cell.record["devices"])


def label(cell):
    return method(cell.algorithm, cell.preset)


def ends(cell):
    """The ends of the interval of the time; the time itself for records without one."""
    return [cell.ms() if cell.ms(end) is None else cell.ms(end) for end in ("low", "high")]


def family(cell):
    """The family of a hard scene, or None."""
    found = re.match(r"hard:([^:,]+)", cell.scene)
    return found and found.group(1)


def difficulty(cell):
    found = re.search(r"difficulty=([^,]+)", cell.scene)
    return float(found.group(1)) if found else None


def depth(cell):
    """The error of depths, over the size of the scene."""
    ulps = cell.error_of_contacts("depth_ulps", "p99")
    return None if ulps is None else ulps * SIZES[cell.asked["precision"]]


def normal(cell):
    return cell.error_of_contacts("normal_degrees", "p99")


def row(cell):
    """The row of a cell in the data of a figure."""
    return {
        "scene": cell.scene,
        "kind": kind(cell),
        "device": device(cell),
        "cell": label(cell),
        **cell.asked,
        "ms": cell.ms(),
        "meeting": cell.meeting,
        "missed": cell.missed,
        "candidates": cell.truth["candidates"],
        "false": cell.truth["false"],
        "ratio": cell.truth["candidate_ratio"],
        "depth_p99_of_L": depth(cell),
        "normal_p99_degrees": normal(cell),
        "volume_p99_relative": cell.error_of_contacts("volume_relative", "p99"),
    }


def read(files, torn):
    """Reads Cells, and counts cells with a truth that are left out. Raises RecordError, also if there is none
    to draw."""
    points, left_out = [], 0
    for file in files:
        for location, kind_of_record, record in kinds.each(file, torn):
            with kinds.fields_of(kind_of_record, location):
                if kind_of_record != "cell" or not (record["error"] or {}).get("truth"):
                    continue
                if record["status"] == "ok" and "median" in (record["total_ns"] or {}):
                    points.append(Cell(record, *location.rsplit(":", 1)))
                    row(points[-1])  # raises an error for a record that lacks fields
                else:
                    left_out += 1
    if not points:
        raise lines.RecordError("no record has errors against the truth; make some with 'tandem accuracy'")
    return points, left_out


def swept(points, without=()):
    """{name: values} of cells, devices, and settings of one algorithm and preset that have several values."""
    distinct = {(tuple(p.asked.items()), label(p), device(p)): p for p in points}.values()
    families = (
        pair
        for p in distinct
        for pair in ((None, (("cell", label(p)), ("device", device(p)))), (label(p), p.asked.items()))
    )
    found = {}
    for (_, name), own in varying(families).items():
        if name not in without:
            found.setdefault(name, {}).update(own)
    return {name: sorted(own, key=lambda value: (len(value), value)) for name, own in found.items()}


def words(point, names):
    """Values of the given names of a point, as text."""
    own = {"cell": label(point), "device": device(point)}
    return " ".join(
        own[name] if name in own else f"{name}={point.asked[name]}"
        for name in names
        if name in own or name in point.asked
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
