# SPDX-License-Identifier: MIT
"""Makes one row of a record of a cell, for 'tandem export --csv' and for Records.cells. Needs only the
standard library.

Columns that are fields of a record come from their declarations in harness/, by fields.json. The others are
computed here."""

import json
import pathlib

_FIELDS = json.loads((pathlib.Path(__file__).parent / "fields.json").read_text(encoding="utf-8"))["columns"]
_PATHS = {field["column"]: tuple(field["path"]) for field in _FIELDS}
TYPES = {
    field["column"]: field["type"] for field in _FIELDS
}  # integer, number, boolean or text; of the columns that are fields
_ORDER = (
    "status",
    "failure",
    "algorithm",
    "preset",
    "device",
    "device_name",
    "driver",
    "scene",
    "scene_digest",
    "bodies",
    "tetrahedra",
    "first_frame",
    "last_frame",
    "ms",
    "ms_low",
    "ms_high",
    "samples",
    "rounds",
    "converged",
    "disturbed",
    "device_span_ms",
    "launches",
    "waits",
    "candidate_pairs",
    "contacts",
    "missing",
    "extra",
    "contact_frames_wrong",
    "pairs_missed",
    "rounding_lost",
    "rounding_extra",
    "rounding_depth_change",
    "flattened",
    "device_bytes",
    "commit",
    "dirty",
    "date",
    "session",
    "key",
)
FIRST_COLUMNS = (*_ORDER, *(name for name in _PATHS if name not in _ORDER))
GROUPS = ("stage_", "count_", "set_")  # prefixes of further columns
TIMES = ("ms", "ms_low", "ms_high", "device_span_ms")


def columns(rows):
    """Columns of every table, then those of each group that occur in the rows, sorted by name."""
    return [
        *FIRST_COLUMNS,
        *(
            name
            for group in GROUPS
            for name in sorted({name for row in rows for name in row if name.startswith(group)})
        ),
    ]


def is_time(column):
    """Whether a column has milliseconds per frame."""
    return column in TIMES or column.startswith("stage_")


def at(record, *path):
    """The value at a path of names; None if a name of the path is missing."""
    for name in path:
        if not isinstance(record, dict):
            return None
        record = record.get(name)
    return record


def frames_of(record):
    """The number of frames in a sample of a record."""
    return record["frames"]["last"] - record["frames"]["first"] + 1


def milliseconds(ns, frames):
    """Milliseconds per frame from nanoseconds of all frames; None for None."""
    return None if ns is None else ns / frames / 1e6


def interval(name, times, frames):
    """Three columns of milliseconds per frame from a summary of nanoseconds: its median and its 95 % interval."""
    ends = {name: "median", f"{name}_low": "low", f"{name}_high": "high"}
    return {column: milliseconds(at(times, end), frames) for column, end in ends.items()}


def _of_devices(record, field):
    return "+".join(str(device[field]) for device in record["devices"])


def _total(numbers):
    return sum(numbers) if isinstance(numbers, list) else None


def row(record):
    """Values by column; None for missing fields. Launches, waits, pairs, contacts and counters are sums over
    all frames. Raises one of lines.FIELD_ERRORS if the record does not match its schema."""
    made = {name: at(record, *path) for name, path in _PATHS.items()}
    made |= {
        "device": _of_devices(record, "id"),
        "device_name": _of_devices(record, "name"),
        "driver": _of_devices(record, "driver"),
    }
    made |= _times(record) | _stages(record) | _answer(record)
    return made | {f"set_{name}": value for name, value in (record.get("settings") or {}).items()}


def _times(record):
    frames, samples = frames_of(record), at(record, "total_ns", "samples")
    disturbed = at(record, "conditions", "disturbed")
    made = interval("ms", record.get("total_ns"), frames)
    made["samples"] = None if samples is None else len(samples)
    made["disturbed"] = bool(disturbed) if isinstance(disturbed, list) else None
    made["device_span_ms"] = milliseconds(at(record, "device_span_ns", "median"), frames)
    return made


def _stages(record):
    """Times of stages on the device, or on the host for stages without device time; launches and waits of all
    stages."""
    frames, stages, made = frames_of(record), record.get("stages"), {}
    if not isinstance(stages, dict):
        return made
    for name, stage in stages.items():
        on_device = at(stage, "device_ns", "median")
        made[f"stage_{name}_ms"] = milliseconds(on_device or at(stage, "host_ns", "median"), frames)
    return made | {
        name: sum(stage.get(name, 0) for stage in stages.values()) for name in ("launches", "waits")
    }


def _answer(record):
    made = {name: _total(at(record, "work", name)) for name in ("candidate_pairs", "contacts")}
    truth = at(record, "error", "truth")
    if isinstance(truth, dict):
        made["pairs_missed"] = truth["missed_touching"] + truth["missed_overlapping"]
    return made | {f"count_{name}": value for name, value in (at(record, "work", "counters") or {}).items()}
