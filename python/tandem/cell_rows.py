# SPDX-License-Identifier: MIT
"""Makes one row of a cell, for 'tandem export --csv' and for Records.cells. Needs only the
standard library.

Columns that are fields of a record come from their declarations in harness/, by fields.py. The others are
computed here."""

from .fields import DECLARED, at, milliseconds

TYPES = {field.name: field.kind for field in DECLARED}  # of the columns that are fields
_ORDER = """
    status failure algorithm preset device device_name driver scene scene_digest bodies tetrahedra
    first_frame last_frame ms ms_low ms_high samples rounds converged disturbed device_span_ms launches
    waits candidate_pairs contacts missing extra contact_frames_wrong pairs_missed rounding_lost
    rounding_extra rounding_depth_change flattened device_bytes commit dirty date session key
""".split()
FIRST_COLUMNS = (*_ORDER, *(name for name in TYPES if name not in _ORDER))
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


def interval(name, times, frames):
    """Three columns of milliseconds per frame from a summary of nanoseconds: its median and its 95 % interval."""
    ends = {name: "median", f"{name}_low": "low", f"{name}_high": "high"}
    return {column: milliseconds(at(times, end), frames) for column, end in ends.items()}


def row(cell):
    """Values by column; None for missing fields. Launches, waits, pairs, contacts and counters are sums over
    all frames. Raises one of lines.FIELD_ERRORS if the record does not match its schema."""
    made = {field.name: at(cell.record, *field.path) for field in DECLARED}
    made |= {"device": cell.devices, "device_name": cell.names["model"], "driver": cell.names["driver"]}
    made |= _times(cell) | _answer(cell)
    made |= {f"stage_{name}_ms": ms for name, ms in cell.stage_ms.items()}
    return made | {f"set_{name}": value for name, value in cell.settings.items()}


def _times(cell):
    disturbed = at(cell.record, "conditions", "disturbed")
    made = interval("ms", cell.record.get("total_ns"), cell.frames)
    made["samples"] = None if at(cell.record, "total_ns", "samples") is None else cell.samples
    made["disturbed"] = bool(disturbed) if isinstance(disturbed, list) else None
    made["device_span_ms"] = milliseconds(at(cell.record, "device_span_ns", "median"), cell.frames)
    return made | {name: cell.of_stages(name) for name in ("launches", "waits")}


def _answer(cell):
    made = {name: cell.total_work(name) for name in ("candidate_pairs", "contacts")}
    counters = at(cell.record, "work", "counters") or {}
    return made | {"pairs_missed": cell.missed} | {f"count_{name}": n for name, n in counters.items()}
