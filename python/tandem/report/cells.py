# SPDX-License-Identifier: MIT
"""What the page shows of a cell: its data for charts, its row of the table, and its details. Raises one of
lines.FIELD_ERRORS for a record that lacks fields of its schema."""

import os

from ..fields import at, needed
from ..pages.markup import breakable, element
from ..pages.tables import Column, Row, number_text
from ..text_lines import one_line
from .conditions import conditions_text, sampling_text
from .leads import ONE_ROUND
from .numbers import is_number, rounded
from .sentences import method_of

MAX_FRAMES, MAX_LETTERS = 512, 2000
CONTACT_ERRORS = ("depth_relative", "normal_degrees", "point", "hausdorff", "volume_relative")
COLUMNS = (
    Column("cell", style="name"),
    Column("ms per frame", True),
    Column("95 %", True),
    Column("status", has_choice=True),
    Column("method", has_choice=True),
    Column("k", True),
    Column("scene", style="wraps", has_choice=True),
    Column("frames", style="whole"),
    Column("device", style="wraps", has_choice=True),
    *(Column(name, True) for name in ("launches", "waits", "candidate pairs", "contacts")),
)
SEARCHED = (
    "algorithm",
    "failure",
    "settings",
    "scene",
    "commit",
)  # details with words that the table's filter finds


def _device(cell):
    return " + ".join(
        f"{needed(device, 'id')} ({needed(device, 'name')})" for device in cell.record["devices"]
    )


def shown_text(value):
    """A text of at most MAX_LETTERS; None if the record has none."""
    return one_line(value, MAX_LETTERS) if isinstance(value, str) and value else None


def interval(cell):
    """Milliseconds per frame: [median, low, high]; None if there are no times."""
    ends = [cell.ms(end) for end in ("median", "low", "high")]
    return None if ends[0] is None else [None if ms is None else rounded(ms) for ms in ends]


def _error(cell):
    """Errors of the answer against the exact truth; None if the record has none."""
    if cell.truth is None:
        return None
    share = lambda part, whole: rounded(part / whole) if whole > 0 else None
    candidates, false = (needed(cell.truth, name, kind="integer") for name in ("candidates", "false"))
    error = {
        "missed": cell.missed,
        "missed_share": share(cell.missed, cell.meeting),
        "false_share": share(false, candidates),
    }
    medians = {name: cell.error_of_contacts(name) for name in CONTACT_ERRORS}
    return error | {name: rounded(median) for name, median in medians.items() if is_number(median)}


def commit(cell):
    return f"{cell.commit or 'unknown'}{', with changes' if cell.dirty else ''}"


def charted(cell, label):
    """The data of a cell for charts."""
    made = {
        "label": label,
        "ms": interval(cell),
        "rounds": len(cell.rounds),
        "first": cell.first_frame,
        "stages": {name: rounded(ms) for name, ms in cell.stage_ms.items() if ms is not None},
        "curve": [rounded(ms) for ms in cell.frame_ms[:MAX_FRAMES]] if len(cell.frame_ms) > 1 else None,
    }
    error = _error(cell)
    if error is None or made["ms"] is None or cell.status != "ok" or cell.is_older:
        return made
    k = cell.described.get("k")
    names = [cell.described.get(name) for name in ("contact_rule", "decision", "rounding", "precision")]
    return made | {
        "error": error,
        "where": f"{cell.names['scene']}, on {_device(cell)}",
        "names": [method_of(cell), k and f"k={k}", *names],
    }


def _half_interval(cell, time):
    if time is None:
        return ""
    if len(cell.rounds) < 2 or None in time:
        return ONE_ROUND
    return f"±\u00a0{number_text(float(f'{(time[2] - time[1]) / 2:.2g}'))}"


def time_text(cell):
    time = interval(cell)
    if time is None:
        return None
    low, high = map(number_text, time[1:])
    ends = f"[{low}, {high}]" if len(cell.rounds) > 1 else f"({ONE_ROUND})"
    samples, rounds = f"{cell.samples} sample", f"{len(cell.rounds)} round"
    return (
        f"{number_text(time[0])} ms per frame {ends}, {samples}{'s' * (cell.samples != 1)} in "
        f"{rounds}{'s' * (len(cell.rounds) != 1)}"
    )


def _stages_text(cell):
    def ms(stage, which):
        ns = at(stage, which, "median")
        return number_text(ns / cell.frames / 1e6) if is_number(ns) else ""

    stages = sorted((cell.record.get("stages") or {}).items())
    return ", ".join(f"{name} {ms(one, 'device_ns')} (host {ms(one, 'host_ns')})" for name, one in stages)


def details(cell, against):
    """All data of a cell as Html."""
    rounds = ", ".join(number_text(ns / cell.frames / 1e6) for ns in cell.times())
    errors = (_error(cell) or {}).items()
    facts = {
        "algorithm": f"{cell.algorithm} {cell.preset}",
        "driver": cell.names["driver"],
        "failure": shown_text(cell.failure),
        "time": time_text(cell),
        "comparison": against,
        "conditions": conditions_text(cell.record),
        "sampling": sampling_text(cell.record),
        "rounds": rounds and f"{rounds} ms per frame",
        "stages": _stages_text(cell),
        "settings": " ".join(f"{name}={value}" for name, value in sorted(cell.described.items())),
        "errors": ", ".join(f"{name.replace('_', ' ')} {number_text(value)}" for name, value in errors),
        "scene": f"{cell.scene}: {number_text(cell.bodies)} bodies, {number_text(cell.tetrahedra)} tetrahedra",
        "commit": commit(cell),
        "date": shown_text(cell.date),
        "command": shown_text(cell.record.get("command")),
        "record": f"{os.path.basename(cell.path)}, line {cell.line}",
    }
    return element(
        "dl",
        [
            [element("dt", name), element("dd", value, class_="words" if name in SEARCHED else None)]
            for name, value in facts.items()
            if value
        ],
    )


def row(cell, label, against=None):
    """The row of a cell, with its details. against: its comparison with another file."""
    time, pairs = interval(cell), map(cell.total_work, ("candidate_pairs", "contacts"))
    status = cell.status + (", recorded again" if cell.is_older else "")
    return Row(
        more=details(cell, against),
        values=[
            element("details", element("summary", label)),
            time and time[0],
            _half_interval(cell, time),
            status if cell.status == "ok" else element("span", status, class_="bad"),
            method_of(cell),
            cell.described.get("k"),
            element("span", breakable(cell.names["scene"]), title=cell.scene),
            f"{cell.first_frame}:{cell.last_frame}",
            _device(cell),
            *map(number_text, (cell.of_stages("launches"), cell.of_stages("waits"), *pairs)),
        ],
    )
