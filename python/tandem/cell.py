# SPDX-License-Identifier: MIT
"""A record of a cell, as every reader of the package sees it. Needs only the standard library.

The fields that are columns of tables are declared in harness/, and come from fields.json."""

import dataclasses
import functools
import os
import statistics

from . import lines
from . import names as known_names
from .fields import DECLARED, at, frames_of, milliseconds, needed, text_of
from .telling import warn

# Kernels that the paper's release has too. Our refit has a launch for strips and one for tops; our balance
# has one that plans and one that moves. In the release, the host or these kernels do the work of seeds, body
# pairs and decisions.
RELEASE_KERNELS = """
    transform_vertices refit_tops traverse traverse_in_groups traverse_queues plan_balance
    generate_contacts
""".split()

# Settings that determine the candidate pairs, and their default values, which titles leave out.
BOUNDS = {
    "k": "",
    "axes": "standard",
    "precision": "float",
    "rounding": "safe",
    "placement": "rounded",
    "origin": "world",
    "margin": "0",
    "motion": "none",
    "pressure_slab": "off",
    "self": "off",
    "output": "pairs",
}


@dataclasses.dataclass(frozen=True)
class Answer:
    """The digest of pairs or contacts."""

    count: int
    a: str
    b: str


class _NotARecord(Exception):
    """A line is not a valid record; the message describes the error."""


class Cell:
    """The record of one cell. Beside the following, it has the fields of fields.json as attributes: `key`,
    `status`, `session`, `algorithm`, `scene` (its key), `commit` and others.

    record: the JSON object, of this `path` and `line`. frames: number of frames in a sample. names: texts that
    name the cell, the most significant first. settings: as recorded; asked: as they were asked for, of which a
    device may change some; described: as recorded, with the parameters of the scene. samples: their number.
    is_partial: a signal ended the cell before it had enough rounds.
    rounds: the median of each round in nanoseconds, by ascending number; with schema 2 each sample is a round.
    disturbed: those of the rounds in which the record calls the machine disturbed; reason: the first reason.
    pairs, contacts: digests; None if the record has none.

    A cell of several records (comparison/pooling.py) has `sessions` > 0: then `rounds` and `disturbed` have
    sessions instead of rounds. `all_rounds` and `disturbed_rounds` count rounds in both cases."""

    sessions = 0
    is_older = False  # another record of its key is shown as the newest

    def __init__(self, record, path="", line=0):
        """Raises RecordError with PATH:LINE, the error and what to do."""
        self.record, self.path, self.line = record, os.fspath(path), line
        try:
            self._read()
        except _NotARecord as problem:
            raise lines.RecordError(f"{self.location}: {problem}") from None
        except KeyError as problem:
            raise self.error(f"it has no {problem.args[0]}") from None
        except (TypeError, AttributeError, ValueError, ArithmeticError) as problem:
            raise self.error(problem) from None

    @property
    def location(self):
        return f"{self.path}:{self.line}"

    def error(self, problem):
        return lines.RecordError(f"{self.location}: is no record of a cell ({problem}); {lines.WHAT_TO_GIVE}")

    def _read(self):
        record, environment = self.record, self.record["environment"]
        sampling = record.get("sampling") or {}
        for field in DECLARED:
            field.check(self)
        self.frames = frames_of(record)
        self.settings, self.asked, self.described, self.names = _settings_and_names(record)
        self.scene_name = text_of(record["scene"], "name") or self.names["scene"]
        self.samples, self.rounds = _rounds(record)
        self.is_partial = sampling.get("interrupted") is True
        self.seed = sampling["seed"] if isinstance(sampling.get("seed"), int) else None
        reasons = disturbed_rounds(record)
        self.disturbed = frozenset(reasons.keys() & self.rounds.keys())
        self.reason = next(iter(reasons.values()), "")
        self.all_rounds, self.disturbed_rounds = len(self.rounds), len(self.disturbed)
        self.pairs, self.contacts = (_answer(record, name) for name in ("digest", "contact_digest"))
        self.processor, self.sources = text_of(environment, "processor"), text_of(environment, "sources")

    @property
    def schema(self):
        return self.record["schema"]

    @property
    def devices(self):
        """Ids joined by +."""
        return self.names["devices"]

    @property
    def on_gpus(self):
        devices = self.record["devices"]
        return bool(devices) and all(device.get("kind") == "gpu" for device in devices)

    @property
    def chosen(self):
        """Whether --algorithm auto chose it."""
        return self.record.get("chosen") is not None

    @property
    def program(self):
        """What identifies the program that made the record."""
        return self.commit, self.dirty, self.sources

    @property
    def run(self):
        """Equal for records of one cell in one run of the program; None if the run is unknown."""
        return (self.key, self.session, self.devices, self.chosen) if self.session else None

    def times(self):
        return list(self.rounds.values())

    @property
    def median_ms(self):
        """Milliseconds per frame: the median of rounds, or of sessions."""
        return statistics.median(self.times()) / self.frames / 1e6

    def ms(self, end="median"):
        """Milliseconds per frame of the record's summary: its median, or an end of the 95 % interval."""
        return milliseconds(at(self.record, "total_ns", end), self.frames)

    @functools.cached_property
    def samples_by_round(self):
        """The samples in nanoseconds, by the number of their round."""
        total, rounds = self.record.get("total_ns") or {}, {}
        samples = total.get("samples", [])
        for number, ns in zip(total.get("rounds", range(len(samples))), samples):
            rounds.setdefault(number, []).append(ns)
        return rounds

    @functools.cached_property
    def frame_ms(self):
        """Milliseconds of each frame, the medians over the replays; empty without times by frame."""
        replays = [replay for replay in at(self.record, "total_ns", "frames") or [] if replay is not None]
        longest = max(map(len, replays), default=0)
        return [
            statistics.median(replay[i] for replay in replays if i < len(replay)) / 1e6
            for i in range(longest)
        ]

    @functools.cached_property
    def stage_ms(self):
        """Milliseconds per frame of each stage: the device's, or the host's for stages without device time."""
        return {
            name: milliseconds(
                at(stage, "device_ns", "median") or at(stage, "host_ns", "median"), self.frames
            )
            for name, stage in (self.record.get("stages") or {}).items()
        }

    def of_stages(self, what):
        """Launches, waits or bytes of all stages and frames; None if no stages were timed."""
        stages = self.record.get("stages")
        return sum(stage.get(what, 0) for stage in stages.values()) if isinstance(stages, dict) else None

    @property
    def release_launches(self):
        """Launches of all frames as the paper's release counts them; None if the record has no times of
        kernels."""
        times = self.record.get("kernel_times")
        if not times or self.algorithm not in ("chunked", "gproximity"):
            return None
        return sum(times[name]["launches"] for name in RELEASE_KERNELS if name in times)

    def work(self, name):
        """A count for each frame, such as "candidate_pairs"; None if it was not recorded."""
        found = at(self.record, "work", name)
        return found if isinstance(found, list) else None

    def total_work(self, name):
        counts = self.work(name)
        return None if counts is None else sum(counts)

    @property
    def truth(self):
        """Errors against the exact truth; None if the record has none."""
        truth = at(self.record, "error", "truth")
        return truth if isinstance(truth, dict) else None

    @property
    def missed(self):
        """Meeting pairs that are missed; None without a truth."""
        truth = self.truth
        return truth and truth["missed_touching"] + truth["missed_overlapping"]

    @property
    def meeting(self):
        """Pairs that meet; None without a truth."""
        truth = self.truth
        return truth and truth["touching"] + truth["overlapping"] + self.missed

    def error_of_contacts(self, name, which="median"):
        """An error of contacts against the truth, such as "depth_ulps"; None if it is unknown."""
        return at(self.truth, "contacts", name, which)

    def continues(self, other):
        """Whether this record has all rounds of the other and further ones, because that one was interrupted."""
        more, less = self.samples_by_round, other.samples_by_round
        return len(more) > len(less) > 0 and all(
            more.get(number) == samples for number, samples in less.items()
        )

    def remeasures(self, earlier):
        """Whether this later record of the same key replaces one of an interrupted cell: the same program
        measured it again on the same devices."""
        is_same = (self.program, self.devices) == (earlier.program, earlier.devices)
        return earlier.is_partial and self.status != "failed" and is_same


for _field in DECLARED:
    if _field.name != "rounds":  # their number; Cell.rounds has their times
        setattr(Cell, _field.name, _field)


def _joined(devices, field):
    return "+".join(needed(device, field) for device in devices)


def _scene_parameters(key, settings):
    """Parameters of "NAME:par=value,par=value"; none if a part is not a parameter, or has the name of a setting."""
    _, colon, rest = key.partition(":")
    parameters = dict(part.partition("=")[::2] for part in rest.split(",")) if colon else {}
    if not all("=" in part for part in rest.split(",") if colon) or parameters.keys() & settings.keys():
        return {}
    return parameters


def _handling(record):
    """How flawed tetrahedra were handled, if that changes answers. Old records do not have it."""
    error = record.get("error")
    if not isinstance(error, dict) or "inputs" not in error:
        return ""
    handling = error["inputs"]["handling"]
    return "" if handling == "flat" else f"degenerate={handling}"


def _settings_and_names(record):
    """Settings as recorded, as asked for, and with the parameters of the scene; names."""
    settings = dict(record["settings"])
    if not all(isinstance(value, str) for value in settings.values()):
        raise TypeError("settings must be strings")
    devices, frames, scene = record["devices"], record["frames"], record["scene"]
    parameters = _scene_parameters(scene["key"], settings)
    names = {
        "algorithm": record["algorithm"],
        "preset": record["preset"],
        "devices": _joined(devices, "id"),
        "model": _joined(devices, "name"),
        "driver": _joined(devices, "driver"),
        "scene": known_names.scene(scene["key"]),
        "frames": f"frames {frames['first']}:{frames['last']}",
        "handling": _handling(record),
        "digest": f"digest {scene['digest']}",
    }
    asked = record.get("asked", {})
    return (
        settings,
        settings | asked if asked else settings,
        settings | parameters if parameters else settings,
        names,
    )


def _answer(record, name):
    """The answer's digest. Old records of checked answers have it in `agreement`."""
    for field in ("work", "agreement"):
        part = record.get(field)
        if isinstance(part, dict) and name in part:
            return Answer(
                needed(part[name], "count", kind="integer"), needed(part[name], "a"), needed(part[name], "b")
            )
    return None


def _rounds(record):
    """The number of samples, and the median of each round."""
    total = record.get("total_ns")
    samples = total["samples"] if total else []
    numbers = total.get("rounds") if total and record["schema"] >= 3 else range(len(samples))
    if numbers is None and samples:
        raise _NotARecord(f"total_ns has no rounds, which schema 3 requires; {lines.RECORD_AGAIN}")
    if len(numbers or ()) != len(samples):
        raise _NotARecord(
            f"total_ns has {len(samples)} samples and {len(numbers)} rounds; {lines.RECORD_AGAIN}"
        )
    rounds = {}
    for number, ns in zip(numbers or (), samples):
        rounds.setdefault(number, []).append(float(ns))
    return len(samples), {number: statistics.median(rounds[number]) for number in sorted(rounds)}


def disturbed_rounds(record):
    """{round: reason} of the disturbed rounds."""
    found = (record.get("conditions") or {}).get("disturbed") or []
    return {needed(one, "round", kind="integer"): needed(one, "why") for one in found}


def each(path, verdict=lambda line, location: None):
    """Yields the Cell of every record of a file. Calls `verdict` with each line of kind verdict and its
    FILE:LINE. Leaves out a last line without an end with a warning. Raises RecordError."""

    def check(text, location):
        record = lines.parsed(text, location)
        if not lines.is_verdict(record):
            return lines.checked_cell(record, location)
        verdict(record, location)
        return None

    for line, record in lines.numbered(path, warn, check):
        yield Cell(record, path, line)


def superseded(cells):
    """Those numbers of cells, in the order of their files, that are left out because another record has their
    result: copies, records that another record of the same key continues, and records of interrupted cells
    before a later one that the same program made on the same devices. Raises RecordError for different records
    of one cell in one run."""
    by_key, dropped = {}, set()
    for number, cell in enumerate(cells):
        by_key.setdefault(cell.key, []).append(number)
    for numbers in by_key.values():
        if len(numbers) > 1:
            dropped |= _superseded_of_key({number: cells[number] for number in numbers})
    return dropped


def _superseded_of_key(cells):
    dropped = {
        number for number, cell in cells.items() if any(other.continues(cell) for other in cells.values())
    }
    dropped |= {
        number
        for number, cell in cells.items()
        if any(later > number and other.remeasures(cell) for later, other in cells.items())
    }
    first = {}
    for number, cell in cells.items():
        if number in dropped or not cell.run:
            continue
        seen = first.setdefault(cell.run, cell)
        if seen is cell:
            continue
        if cell.record != seen.record:
            raise lines.RecordError(
                f"{seen.location} and {cell.location}: different records of one cell in one run; leave one of them out"
            )
        dropped.add(number)
    return dropped
