# SPDX-License-Identifier: MIT
"""Reads those fields of records of cells that are compared. results/record.schema.json describes the
fields."""

import dataclasses
import os
import statistics

from .. import lines
from ..lines import RECORD_AGAIN
from .pooling import counting, pooled

NAMES_OF = {str: "string", int: "number", bool: "truth value"}


@dataclasses.dataclass(frozen=True)
class Answer:
    """The digest of pairs or contacts."""

    count: int
    a: str
    b: str


@dataclasses.dataclass
class RecordedCell:
    """A record of one cell. `frames`: number of frames in a sample. `names`: texts that name the cell, the
    most significant first. `settings`: includes the parameters of its scene. `rounds`: the median of each
    round in nanoseconds, by ascending number; with schema 2 each sample is a round. `pairs` and `contacts`
    are None if the record has no digest. `sources`: the digest of the program's sources. `disturbed`: those
    of the rounds in which the record calls the machine disturbed; `reason`: the first reason. Unknown texts
    are empty.

    A cell of several records (pooling.py) has `sessions` > 0: then `rounds` and `disturbed` have sessions
    instead of rounds. `all_rounds` and `disturbed_rounds` count rounds in both cases."""

    line: int
    schema: int
    key: str
    status: str
    failure: str
    names: dict
    settings: dict
    frames: int
    on_gpus: bool
    session: str
    seed: int | None
    samples: int
    rounds: dict
    pairs: Answer | None
    contacts: Answer | None
    commit: str
    processor: str
    dirty: bool
    chosen: bool = False  # by --algorithm auto
    sources: str = ""
    disturbed: frozenset = frozenset()
    reason: str = ""
    sessions: int = 0
    all_rounds: int = 0
    disturbed_rounds: int = 0
    is_partial: bool = False  # a signal ended it before it had enough rounds

    def times(self):
        return list(self.rounds.values())

    @property
    def program(self):
        """What identifies the program that made the record, as lines.program_of()."""
        return self.commit, self.dirty, self.sources


@dataclasses.dataclass
class RecordedCells:
    """The records of one file, or of one commit in it. `commit`: the full commit, if one was given. `cells`:
    one for each key with records that are ok, in the order of the keys' first lines. `left_out`: records that
    failed, are wrong or have no samples. `repeated`: number of keys of which some records that are ok do not
    count. `torn`: the last line has no end and is ignored. `pooled`: number of keys of which several sessions
    count. `is_program`: `path` is that of a program, which turns.py measured."""

    path: str
    commit: str
    cells: list
    left_out: list
    commits: list
    records: int
    repeated: int
    torn: bool
    pooled: int = 0
    is_program: bool = False


class _NotARecord(Exception):
    """A line is not a valid record; the message describes the error."""


def _text(part, name):
    value = part.get(name)
    if value is not None and not isinstance(value, str):
        raise TypeError(f"{name} must be a string")
    return value or ""


def _needed(part, name, kind=str):
    """A required field of this type."""
    value = part[name]
    if not isinstance(value, kind) or isinstance(value, bool) is not (kind is bool):
        raise TypeError(f"{name} must be a {NAMES_OF[kind]}")
    return value


def _joined(devices, field):
    return "+".join(_needed(device, field) for device in devices)


def _split_scene(key, settings):
    """Splits "NAME:par=value,par=value" into the scene's name and its parameters. The name is the whole key
    if a part is not a parameter, or has the name of a setting."""
    name, colon, rest = key.partition(":")
    parameters = dict(part.partition("=")[::2] for part in rest.split(",")) if colon else {}
    if not all("=" in part for part in rest.split(",") if colon) or parameters.keys() & settings.keys():
        return key, {}
    return name, parameters


def _handling(record):
    """How flawed tetrahedra were handled, if that changes answers. Old records do not have it."""
    error = record.get("error")
    if not isinstance(error, dict) or "inputs" not in error:
        return ""
    handling = error["inputs"]["handling"]
    return "" if handling == "flat" else f"degenerate={handling}"


def _names(record):
    settings = dict(record["settings"])
    if not all(isinstance(value, str) for value in settings.values()):
        raise TypeError("settings must be strings")
    devices, frames, scene = record["devices"], record["frames"], record["scene"]
    scene_name, parameters = _split_scene(_needed(scene, "key"), settings)
    span = f"frames {_needed(frames, 'first', int)}:{_needed(frames, 'last', int)}"
    names = {
        "algorithm": _needed(record, "algorithm"),
        "preset": _needed(record, "preset"),
        "devices": _joined(devices, "id"),
        "model": _joined(devices, "name"),
        "driver": _joined(devices, "driver"),
        "scene": scene_name,
        "frames": span,
        "handling": _handling(record),
        "digest": f"digest {_needed(scene, 'digest')}",
    }
    return names, settings | parameters


def _answer(record, name):
    """The answer's digest. Old records of checked answers have it in `agreement`."""
    for field in ("work", "agreement"):
        part = record.get(field)
        if isinstance(part, dict) and name in part:
            return Answer(
                _needed(part[name], "count", int), _needed(part[name], "a"), _needed(part[name], "b")
            )
    return None


def _rounds(record):
    """The number of samples, and the median of each round."""
    total = record.get("total_ns")
    samples = total["samples"] if total else []
    numbers = total.get("rounds") if total and record["schema"] >= 3 else range(len(samples))
    if numbers is None and samples:
        raise _NotARecord(f"total_ns has no rounds, which schema 3 requires; {RECORD_AGAIN}")
    if len(numbers or ()) != len(samples):
        raise _NotARecord(f"total_ns has {len(samples)} samples and {len(numbers)} rounds; {RECORD_AGAIN}")
    rounds = {}
    for number, ns in zip(numbers or (), samples):
        rounds.setdefault(number, []).append(float(ns))
    return len(samples), {number: statistics.median(rounds[number]) for number in sorted(rounds)}


def _disturbed(record, rounds):
    """The disturbed ones of these rounds, and the first reason."""
    found = (record.get("conditions") or {}).get("disturbed") or []
    reasons = {_needed(one, "round", int): _needed(one, "why") for one in found}
    return frozenset(reasons.keys() & rounds.keys()), next(iter(reasons.values()), "")


def _cell(record, line):
    names, settings = _names(record)
    samples, rounds = _rounds(record)
    disturbed, reason = _disturbed(record, rounds)
    devices, frames, environment = record["devices"], record["frames"], record["environment"]
    seed = (record.get("sampling") or {}).get("seed")
    return RecordedCell(
        line=line,
        schema=record["schema"],
        key=_needed(record, "key"),
        status=_needed(record, "status"),
        failure=_text(record, "failure"),
        names=names,
        settings=settings,
        frames=frames["last"] - frames["first"] + 1,
        on_gpus=bool(devices) and all(device["kind"] == "gpu" for device in devices),
        session=_text(record, "session"),
        seed=seed if isinstance(seed, int) else None,
        samples=samples,
        rounds=rounds,
        pairs=_answer(record, "digest"),
        contacts=_answer(record, "contact_digest"),
        commit=_text(environment, "commit"),
        processor=_text(environment, "processor"),
        dirty=_needed(environment, "dirty", bool),
        chosen=record.get("chosen") is not None,
        sources=_text(environment, "sources"),
        disturbed=disturbed,
        reason=reason,
        all_rounds=len(rounds),
        disturbed_rounds=len(disturbed),
        is_partial=lines.is_partial(record),
    )


def recorded_cell(record, path, line):
    """The cell of the record in a line. Raises RecordError with PATH:LINE, the error and what to do."""
    try:
        return _cell(record, line)
    except _NotARecord as problem:
        raise lines.RecordError(f"{path}:{line}: {problem}") from None
    except KeyError as problem:
        raise lines.RecordError(
            f"{path}:{line}: is no record of a cell (it has no {problem.args[0]}); {lines.WHAT_TO_GIVE}"
        ) from None
    except (TypeError, AttributeError, ValueError) as problem:
        raise lines.RecordError(
            f"{path}:{line}: is no record of a cell ({problem}); {lines.WHAT_TO_GIVE}"
        ) from None


def _split_commit(file, commit):
    """Splits PATH@COMMIT into path and commit. If a file with the whole name exists, the name is the path."""
    name = os.fspath(file)
    path, at, behind = name.rpartition("@")
    if not at or os.path.exists(name):
        return name, commit
    if not behind:
        raise lines.RecordError(f"{name}: no such file, and no commit behind the @; give FILE@COMMIT")
    if commit:
        raise lines.RecordError(
            f"{name}: the option names another commit, {commit}; name one commit, behind the @ or by the option"
        )
    return path, behind


def _commits(cells):
    return list(dict.fromkeys(cell.commit for cell in cells))


def _whole_commit(path, start, cells):
    """The only commit that begins with `start`."""
    commits = _commits(cells)
    found = [commit for commit in commits if commit.startswith(start)]
    if not found:
        raise lines.RecordError(f"{path}: no record of commit {start}; there are {', '.join(commits)}")
    if len(found) > 1:
        raise lines.RecordError(f"{path}: commit {start} may be {' or '.join(found)}; give more digits")
    return found[0]


def read_cells(file, commit=""):
    """Reads RecordedCells of a file, given as PATH or PATH@COMMIT. `commit`, or the text behind the @, is the
    beginning of the commit whose records count; without it all records count. Raises RecordError."""
    path, start = _split_commit(file, commit)
    torn = []
    records = [recorded_cell(record, path, line) for line, record in lines.numbered(path, torn.append)]
    if not records:
        raise lines.RecordError(
            f"{path}: {'its only line has no end' if torn else 'has no record of a cell'}; name a file of records"
        )
    if start:
        start = _whole_commit(path, start, records)
        records = [cell for cell in records if cell.commit == start]
    by_key, left_out = {}, []
    for cell in records:
        if cell.status != "ok" or not cell.rounds:
            left_out.append(cell)
        else:
            by_key.setdefault(cell.key, []).append(cell)
    counted = {key: counting(found) for key, found in by_key.items()}
    kept = [pooled(found) if len(found) > 1 else found[0] for found in counted.values()]
    repeated = sum(len(counted[key]) < len(found) for key, found in by_key.items())
    return RecordedCells(
        path,
        start,
        kept,
        left_out,
        _commits(kept),
        len(records),
        repeated,
        bool(torn),
        sum(len(found) > 1 for found in counted.values()),
    )
