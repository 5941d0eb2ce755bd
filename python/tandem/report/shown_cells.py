# SPDX-License-Identifier: MIT
"""Data of the record of a cell for the page."""

import dataclasses
import statistics

from .. import lines
from ..cell_rows import at
from ..comparison.cells import RecordedCell, recorded_cell
from ..text_lines import one_line
from .conditions import conditions_text, sampling_text
from .numbers import count, is_number, number, rounded, text

# The columns of ShownCell.row, and whether their values repeat between cells: the page has each repeated
# value once.
FIELDS = {
    "algorithm": True,
    "preset": True,
    "device": True,
    "driver": True,
    "scene": True,
    "frames": True,
    "status": True,
    "failure": True,
    "settings": True,
    "ms": False,
    "rounds": False,
    "samples": False,
    "stages": False,
    "launches": False,
    "waits": False,
    "pairs": False,
    "contacts": False,
    "error": False,
    "conditions": True,
    "sampling": True,
    "commit": True,
    "date": False,
    "command": True,
    "file": False,
    "line": False,
    "bodies": False,
    "tetrahedra": False,
    "label": False,
}
STAGES = list(FIELDS).index("stages")
MAX_FRAMES, MAX_LETTERS = 512, 2000
CONTACT_ERRORS = ("depth_relative", "normal_degrees", "point", "hausdorff", "volume_relative")


@dataclasses.dataclass
class ShownCell:
    """scene, scene_name, scene_digest: the scene's key, name and digest. frames: number of frames in a
    sample. is_older: another record of its key is shown as the newest. row: values by FIELDS without the
    label, which is added later. curve: ms of each frame; rounds: ms per frame of each round; None if there
    are none. samples: by round. run: identifies the run, as of lines.run_of."""

    recorded: RecordedCell
    scene: str
    scene_name: str
    scene_digest: str
    frames: int = 1
    is_older: bool = False
    row: list = dataclasses.field(default_factory=list)
    curve: list | None = None
    rounds: list | None = None
    samples: dict = dataclasses.field(default_factory=dict)
    run: tuple | None = None

    @property
    def stages(self):
        """Milliseconds a frame of the stages that take time: the device's, or the host's for stages without
        device time."""
        times = {name: device or host for name, (device, host, *_) in self.row[STAGES].items()}
        return {name: ms for name, ms in times.items() if ms}

    def continues(self, other):
        """Whether this record has all rounds of the other and further ones, because that one was interrupted."""
        return lines.continues(self.samples, other.samples)

    def replaces(self, earlier):
        """Whether only this one of two records of a key is shown: it continues the earlier one, or measures
        the interrupted cell again."""
        own, old = self.recorded, earlier.recorded
        is_same = (own.program, own.names["devices"]) == (old.program, old.names["devices"])
        return self.continues(earlier) or (old.is_partial and own.status != "failed" and is_same)

    def is_copy_of(self, other):
        return (
            bool(self.run)
            and self.run == other.run
            and self.samples == other.samples
            and self.recorded.status == other.recorded.status
        )


def _ms(ns, frames):
    """Milliseconds per frame from nanoseconds of a replay."""
    return rounded(ns / frames / 1e6) if is_number(ns) else None


def _time(summary, frames):
    """[median, low, high] of a summary; None if there are no times."""
    if not is_number(at(summary, "median")):
        return None
    return [_ms(at(summary, name), frames) for name in ("median", "low", "high")]


def _shown_text(value):
    """A text of at most MAX_LETTERS; None if the record has none."""
    return one_line(value, MAX_LETTERS) if isinstance(value, str) else None


def _sum(counts):
    return sum(map(number, counts)) if isinstance(counts, list) else None


def _stages(record, frames):
    """{stage: [device ms, host ms, launches, waits]} with times per frame."""
    stages = record.get("stages") or {}
    return {
        name: [
            _ms(at(stages[name], "device_ns", "median"), frames),
            _ms(at(stages[name], "host_ns", "median"), frames),
            *(count(stages[name].get(what, 0)) for what in ("launches", "waits")),
        ]
        for name in sorted(stages)
    }


def _counts(stages):
    """Launches and waits of a replay; None if no stages were timed."""
    return [sum(stage[column] for stage in stages.values()) if stages else None for column in (2, 3)]


def _error(record):
    """Errors of the answer against the exact truth; None if the record has none."""
    truth = at(record, "error", "truth")
    if not isinstance(truth, dict):
        return None
    missed = count(truth["missed_touching"]) + count(truth["missed_overlapping"])
    meeting = missed + count(truth["touching"]) + count(truth["overlapping"])
    candidates, false = number(truth["candidates"]), number(truth["false"])
    error = {
        "missed": missed,
        "missed_share": rounded(missed / meeting) if meeting > 0 else None,
        "false_share": rounded(false / candidates) if candidates > 0 else None,
    }
    medians = {name: at(truth, "contacts", name, "median") for name in CONTACT_ERRORS}
    return error | {name: rounded(median) for name, median in medians.items() if is_number(median)}


def _curve(replays):
    """The median over the replays, by frame; None for a single frame."""
    if not isinstance(replays, list) or not replays or len(replays[0] or ()) < 2:
        return None
    replays = [replay for replay in replays if replay is not None]
    frames = range(min(len(replays[0]), MAX_FRAMES))
    return [
        rounded(statistics.median([replay[frame] for replay in replays if frame < len(replay)]) / 1e6)
        for frame in frames
    ]


def _device(record):
    return " + ".join(f"{text(device['id'])} ({text(device['name'])})" for device in record["devices"])


def _row(record, read, source, frames, scene):
    """The columns of FIELDS without the label. `source`: numbers of file and line."""
    stages = _stages(record, frames)
    commit = f"{read.commit or 'unknown'}{', with changes' if read.dirty else ''}"
    first, last = record["frames"]["first"], record["frames"]["last"]
    return [
        read.names["algorithm"],
        read.names["preset"],
        _device(record),
        read.names["driver"],
        scene,
        f"{first}:{last}",
        read.status,
        _shown_text(record.get("failure")),
        dict(sorted(read.settings.items())),
        _time(record.get("total_ns"), frames),
        len(read.rounds),
        read.samples,
        stages,
        *_counts(stages),
        _sum(at(record, "work", "candidate_pairs")),
        _sum(at(record, "work", "contacts")),
        _error(record),
        conditions_text(record),
        sampling_text(record),
        commit,
        _shown_text(at(record, "environment", "date")),
        _shown_text(record.get("command")),
        *source,
        at(record, "scene", "bodies"),
        at(record, "scene", "tetrahedra"),
    ]


def _check_types(read):
    """Raises TypeError for names and digests of a wrong type."""
    for value in (read.key, read.status, read.session, *read.names.values()):
        text(value)
    for answer in (read.pairs, read.contacts):
        if answer is not None:
            count(answer.count), text(answer.a), text(answer.b)


def shown_cell(record, path, line, file):
    """The ShownCell of the record in a line. `file`: number of its file. Raises RecordError, or one of
    lines.FIELD_ERRORS for a record that lacks fields of its schema."""
    read = recorded_cell(lines.checked_cell(record, f"{path}:{line}"), path, line)
    _check_types(read)
    first, last = count(record["frames"]["first"]), count(record["frames"]["last"])
    frames, scene = last - min(first, last) + 1, text(record["scene"]["key"])
    row = _row(record, read, (file, line), frames, scene)
    return ShownCell(
        read,
        scene,
        text(record["scene"]["name"]),
        text(record["scene"]["digest"]),
        frames,
        False,
        row,
        _curve(at(record, "total_ns", "frames")),
        [rounded(ns / frames / 1e6) for ns in read.times()],
        lines.samples_by_round(record),
        lines.run_of(record),
    )
