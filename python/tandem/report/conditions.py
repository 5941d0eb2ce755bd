# SPDX-License-Identifier: MIT
"""Short texts on the state of the machine while cells were sampled, and on the quality of their samples."""

import json

from ..pages.frame import Section
from ..pages.markup import paragraphs
from ..pages.tables import Column, table
from .numbers import ends_text, is_number

GPU = {
    "sm_mhz": "GPU at {} MHz",
    "temperature_c": "{} °C",
    "power_w": "{} W",
    "other_processes": "other processes on it: {}",
}
PROCESSOR = {"mhz": "processor at {} MHz", "other_cores": "cores used by other processes: {}"}
NOT_SAID = {"other_processes": "0"}
COLUMNS = (
    *map(Column, ("device", "driver", "commit")),
    Column("date", style="whole"),
    Column("cells", True),
    *map(Column, ("rounds", "conditions", "doubts")),
)
NOT_RECORDED = "not recorded"
MAX_ROWS = 40


def _numbers(value):
    """The numbers of a value or a list, without None, which stands for missing readings."""
    if isinstance(value, list):
        return [number for one in value for number in _numbers(one)]
    return [value] if is_number(value) else []


def _texts(readings, texts):
    """Yields each text with the range of its field, such as "41 to 52 °C", in the readings that have it."""
    readings = [reading for reading in readings if isinstance(reading, dict)]
    for field, text in texts.items():
        found = [number for reading in readings for number in _numbers(reading.get(field))]
        ends = list(dict.fromkeys(f"{end(found):.4g}" for end in (min, max) if found))
        if ends and ends != [NOT_SAID.get(field)]:
            yield text.format(" to ".join(ends))


def _readings(records):
    """What was read before and after the cells of these records on equal devices: texts."""
    moments = [record["conditions"][when] for record in records for when in ("before", "after")]
    parts = [text for gpus in zip(*(moment["gpus"] for moment in moments)) for text in _texts(gpus, GPU)]
    return parts + [*_texts([moment["processor"] for moment in moments], PROCESSOR)]


def _with_conditions(records):
    return [record for record in records if isinstance(record.get("conditions"), dict)]


def conditions_text(record):
    """State of the machine during sampling. Raises KeyError and TypeError for a record that lacks fields of
    its schema."""
    if not _with_conditions([record]):
        return NOT_RECORDED
    parts = _readings([record])
    if disturbed := record["conditions"]["disturbed"]:
        rounds = f"{len(disturbed)} doubtful {'round' if len(disturbed) == 1 else 'rounds'}"
        parts.append(f"{rounds}, the first: {disturbed[0]['why']}")
    return ", ".join(parts)


def sampling_text(record):
    sampling = record.get("sampling")
    if not isinstance(sampling, dict):
        return NOT_RECORDED
    outliers, drift = sampling.get("outliers"), sampling.get("drift")
    parts = [
        sampling.get("converged") is False and "interval wider than requested",
        sampling.get("interrupted") is True and "interrupted before it had enough samples",
        is_number(outliers) and outliers != 0 and f"outliers: {json.dumps(outliers)}",
        is_number(drift) and f"drifted by {100 * drift:.2g} %",
    ]
    return ", ".join(filter(None, parts)) or "no problems"


def _doubts(cells):
    """What makes the times of cells doubtful: disturbed rounds, and samples that are too few."""
    rounds, disturbed = (
        sum(getattr(cell, name) for cell in cells) for name in ("all_rounds", "disturbed_rounds")
    )
    reason = next((cell.reason for cell in cells if cell.reason), "")
    found = [f"{disturbed} of {rounds} rounds disturbed ({reason})"] if disturbed else []
    for name, value, text in (
        ("converged", False, "with an interval wider than requested"),
        ("interrupted", True, "interrupted before enough samples"),
    ):
        count = sum((cell.record.get("sampling") or {}).get(name) is value for cell in cells)
        found += [f"{count} {'cell' if count == 1 else 'cells'} {text}"] if count else []
    return "; ".join(found) or "none"


def _row(names, cells):
    known = _with_conditions([cell.record for cell in cells])
    rounds = sorted(cell.all_rounds for cell in cells)
    dates = sorted(filter(None, (cell.date[:10] for cell in cells)))
    return [
        *names,
        ends_text(dates) if dates else "",
        len(cells),
        ends_text([*map(str, rounds)]),
        ", ".join(_readings(known)) if known else NOT_RECORDED,
        _doubts(cells),
    ]


def _commit(cell):
    return f"{cell.commit[:12] or 'unknown'}{', with changes' if cell.dirty else ''}"


def conditions(cells, cautions):
    """The Section: a row for each device, driver and commit. `cautions`: sentences above it."""
    groups = {}
    for cell in cells:
        device = f"{cell.names['model']} ({cell.names['devices']})"
        groups.setdefault((device, cell.names["driver"], _commit(cell)), []).append(cell)
    rows = [_row(names, own) for names, own in [*groups.items()][:MAX_ROWS]]
    left = len(groups) - len(rows)
    notes = [f"{left} more devices or commits are left out."] if left > 0 else []
    shown = table(
        "Devices and their state while cells were measured", COLUMNS, rows, heading=False, notes=notes
    )
    return Section("conditions", "Conditions", [paragraphs(cautions), shown])
