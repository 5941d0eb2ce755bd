# SPDX-License-Identifier: MIT
"""What the page shows of a cell. Raises one of lines.FIELD_ERRORS for a record that lacks fields of its
schema."""

from ..fields import at
from ..text_lines import one_line
from .conditions import conditions_text, sampling_text
from .numbers import count, is_number, number, rounded, text

MAX_FRAMES, MAX_LETTERS = 512, 2000
CONTACT_ERRORS = ("depth_relative", "normal_degrees", "point", "hausdorff", "volume_relative")


def _device(cell):
    return " + ".join(f"{text(device['id'])} ({text(device['name'])})" for device in cell.record["devices"])


def shown_text(value):
    """A text of at most MAX_LETTERS; None if the record has none."""
    return one_line(value, MAX_LETTERS) if isinstance(value, str) and value else None


def interval(cell):
    """Milliseconds per frame: [median, low, high]; None if there are no times."""
    if not is_number(at(cell.record, "total_ns", "median")):
        return None
    ends = (
        cell.ms(end) if is_number(at(cell.record, "total_ns", end)) else None
        for end in ("median", "low", "high")
    )
    return [None if ms is None else rounded(ms) for ms in ends]


def _stages(cell):
    """{stage: [device ms, host ms, launches, waits]} with times per frame."""

    def ms(stage, which):
        ns = at(stage, which, "median")
        return rounded(ns / cell.frames / 1e6) if is_number(ns) else None

    stages = cell.record.get("stages") or {}
    return {
        name: [
            *(ms(stages[name], which) for which in ("device_ns", "host_ns")),
            *(count(stages[name].get(what, 0)) for what in ("launches", "waits")),
        ]
        for name in sorted(stages)
    }


def _sum(counts):
    return None if counts is None else sum(map(number, counts))


def _error(cell):
    """Errors of the answer against the exact truth; None if the record has none."""
    if cell.truth is None:
        return None
    missed, meeting = count(cell.missed), count(cell.meeting)
    candidates, false = number(cell.truth["candidates"]), number(cell.truth["false"])
    error = {
        "missed": missed,
        "missed_share": rounded(missed / meeting) if meeting > 0 else None,
        "false_share": rounded(false / candidates) if candidates > 0 else None,
    }
    medians = {name: cell.error_of_contacts(name) for name in CONTACT_ERRORS}
    return error | {name: rounded(median) for name, median in medians.items() if is_number(median)}


def commit(cell):
    return f"{cell.commit or 'unknown'}{', with changes' if cell.dirty else ''}"


# The columns of a row: whether their values repeat between cells, in which case the page has each value once, and
# the value. A row has the number of its file before its line, and ends with the label of the cell in its group.
COLUMNS = {
    "algorithm": (True, lambda cell: cell.algorithm),
    "preset": (True, lambda cell: cell.preset),
    "device": (True, _device),
    "driver": (True, lambda cell: cell.names["driver"]),
    "scene": (True, lambda cell: cell.scene),
    "frames": (True, lambda cell: f"{count(cell.first_frame)}:{count(cell.last_frame)}"),
    "status": (True, lambda cell: cell.status),
    "failure": (True, lambda cell: shown_text(cell.failure)),
    "settings": (True, lambda cell: dict(sorted(cell.described.items()))),
    "ms": (False, interval),
    "rounds": (False, lambda cell: len(cell.rounds)),
    "samples": (False, lambda cell: cell.samples),
    "stages": (False, _stages),
    "launches": (False, lambda cell: cell.of_stages("launches")),
    "waits": (False, lambda cell: cell.of_stages("waits")),
    "pairs": (False, lambda cell: _sum(cell.work("candidate_pairs"))),
    "contacts": (False, lambda cell: _sum(cell.work("contacts"))),
    "error": (False, _error),
    "conditions": (True, lambda cell: conditions_text(cell.record)),
    "sampling": (True, lambda cell: sampling_text(cell.record)),
    "commit": (True, commit),
    "date": (False, lambda cell: shown_text(cell.date)),
    "command": (True, lambda cell: shown_text(cell.record.get("command"))),
    "file": (False, None),
    "line": (False, lambda cell: cell.line),
    "bodies": (False, lambda cell: cell.bodies),
    "tetrahedra": (False, lambda cell: cell.tetrahedra),
    "label": (False, None),
}


def row(cell, file):
    """The values of COLUMNS without the label. `file`: the number of its file."""
    return [file if name == "file" else make(cell) for name, (_, make) in COLUMNS.items() if name != "label"]


def curve(cell):
    """Milliseconds of each frame; None for a single frame."""
    return [rounded(ms) for ms in cell.frame_ms[:MAX_FRAMES]] if len(cell.frame_ms) > 1 else None


def rounds(cell):
    """Milliseconds per frame of each round."""
    return [rounded(ns / cell.frames / 1e6) for ns in cell.times()]
