# SPDX-License-Identifier: MIT
"""Files of records as frames."""
import dataclasses
import os
import statistics

import pandas

from . import lines

FIRST_COLUMNS = (
    "status", "failure", "algorithm", "preset", "device", "device_name", "driver", "scene", "scene_digest", "bodies", "tetrahedra",
    "first_frame", "last_frame", "ms", "ms_low", "ms_high", "samples", "rounds", "converged", "disturbed", "device_span_ms",
    "launches", "waits", "candidate_pairs", "contacts", "missing", "extra", "contact_frames_wrong", "pairs_missed",
    "device_bytes", "commit", "dirty", "date", "session", "key")  # those of tandem export --csv
WHOLE = ("bodies", "tetrahedra", "first_frame", "last_frame", "samples", "rounds", "launches", "waits", "candidate_pairs",
         "contacts", "missing", "extra", "contact_frames_wrong", "pairs_missed", "device_bytes")
TIMES = ("ms", "ms_low", "ms_high", "device_span_ms")
TRUTHS = ("converged", "disturbed", "dirty", "partial")
PARTS = ("samples", "stages", "kernels", "frames", "errors")  # beside cells
SPREADS = ("median", "p99", "max")
WORDS = ("status", "algorithm", "preset", "device", "device_name", "driver", "scene")


@dataclasses.dataclass(frozen=True)
class Records:
    """Frames of the same records; column `cell` of the others is the index of `cells`. Times are milliseconds; launches, waits,
    bytes, pairs and contacts of a cell are sums over its frames.

    cells: a row a record, of any status, in the order of the files: the columns of `tandem export --csv`, then `file`, and `partial`:
        the cell was interrupted before it had enough samples.
        `ms` is the median of a frame with its 95 % interval `ms_low` to `ms_high`; `stage_NAME_ms` of a stage on the device, on
        the host where it has no time there; `count_NAME` a counter of work; `set_NAME` a setting.
    samples: a row a replay: cell, sample, round, ms a frame. Rounds are what is independent, samples of one are not.
    stages: a row a stage: cell, stage, device_ms and host_ms a frame with intervals, launches, waits, bytes.
    kernels: a row a kernel: cell, kernel, device_ms a frame with its interval, launches, registers, local_bytes, spill_bytes.
        A kernel that was compiled in several ways has the largest of each.
    frames: a row a frame: cell, frame, ms (its median over replays), body_pairs, candidate_pairs, contacts.
    errors: a row an error against the exact truth of a cell that was held against it: cell, error, median, p99, max; of shares of
        pairs (false_share of candidates, missed_share of pairs that meet) the median is the share.
    """
    cells: pandas.DataFrame
    samples: pandas.DataFrame
    stages: pandas.DataFrame
    kernels: pandas.DataFrame
    frames: pandas.DataFrame
    errors: pandas.DataFrame

    def of(self, cells):
        """The records of some cells alone: an index of `cells` or a mask of it. Numbers of cells stay as they are."""
        chosen = self.cells.loc[cells]
        return Records(chosen, *(table[table["cell"].isin(chosen.index)] for table in (getattr(self, name) for name in PARTS)))


def _at(record, *path):
    for name in path:
        if not isinstance(record, dict):
            return None
        record = record.get(name)
    return record


def _of_devices(record, field):
    return "+".join(str(device[field]) for device in record["devices"])


def _total(numbers):
    return sum(numbers) if isinstance(numbers, list) else None


class _Cell:
    """The rows of one record."""

    def __init__(self, number, record):
        self.number, self.record = number, record
        self.count = record["frames"]["last"] - record["frames"]["first"] + 1

    def ms(self, ns):
        return None if ns is None else ns / self.count / 1e6

    def interval(self, name, times):
        return {name: self.ms(_at(times, "median")), f"{name}_low": self.ms(_at(times, "low")), f"{name}_high": self.ms(_at(times, "high"))}

    def row(self):
        record = self.record
        row = {name: record.get(name) for name in ("status", "failure", "algorithm", "preset", "session", "key")}
        row |= {"device": _of_devices(record, "id"), "device_name": _of_devices(record, "name"), "driver": _of_devices(record, "driver")}
        row |= {"scene": record["scene"]["key"], "scene_digest": record["scene"]["digest"]}
        row |= {name: record["scene"][name] for name in ("bodies", "tetrahedra")}
        row |= {"first_frame": record["frames"]["first"], "last_frame": record["frames"]["last"]}
        row |= {name: record["environment"][name] for name in ("commit", "dirty", "date")}
        return row | self._times() | self._answer() | {f"set_{name}": value for name, value in record["settings"].items()}

    def _times(self):
        record = self.record
        row = self.interval("ms", record["total_ns"])
        samples = _at(record, "total_ns", "samples")
        row["samples"] = None if samples is None else len(samples)
        row |= {name: _at(record, "sampling", name) for name in ("rounds", "converged")}
        disturbed = _at(record, "conditions", "disturbed")
        row["disturbed"] = bool(disturbed) if isinstance(disturbed, list) else None
        row["device_span_ms"] = self.ms(_at(record, "device_span_ns", "median"))
        stages = record["stages"]
        if isinstance(stages, dict):
            for name, stage in stages.items():
                on_device = _at(stage, "device_ns", "median")
                row[f"stage_{name}_ms"] = self.ms(on_device if on_device else _at(stage, "host_ns", "median"))
            row |= {name: sum(stage.get(name, 0) for stage in stages.values()) for name in ("launches", "waits")}
        return row

    def _answer(self):
        record = self.record
        row = {name: _total(_at(record, "work", name)) for name in ("candidate_pairs", "contacts")}
        row |= {name: _at(record, "agreement", name) for name in ("missing", "extra", "contact_frames_wrong")}
        truth = _at(record, "error", "truth")
        if isinstance(truth, dict):
            row["pairs_missed"] = truth["missed_touching"] + truth["missed_overlapping"]
        row["device_bytes"] = _at(record, "preparation", "device_bytes")
        return row | {f"count_{name}": value for name, value in (_at(record, "work", "counters") or {}).items()}

    def samples(self):
        total = self.record["total_ns"] or {}
        samples = total.get("samples", [])
        # Before schema 3 each sample is a round.
        rounds = total.get("rounds", range(len(samples)))
        return [{"cell": self.number, "sample": i, "round": of, "ms": self.ms(ns)} for i, (ns, of) in enumerate(zip(samples, rounds))]

    def stages(self):
        return [{"cell": self.number, "stage": name, **self.interval("device_ms", stage.get("device_ns")), **self.interval("host_ms", stage.get("host_ns")),
                 **{what: stage.get(what) for what in ("launches", "waits", "bytes")}} for name, stage in (self.record["stages"] or {}).items()]

    def kernels(self):
        used = {}
        for kernel in self.record.get("kernels") or []:
            row = used.setdefault(kernel["entry"], {})
            for what in ("registers", "local_bytes", "spill_bytes"):
                known = [value for value in (row.get(what), kernel.get(what)) if value is not None]
                row[what] = max(known, default=None)
        times = self.record.get("kernel_times") or {}
        return [{"cell": self.number, "kernel": name, **self.interval("device_ms", _at(times, name, "device_ns")),
                 "launches": _at(times, name, "launches"), **used.get(name, {})} for name in {**times, **used}]

    def frames(self):
        replays = _at(self.record, "total_ns", "frames") or []
        work = self.record.get("work") or {}
        rows = []
        for i in range(self.count):
            times = [replay[i] for replay in replays if i < len(replay)]
            median = statistics.median(times) if times else None
            rows.append({"cell": self.number, "frame": self.record["frames"]["first"] + i, "ms": None if median is None else median / 1e6}
                        | {name: work[name][i] if isinstance(work.get(name), list) and i < len(work[name]) else None
                           for name in ("body_pairs", "candidate_pairs", "contacts")})
        return rows

    def errors(self):
        truth = _at(self.record, "error", "truth")
        if not isinstance(truth, dict):
            return []
        missed = truth["missed_touching"] + truth["missed_overlapping"]
        meeting = truth["touching"] + truth["overlapping"] + missed
        shares = {"false_share": (truth["false"], truth["candidates"]), "missed_share": (missed, meeting)}
        rows = [{"cell": self.number, "error": name, "median": part / whole} for name, (part, whole) in shares.items() if whole]
        contacts = truth.get("contacts") or {}
        return rows + [{"cell": self.number, "error": name, **{which: spread.get(which) for which in SPREADS}}
                       for name, spread in contacts.items() if isinstance(spread, dict)]


def _typed(column):
    """Settings: whole numbers, numbers, or words, as all values are that there are."""
    try:
        numbers = pandas.to_numeric(column)
    except (ValueError, TypeError):
        return column.astype("category")
    try:
        return numbers.astype("Int64")
    except (ValueError, TypeError):
        return numbers.astype("float64")


def _cells(rows):
    groups = [sorted({name for row in rows for name in row if name.startswith(group)}) for group in ("stage_", "count_", "set_")]
    table = pandas.DataFrame(rows, columns=[*FIRST_COLUMNS, *sum(groups, []), "file", "partial"])
    kinds = {name: "Int64" for name in (*WHOLE, *groups[1])} | {name: "float64" for name in (*TIMES, *groups[0])}
    kinds |= {name: "boolean" for name in TRUTHS} | {name: "category" for name in (*WORDS, "file")}
    table = table.astype(kinds)
    table["date"] = pandas.to_datetime(table["date"], utc=True)
    for name in groups[2]:
        table[name] = _typed(table[name])
    table.index.name = "cell"
    return table


def _table(rows, whole, words, times):
    table = pandas.DataFrame(rows, columns=["cell", *words, *whole, *times])
    return table.astype({"cell": "int64"} | {name: "Int64" for name in whole} | {name: "category" for name in words}
                        | {name: "float64" for name in times})


def read(files):
    """Records: of a path, or of several in their order, such as those of a plan's shards; .jsonl, or .jsonl.xz. A result stands in it
    once: an interrupted cell's record is left out where another file or line has the cell gone on with. Raises RecordError:
    FILE:LINE, what it is instead and what to do; a last line without an end is warned of and left out."""
    paths = [files] if isinstance(files, (str, os.PathLike)) else list(files)
    if not paths:
        raise lines.RecordError("no file is named; name files of records")
    rows = {name: [] for name in ("cells", *PARTS)}
    for record, place, path in lines.merged(paths):
        try:
            cell = _Cell(len(rows["cells"]), record)
            rows["cells"].append(cell.row() | {"file": os.fspath(path), "partial": bool(_at(record, "sampling", "interrupted"))})
            for name in PARTS:
                rows[name] += getattr(cell, name)()
        except (KeyError, TypeError, AttributeError, IndexError):
            raise lines.RecordError(f"{place}: a record that lacks fields of its schema; {lines.WHAT_TO_GIVE}") from None
    both = ("device_ms", "device_ms_low", "device_ms_high")
    return Records(_cells(rows["cells"]), _table(rows["samples"], ("sample", "round"), (), ("ms",)),
                   _table(rows["stages"], ("launches", "waits", "bytes"), ("stage",), (*both, "host_ms", "host_ms_low", "host_ms_high")),
                   _table(rows["kernels"], ("launches", "registers", "local_bytes", "spill_bytes"), ("kernel",), both),
                   _table(rows["frames"], ("frame", "body_pairs", "candidate_pairs", "contacts"), (), ("ms",)), _table(rows["errors"], (), ("error",), SPREADS))
