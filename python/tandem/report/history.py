# SPDX-License-Identifier: MIT
"""The history of cells that several programs recorded: the trend of each, and the commit where its time
moved, by the rule of 'tandem compare'."""

import dataclasses
import types

from ..comparison.matching import CHANGES, VERDICTS, match  # needs scipy
from ..comparison.naming import label
from ..comparison.pooling import counting, pooled
from .numbers import digits, ratio_row, rounded

LEVEL = 0.05  # probability of any false move in a page
MAX_KEYS, MAX_NAMED = 500, 3


@dataclasses.dataclass
class Point:
    """The records of one cell by one program, its sessions pooled. compared: the matching.Compared with
    the cell since which the time has not moved; None for the first point."""

    program: int
    cell: object
    compared: object = None

    @property
    def moved(self):
        return self.compared is not None and self.compared.verdict in CHANGES


@dataclasses.dataclass
class History:
    """programs: texts of commits, the oldest first. points: {key: Points in this order}, of the keys that
    several programs recorded. left_out: number of keys beyond MAX_KEYS."""

    programs: list
    points: dict
    left_out: int = 0


def _ordered(cells):
    """The programs of these cells by the date of their first record; in the order of the records if one has
    no date."""
    dates = {}
    for cell in cells:
        dates.setdefault(cell.program, []).append(cell.date)
    first = {program: min(found) for program, found in dates.items()}
    return sorted(first, key=first.get) if all(first.values()) else list(first)


def _texts(programs):
    """Commits of seven digits. A program with uncommitted changes says so, and programs of equal texts are
    numbered."""
    texts, seen = [], {}
    for commit, dirty, _ in programs:
        text = (commit[:7] or "unknown") + (" with changes" if dirty else "")
        seen[text] = seen.get(text, 0) + 1
        texts.append(text if seen[text] == 1 else f"{text} #{seen[text]}")
    return texts


def _pooled(cells):
    counted = counting(cells)
    return pooled(counted) if len(counted) > 1 else counted[0]


def _find_moves(points, programs):
    """Compares each program's cells with those since which their times have not moved. Steps share LEVEL
    equally, and cells of a step by Holm's correction, so that LEVEL is that of the page."""
    base = {}
    for number in range(programs):
        current = {key: one for key, own in points.items() for one in own if one.program == number}
        known = [key for key in current if key in base]
        if known:
            sides = [base[key] for key in known], [current[key].cell for key in known]
            matched = match(
                *(types.SimpleNamespace(cells=side) for side in sides), level=LEVEL / (programs - 1)
            )
            for key, compared in zip(known, matched.cells):
                current[key].compared = compared
        base |= {key: point.cell for key, point in current.items() if key not in base or point.moved}


def history_of(cells):
    """History of Cells; None if no cell has records of two programs."""
    good = [cell for cell in cells if cell.status == "ok" and cell.rounds]
    programs = _ordered(good)
    by_key = {}
    for cell in good:
        by_key.setdefault(cell.key, {}).setdefault(programs.index(cell.program), []).append(cell)
    several = {key: found for key, found in by_key.items() if len(found) > 1}
    if not several:
        return None
    shown = dict(list(several.items())[:MAX_KEYS])
    points = {
        key: [Point(program, _pooled(found[program])) for program in sorted(found)]
        for key, found in shown.items()
    }
    _find_moves(points, len(programs))
    return History(_texts(programs), points, len(several) - len(shown))


def _change(point):
    """What a move is: "takes 1.2 times as long [1.1, 1.3]"."""
    compared = point.compared
    if compared.verdict == "another_answer":
        return "has another answer"
    ratio = compared.ratio
    return f"takes {digits(ratio.value)} times as long [{digits(ratio.low)}, {digits(ratio.high)}]"


def _is_open(compared):
    """Whether no move is shown, but the interval of the ratio, if there is one, has moves beyond the threshold."""
    if compared.verdict in (*CHANGES, "within_threshold"):
        return False
    ratio, most = compared.ratio, 1 + compared.threshold
    return ratio is None or ratio.low is None or ratio.low < 1 / most or ratio.high > most


def _may_have_moved(points):
    compared = [point.compared for point in points if point.compared is not None]
    return not any(point.moved for point in points) and any(map(_is_open, compared))


def _title(name, points, programs):
    moves = [f"{_change(point)} since {programs[point.program]}" for point in points if point.moved]
    if len(moves) > MAX_NAMED:
        return f"{name} moved {len(moves)} times; it {', then '.join(moves[-MAX_NAMED:])}"
    if moves:
        return f"{name} {', then '.join(moves)}"
    return (
        f"{name} {'may have moved' if _may_have_moved(points) else 'did not move'} over {len(points)} commits"
    )


def _point(point):
    cell, compared = point.cell, point.compared
    row = [point.program, rounded(cell.median_ms), cell.all_rounds, cell.sessions or 1]
    if compared is None:
        return [*row, None, None, ""]
    return [*row, ratio_row(compared.ratio), point.moved, VERDICTS[compared.verdict]]


def shown_history(cells):
    """The History of Cells as JSON values, and its sentences; None and no sentence if no cell has
    records of two programs."""
    found = history_of(cells)
    if found is None:
        return None, []
    labels = dict(zip(found.points, label([points[-1].cell for points in found.points.values()])[0]))
    titles = {key: _title(labels[key], points, found.programs) for key, points in found.points.items()}
    moved = [key for key, points in found.points.items() if any(point.moved for point in points)]
    keys = [*moved, *(key for key in found.points if key not in moved)]
    named = "".join(f" {titles[key]}." for key in moved[:MAX_NAMED]) + (
        " The chart has the others." if len(moved) > MAX_NAMED else ""
    )
    unsure = sum(map(_may_have_moved, found.points.values()))
    rest = f", and {unsure} may have" if unsure else ""
    sentence = (
        f"Over {len(found.programs)} commits, {len(moved) or 'none'} of {len(keys)} cells moved{rest}.{named}"
    )
    return {
        "programs": found.programs,
        "left_out": found.left_out,
        "cells": [
            {"label": labels[key], "title": titles[key], "points": [*map(_point, found.points[key])]}
            for key in keys
        ],
    }, [sentence]
