# SPDX-License-Identifier: MIT
"""Which cells changed between two sets of records, by how much, how sure: what tandem compare says, as a frame."""
import dataclasses
import math
import os
import statistics

import pandas

from . import lines, rank_tests, resampling

POWER = 0.8  # of the least effect
ON_GPUS, ELSEWHERE = 0.01, 0.03  # thresholds


@dataclasses.dataclass(frozen=True)
class Comparison:
    """cells: a row a cell of both, index its key: verdict (slower, faster, within_threshold, not_shown, too_few, another_answer),
    old_ms and new_ms a frame, ratio with its 95 % interval low to high, p, p_holm (corrected over all cells that could be told
    apart), least_effect (the relative change that would have been shown with probability 0.8), paired, threshold.
    only_old, only_new: keys without a counterpart. left_out: "FILE:LINE" of records that failed, were wrong or have no samples."""
    cells: pandas.DataFrame
    only_old: list
    only_new: list
    left_out: list

    @property
    def changed(self):
        """Something is slower, faster or another answer."""
        return bool(self.cells["verdict"].isin(["slower", "faster", "another_answer"]).any())


def _answer(record, name):
    for place in ("work", "agreement"):
        part = record.get(place)
        if isinstance(part, dict) and name in part:
            return part[name]
    return None


class _Cell:
    """What is compared of a record; times are medians of rounds."""

    def __init__(self, record):
        total = record.get("total_ns") or {}
        samples = total.get("samples", [])
        rounds = {}
        for of, ns in zip(total.get("rounds", range(len(samples))), samples):
            rounds.setdefault(of, []).append(ns)
        self.rounds = {of: statistics.median(rounds[of]) for of in sorted(rounds)}
        self.session = record.get("session") or ""
        self.frames = record["frames"]["last"] - record["frames"]["first"] + 1
        self.on_gpus = bool(record["devices"]) and all(device["kind"] == "gpu" for device in record["devices"])
        self.answers = [_answer(record, name) for name in ("digest", "contact_digest")]

    def times(self):
        return list(self.rounds.values())


def _cells(file, commit):
    """By key, the last one that is ok; and what is left out."""
    cells, left_out, commits = {}, [], set()
    for record, place in lines.each(file):
        try:
            of = record["environment"]["commit"] or ""
            commits.add(of)
            if commit and not of.startswith(commit):
                continue
            cell = _Cell(record)
            if record["status"] == "ok" and cell.rounds:
                cells[record["key"]] = cell
            else:
                left_out.append(place)
        except (KeyError, TypeError, AttributeError):
            raise lines.RecordError(f"{place}: a record that lacks fields of its schema; {lines.WHAT_TO_GIVE}") from None
    if commit and not any(of.startswith(commit) for of in commits):
        raise lines.RecordError(f"{file}: no record of commit {commit}; there are {', '.join(sorted(commits))}")
    return cells, left_out


def _split(file):
    """FILE@COMMIT where no such file exists."""
    name = os.fspath(file)
    if os.path.exists(name) or "@" not in name:
        return name, ""
    path, _, commit = name.rpartition("@")
    if not commit:
        raise lines.RecordError(f"{name}: no such file, and no commit behind the @; give FILE@COMMIT")
    return path, commit


def _compared(old, new, threshold):
    common = [of for of in old.rounds if of in new.rounds]
    paired = bool(old.session) and old.session == new.session and bool(common)
    before = [old.rounds[of] for of in common] if paired else old.times()
    after = [new.rounds[of] for of in common] if paired else new.times()
    row = {"verdict": "too_few", "old_ms": statistics.median(before) / old.frames / 1e6, "new_ms": statistics.median(after) / new.frames / 1e6,
           "paired": paired, "threshold": threshold if threshold is not None else ON_GPUS if old.on_gpus and new.on_gpus else ELSEWHERE}
    if any(a is not None and b is not None and a != b for a, b in zip(old.answers, new.answers)):
        return row | {"verdict": "another_answer"}
    ratio = (resampling.paired_ratio if paired else resampling.unpaired_ratio)(before, after)
    row |= {"ratio": ratio.value, "low": ratio.low, "high": ratio.high, "log_error": ratio.log_error}
    if paired:
        return row | {"p": rank_tests.signed_rank_p([math.log(b / a) for a, b in zip(before, after)]),
                      "least_p": rank_tests.least_signed_rank_p(len(before))}
    return row | {"p": rank_tests.rank_sum_p(before, after), "least_p": rank_tests.least_rank_sum_p(len(before), len(after))}


def _verdict(row, level):
    if row["p_holm"] >= level:
        return "not_shown"
    if row["ratio"] > 1 + row["threshold"]:
        return "slower"
    return "faster" if row["ratio"] < 1 / (1 + row["threshold"]) else "within_threshold"


def _decide(tested, level):
    """p-values are corrected over cells whose rounds could bring p below the level at all (Tarone 1990)."""
    least = rank_tests.holm([row["least_p"] for row in tested])
    for row, p, least_p in zip(tested, rank_tests.holm([row["p"] for row in tested]), least):
        row["p_holm"] = p
        if least_p >= level:
            continue
        row["verdict"] = _verdict(row, level)
        normal = statistics.NormalDist()
        row["least_effect"] = math.expm1((normal.inv_cdf(1 - level / len(tested) / 2) + normal.inv_cdf(POWER)) * row["log_error"])


COLUMNS = ("verdict", "old_ms", "new_ms", "ratio", "low", "high", "p", "p_holm", "least_effect", "paired", "threshold")


def compare(old, new, *, threshold=None, level=0.05):
    """Comparison of two files, as FILE or FILE@COMMIT. threshold: the change that counts, 0.01 for 1 %; 0.01 on GPUs and 0.03
    elsewhere when left out. level: the probability of any false alarm, all cells together. Raises RecordError."""
    (before, old_out), (after, new_out) = _cells(*_split(old)), _cells(*_split(new))
    rows = {key: _compared(cell, after[key], threshold) for key, cell in before.items() if key in after}
    if not rows:
        raise lines.RecordError(f"{old} and {new}: no cell is in both; give files that measured the same cells on the same model of device")
    _decide([row for row in rows.values() if row["verdict"] != "another_answer" and row["least_p"] < level], level)
    table = pandas.DataFrame.from_dict(rows, orient="index", columns=COLUMNS).rename_axis("key")
    verdicts = pandas.CategoricalDtype(["slower", "faster", "within_threshold", "not_shown", "too_few", "another_answer"])
    table = table.astype({"verdict": verdicts} | {name: "float64" for name in COLUMNS if name not in ("verdict", "paired")})
    return Comparison(table, [key for key in before if key not in after], [key for key in after if key not in before], old_out + new_out)
