# SPDX-License-Identifier: MIT
"""Short texts on the state of the machine while a cell was sampled, and on the quality of its samples."""

import json

from .numbers import is_number


def _numbers(value):
    """Yields a number, or the numbers of a list. Skips None, which stands for missing readings."""
    if isinstance(value, list):
        for one in value:
            yield from _numbers(one)
    elif is_number(value):
        yield value


def _range(before, after, field, unit=""):
    """ "1980 MHz" or "41 to 52 °C", from the readings before and after the rounds; empty if there are none."""
    found = [
        value
        for reading in (before, after)
        if isinstance(reading, dict)
        for value in _numbers(reading.get(field))
    ]
    if not found:
        return ""
    low, high = f"{min(found):.4g}", f"{max(found):.4g}"
    return f"{low}{'' if low == high else f' to {high}'}{unit}"


def _gpu_texts(before, after):
    clocks = _range(before, after, "sm_mhz", " MHz")
    processes = _range(before, after, "other_processes")
    return [
        clocks and f"GPU at {clocks}",
        _range(before, after, "temperature_c", " °C"),
        _range(before, after, "power_w", " W"),
        processes and processes != "0" and f"other processes on it: {processes}",
    ]


def _processor_texts(before, after):
    clocks, busy = _range(before, after, "mhz", " MHz"), _range(before, after, "other_cores")
    return [clocks and f"processor at {clocks}", busy and f"cores used by other processes: {busy}"]


def conditions_text(record):
    """State of the machine during sampling. Raises KeyError and TypeError for a record that lacks fields of
    its schema."""
    conditions = record.get("conditions")
    if not isinstance(conditions, dict):
        return "not recorded"
    before, after = conditions["before"], conditions["after"]
    parts = [part for gpus in zip(before["gpus"], after["gpus"]) for part in _gpu_texts(*gpus)]
    parts += _processor_texts(before["processor"], after["processor"])
    disturbed = conditions["disturbed"]
    if disturbed:
        parts.append(
            f"{len(disturbed)} doubtful {'round' if len(disturbed) == 1 else 'rounds'}, the first: {disturbed[0]['why']}"
        )
    return ", ".join(part for part in parts if part)


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
    return ", ".join(part for part in parts if part) or "no problems"
