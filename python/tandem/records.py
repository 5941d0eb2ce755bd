# SPDX-License-Identifier: MIT
"""Reads files of records as pandas frames."""

import dataclasses
import os

import pandas

from . import cell_rows, lines
from .cell import each, superseded
from .cell_rows import interval
from .fields import at
from .verdicts import RecordedVerdicts, verdict_of

# Types of columns that are no fields of a record; cell_rows.TYPES has the others.
WHOLE = ("samples", "launches", "waits", "candidate_pairs", "contacts", "pairs_missed")
TRUTHS = ("disturbed", "partial")
FIELD_TYPES = {"integer": "Int64", "number": "float64", "boolean": "boolean"}
SPREADS = ("median", "p99", "max")
WORDS = ("status", "algorithm", "preset", "device", "device_name", "driver", "scene")


@dataclasses.dataclass(frozen=True)
class Records:
    """Tables of the same records. Column `cell` of the other tables is the index of `cells`. Times are
    milliseconds. Launches, waits, bytes, pairs and contacts of a cell are sums over its frames.

    Texts are those of the records: unlike `tandem export --csv`, they may begin like formulas and contain
    control characters.

    cells: one row per record of any status, in the order of the files: the columns of `tandem export --csv`,
    then `file` and `partial`
        (the cell was interrupted before it had enough samples). `ms` is the median time of a frame, `ms_low`
        to `ms_high` its 95 % interval. `stage_NAME_ms` is the time of a stage on the device, or on the host
        for a stage without device time. `count_NAME` is a counter of work, `set_NAME` a setting.
    samples: one row per replay: cell, sample, round, ms per frame. Rounds are independent of each other,
    samples of one round are not. stages: one row per stage: cell, stage, device_ms and host_ms per frame with
    intervals, launches, waits, bytes. kernels: one row per kernel: cell, kernel, device_ms per frame with its
    interval, launches, registers, local_bytes, spill_bytes, stack_bytes.
        A kernel with several compiled variants has the largest value of each.
    frames: one row per frame: cell, frame, ms (its median over replays), body_pairs, candidate_pairs,
    contacts. errors: one row per error of a cell that was compared with the exact truth: cell, error, median,
    p99, max. For false_share (fraction of
        candidates that do not meet) and missed_share (fraction of meeting pairs that are missed), the median
        is the fraction.
    verdicts: the lines of kind verdict of the files, for verdict(). cell_of: the cell.Cell of each row of
    `cells`, by its index.
    """

    cells: pandas.DataFrame
    samples: pandas.DataFrame
    stages: pandas.DataFrame
    kernels: pandas.DataFrame
    frames: pandas.DataFrame
    errors: pandas.DataFrame
    verdicts: RecordedVerdicts = dataclasses.field(default_factory=RecordedVerdicts, repr=False)
    cell_of: dict = dataclasses.field(default_factory=dict, repr=False)

    def verdict(self):
        """The Verdict on the cells of this object with a correct answer and times, which the caller has
        selected to be comparable: their order, ratios to the fastest, and which are told apart from it.
        Ranked.cell is an index of `cells`. The one that `tandem run` recorded is read where it is of exactly
        these cells."""
        good = self.cells[(self.cells["status"] == "ok") & self.cells["ms"].notna()]
        found = verdict_of([self.cell_of[number] for number in good.index], self.verdicts)
        return dataclasses.replace(
            found, cells=tuple(dataclasses.replace(one, cell=good.index[one.cell]) for one in found.cells)
        )

    def of(self, cells):
        """The records of selected cells, given by an index of `cells` or a mask of it. Keeps the numbers of cells."""
        chosen = self.cells.loc[cells]
        return Records(
            chosen,
            *(table[table["cell"].isin(chosen.index)] for table in (getattr(self, name) for name in PARTS)),
            self.verdicts,
            self.cell_of,
        )


def _samples(cell):
    samples = at(cell.record, "total_ns", "samples") or []
    # Before schema 3 each sample is a round.
    rounds = at(cell.record, "total_ns", "rounds") or range(len(samples))
    return [
        {"sample": i, "round": number, "ms": ns / cell.frames / 1e6}
        for i, (ns, number) in enumerate(zip(samples, rounds))
    ]


def _stages(cell):
    return [
        {
            "stage": name,
            **interval("device_ms", stage.get("device_ns"), cell.frames),
            **interval("host_ms", stage.get("host_ns"), cell.frames),
            **{what: stage.get(what) for what in ("launches", "waits", "bytes")},
        }
        for name, stage in (cell.record["stages"] or {}).items()
    ]


def _kernels(cell):
    used = {}
    for kernel in cell.record.get("kernels") or []:
        row = used.setdefault(kernel["entry"], {})
        for what in ("registers", "local_bytes", "spill_bytes", "stack_bytes"):
            known = [value for value in (row.get(what), kernel.get(what)) if value is not None]
            row[what] = max(known, default=None)
    times = cell.record.get("kernel_times") or {}
    return [
        {
            "kernel": name,
            **interval("device_ms", at(times, name, "device_ns"), cell.frames),
            "launches": at(times, name, "launches"),
            **used.get(name, {}),
        }
        for name in {**times, **used}
    ]


def _frames(cell):
    columns = {"ms": cell.frame_ms} | {
        name: cell.work(name) or [] for name in ("body_pairs", "candidate_pairs", "contacts")
    }
    return [
        {"frame": cell.first_frame + i}
        | {name: values[i] if i < len(values) else None for name, values in columns.items()}
        for i in range(cell.frames)
    ]


def _errors(cell):
    truth = cell.truth
    if truth is None:
        return []
    fractions = {
        "false_share": (truth["false"], truth["candidates"]),
        "missed_share": (cell.missed, cell.meeting),
    }
    rows = [{"error": name, "median": part / whole} for name, (part, whole) in fractions.items() if whole]
    return rows + [
        {"error": name, **{which: spread.get(which) for which in SPREADS}}
        for name, spread in (truth.get("contacts") or {}).items()
        if isinstance(spread, dict)
    ]


# The tables besides cells, and what makes the rows of a cell.
PARTS = {"samples": _samples, "stages": _stages, "kernels": _kernels, "frames": _frames, "errors": _errors}


def _typed(column):
    """A column of settings as integers, floating-point numbers or words: the first type that all values have."""
    try:
        numbers = pandas.to_numeric(column)
    except (ValueError, TypeError):
        return column.astype("category")
    try:
        return numbers.astype("Int64")
    except (ValueError, TypeError):
        return numbers.astype("float64")


def _cells(rows):
    names = cell_rows.columns(rows)
    stages, counters, settings = (
        [name for name in names if name.startswith(group)] for group in cell_rows.GROUPS
    )
    table = pandas.DataFrame(rows, columns=[*names, "file", "partial"])
    kinds = {name: "Int64" for name in (*WHOLE, *counters)} | {
        name: "float64" for name in (*cell_rows.TIMES, *stages)
    }
    kinds |= {name: FIELD_TYPES[kind] for name, kind in cell_rows.TYPES.items() if kind in FIELD_TYPES}
    kinds |= {name: "boolean" for name in TRUTHS} | {name: "category" for name in (*WORDS, "file")}
    table = table.astype(kinds)
    table["date"] = pandas.to_datetime(table["date"], utc=True)
    for name in settings:
        table[name] = _typed(table[name])
    table.index.name = "cell"
    return table


def _table(rows, whole, words, times):
    table = pandas.DataFrame(rows, columns=["cell", *words, *whole, *times])
    return table.astype(
        {"cell": "int64"}
        | {name: "Int64" for name in whole}
        | {name: "category" for name in words}
        | {name: "float64" for name in times}
    )


def read(files):
    """Reads Records from one path or several (.jsonl or .jsonl.xz), in their order, such as the shards of a
    plan. Each result occurs once: the record of an interrupted cell is left out if a later one of the same
    program has its key. Raises RecordError with FILE:LINE, the error and what to do. A last line without an
    end is left out with a warning."""
    paths = [files] if isinstance(files, (str, os.PathLike)) else list(files)
    if not paths:
        raise lines.RecordError("no file is named; name files of records")
    verdicts = RecordedVerdicts()
    cells = [cell for path in paths for cell in each(path, verdicts.add)]
    left_out = superseded(cells)
    cells = [cell for number, cell in enumerate(cells) if number not in left_out]
    try:
        return _records(cells, verdicts)
    except lines.RecordError:
        raise
    except lines.FIELD_ERRORS:  # pandas names no line
        for cell in cells:
            try:
                _records([cell], verdicts)
            except lines.RecordError:
                raise
            except lines.FIELD_ERRORS:
                raise lines.RecordError(
                    f"{cell.location}: a record with a field that its schema does not allow; {lines.WHAT_TO_GIVE}"
                ) from None
        raise


def _records(cells, verdicts):
    """Records of Cells."""
    rows = {name: [] for name in ("cells", *PARTS)}
    for number, cell in enumerate(cells):
        try:
            rows["cells"].append(cell_rows.row(cell) | {"file": cell.path, "partial": cell.is_partial})
            for name, rows_of in PARTS.items():
                rows[name] += [{"cell": number, **row} for row in rows_of(cell)]
        except lines.FIELD_ERRORS:
            raise lines.RecordError(
                f"{cell.location}: a record that lacks fields of its schema; {lines.WHAT_TO_GIVE}"
            ) from None
    device = ("device_ms", "device_ms_low", "device_ms_high")
    return Records(
        _cells(rows["cells"]),
        _table(rows["samples"], ("sample", "round"), (), ("ms",)),
        _table(
            rows["stages"],
            ("launches", "waits", "bytes"),
            ("stage",),
            (*device, "host_ms", "host_ms_low", "host_ms_high"),
        ),
        _table(
            rows["kernels"],
            ("launches", "registers", "local_bytes", "spill_bytes", "stack_bytes"),
            ("kernel",),
            device,
        ),
        _table(rows["frames"], ("frame", "body_pairs", "candidate_pairs", "contacts"), (), ("ms",)),
        _table(rows["errors"], (), ("error",), SPREADS),
        verdicts,
        dict(enumerate(cells)),
    )
