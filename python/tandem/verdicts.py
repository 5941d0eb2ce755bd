# SPDX-License-Identifier: MIT
"""Which of several comparable cells is the fastest, and which others are told apart from it.

`tandem run` records this as a line of kind verdict (results/verdict.schema.json) for the cells that it
measured together. `verdict_of` reads that line where it is of exactly these cells. Otherwise, such as for
records of several runs, it computes the verdict by the same rule."""

import dataclasses
import statistics

from . import lines
from .ratio import Ratio

ONE = Ratio(1.0, 1.0, 1.0, 0.0)
ROUNDS = 5  # from which a ratio has an interval: all of n lie on one side by chance in 2 of 2^n cases


@dataclasses.dataclass(frozen=True)
class Ranked:
    """A cell, compared with the fastest. cell: its index. ratio: its time to that of the fastest.
    has_interval: there are at least ROUNDS rounds. is_told_apart: the interval excludes 1."""

    cell: int
    ratio: Ratio = ONE
    has_interval: bool = False

    @property
    def is_told_apart(self):
        return self.has_interval and (self.ratio.low > 1 or self.ratio.high < 1)


@dataclasses.dataclass(frozen=True)
class Verdict:
    """cells: all, the fastest first. answers_differ: the cells found different pairs, so that none is the
    fastest. is_recorded: from a line of kind verdict."""

    cells: tuple = ()
    answers_differ: bool = False
    is_recorded: bool = False

    def leaders(self):
        """Indices of the fastest cell and of those that are not told apart from it; none if answers differ."""
        if self.answers_differ:
            return []
        return [
            one.cell
            for one in self.cells
            if one is self.cells[0] or (one.has_interval and not one.is_told_apart)
        ]


def _median(cell):
    return statistics.median(cell.rounds.values())


def _compared(number, base, cell):
    """Rounds of equal number are pairs within one session, because they were measured side by side."""
    from . import resampling  # needs scipy, which recorded verdicts do not need

    if base.session and base.session == cell.session:
        common = [at for at in cell.rounds if at in base.rounds]
        if common:
            ratio = resampling.paired_ratio(
                [base.rounds[at] for at in common], [cell.rounds[at] for at in common]
            )
            return Ranked(number, ratio, len(common) >= ROUNDS)
        value = _median(cell) / _median(base)
        return Ranked(number, Ratio(value, value, value, 0.0), False)
    ratio = resampling.unpaired_ratio(list(base.rounds.values()), list(cell.rounds.values()))
    return Ranked(number, ratio, min(len(base.rounds), len(cell.rounds)) >= ROUNDS)


def _ranked(cells, first, order):
    """All of them, compared with the first; the others by their ratios."""
    rest = (_compared(number, cells[first], cells[number]) for number in order if number != first)
    own = Ranked(first, ONE, len(cells[first].rounds) >= ROUNDS)
    return [own, *sorted(rest, key=lambda one: one.ratio.value)]


def computed(cells, same_work=True):
    """The Verdict of Cells with at least one round each, by the rule of harness/record/verdict.h. same_work:
    they should have equal pairs."""
    order = sorted(range(len(cells)), key=lambda number: (_median(cells[number]), cells[number].key))
    answers = {cell.pairs for cell in cells} - {None} if same_work else ()
    if not order:
        return Verdict()
    first = order[0]
    for _ in order:  # at most so many steps: the ratios of three cells can form a circle
        ranked = _ranked(cells, first, order)
        if len(order) < 2 or ranked[1].ratio.value >= 1:
            break
        first = ranked[1].cell
    return Verdict(tuple(ranked), len(answers) > 1)


def _identity(cells):
    return tuple(sorted((cell.key, cell.chosen) for cell in cells))


class RecordedVerdicts:
    """The lines of kind verdict of some files."""

    def __init__(self):
        self._by_cells = {}

    def add(self, line, location):
        """Adds a line. Raises RecordError if it does not match its schema."""
        try:
            cells = line["cells"]
            at = (
                line["session"],
                "+".join(line["devices"]),
                tuple(sorted((cell["key"], cell["chosen"]) for cell in cells)),
            )
            ranked = [(cell["key"], cell["chosen"], _recorded(cell)) for cell in cells]
            self._by_cells[at] = ranked, bool(line["answers_differ"])
        except lines.FIELD_ERRORS:
            raise lines.RecordError(
                f"{location}: a verdict that does not match results/verdict.schema.json; {lines.WHAT_TO_GIVE}"
            ) from None

    def of(self, cells):
        """The recorded Verdict of exactly these Cells; None if there is none."""
        if not cells or len({(cell.session, cell.devices) for cell in cells}) > 1:
            return None
        identity = _identity(cells)
        found = self._by_cells.get((cells[0].session, cells[0].devices, identity))
        if found is None or len(set(identity)) < len(identity):
            return None
        numbers = {(cell.key, cell.chosen): number for number, cell in enumerate(cells)}
        ranked, answers_differ = found
        return Verdict(
            tuple(Ranked(numbers[key, chosen], *rest) for key, chosen, rest in ranked), answers_differ, True
        )


def _recorded(cell):
    value, low, high = (cell[name] for name in ("ratio", "low", "high"))
    has_interval = low is not None
    return Ratio(
        float(value), float(low if has_interval else value), float(high if has_interval else value), 0.0
    ), has_interval


def verdict_of(cells, recorded=None, same_work=True):
    """The Verdict of Cells with at least one round each: the recorded one if there is one of exactly these
    cells, otherwise computed."""
    return (recorded.of(cells) if recorded else None) or computed(cells, same_work)
