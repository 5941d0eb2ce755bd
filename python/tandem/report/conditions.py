# SPDX-License-Identifier: MIT
"""Short texts on the state of the machine while a cell was sampled, and on the quality of its samples."""

import json

from .numbers import is_number

GPU = {
    "sm_mhz": "GPU at {} MHz",
    "temperature_c": "{} °C",
    "power_w": "{} W",
    "other_processes": "other processes on it: {}",
}
PROCESSOR = {"mhz": "processor at {} MHz", "other_cores": "cores used by other processes: {}"}
NOT_SAID = {"other_processes": "0"}


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


def conditions_text(record):
    """State of the machine during sampling. Raises KeyError and TypeError for a record that lacks fields of
    its schema."""
    conditions = record.get("conditions")
    if not isinstance(conditions, dict):
        return "not recorded"
    moments = conditions["before"], conditions["after"]
    parts = [text for gpus in zip(*(moment["gpus"] for moment in moments)) for text in _texts(gpus, GPU)]
    parts += _texts([moment["processor"] for moment in moments], PROCESSOR)
    if disturbed := conditions["disturbed"]:
        rounds = f"{len(disturbed)} doubtful {'round' if len(disturbed) == 1 else 'rounds'}"
        parts.append(f"{rounds}, the first: {disturbed[0]['why']}")
    return ", ".join(parts)


def sampling_text(record):
    sampling = record.get("sampling")
    if not isinstance(sampling, dict):
        return "not recorded"
    outliers, drift = sampling.get("outliers"), sampling.get("drift")
    parts = [
        sampling.get("converged") is False and "interval wider than requested",
        sampling.get("interrupted") is True and "interrupted before it had enough samples",
        is_number(outliers) and outliers != 0 and f"outliers: {json.dumps(outliers)}",
        is_number(drift) and f"drifted by {100 * drift:.2g} %",
    ]
    return ", ".join(filter(None, parts)) or "no problems"
