# SPDX-License-Identifier: MIT
"""Compares cells of equal keys: the ratio of their times, its significance, and the verdict. The unit of
every test is the round, because samples of one round share its preparation."""

import dataclasses
import math
import statistics

from .. import rank_tests
from ..cell import Cell
from ..ratio import Ratio
from .pooling import is_minority, pooled

POWER = 0.8  # probability that the least effect is detected
ON_GPUS, ELSEWHERE = 0.01, 0.03  # thresholds
VERDICTS = {
    "slower": "slower",
    "faster": "faster",
    "within_threshold": "within the threshold",
    "not_shown": "≈",
    "too_few": "too few samples to tell",
    "disturbed": "disturbed",
    "another_answer": "another answer",
}  # with their texts
OTHER_TIMES = ("slower", "faster")
CHANGES = (*OTHER_TIMES, "another_answer")
MAX_ROUNDS = 1000  # upper limit of rounds_needed


@dataclasses.dataclass
class Compared:
    """One cell in both files.

    verdict: slower or faster: p is below the level and the ratio is beyond the threshold; within_threshold:
    only p is; not_shown: p is
        not below the level; too_few: with so few rounds p cannot fall below the level; disturbed: it would be
        slower or faster, but only with rounds in which the machine was disturbed; another_answer: digests
        differ, so that the times are of different work and are not compared.
    paired: both records are of one session, so that rounds of equal number are pairs; other rounds are not
    used. common: rounds of both. undisturbed: the values are those of undisturbed rounds only. before_ns,
    after_ns: medians over the rounds that are used. p: of the signed-rank test of logarithms if paired, else
    of the rank-sum test. exact: whether p is exact. least_p: the smallest p that
        this number of rounds can give. p_holm: p after correction; None for cells that cannot be tested.
    least_effect: the relative change that is detected with probability POWER; None for cells that cannot be
    tested or have no interval. rounds_needed: for too_few, the number of rounds on each side that is enough.
    Where `before.sessions` > 0, all of this is about sessions instead of rounds.
    """

    before: Cell
    after: Cell
    threshold: float
    paired: bool
    common: int
    before_ns: float
    after_ns: float
    verdict: str = "too_few"
    ratio: Ratio | None = None
    p: float = 1
    exact: bool = True
    least_p: float = 1
    p_holm: float | None = None
    least_effect: float | None = None
    rounds_needed: int | None = None
    undisturbed: bool = False

    @property
    def has_disturbed(self):
        """Whether a round that is used is disturbed."""
        return not self.undisturbed and bool(self.before.disturbed or self.after.disturbed)


@dataclasses.dataclass
class Matched:
    """cells: Compared in the order of the old file. only_old, only_new: Cells without a
    counterpart. tested: number of cells in the correction."""

    cells: list
    only_old: list
    only_new: list
    tested: int = 0

    def count(self, verdict):
        return sum(cell.verdict == verdict for cell in self.cells)

    @property
    def changed(self):
        return any(cell.verdict in CHANGES for cell in self.cells)


def _differ(before, after):
    return before is not None and after is not None and before != after


def _units(before, after, paired, left_out):
    """Numbers of the rounds of both sides that are used, without those of the sets `left_out` of both."""
    if paired:
        common = [
            number
            for number in before.rounds
            if number in after.rounds and number not in left_out[0] | left_out[1]
        ]
        return common, common
    return [number for number in before.rounds if number not in left_out[0]], [
        number for number in after.rounds if number not in left_out[1]
    ]


def _least_p(paired, old, new):
    """The smallest p that these numbers of rounds can give."""
    return rank_tests.least_signed_rank_p(old) if paired else rank_tests.least_rank_sum_p(old, new)


def _are_pairs(before, after):
    """Whether rounds of equal number are pairs: they are of one session, or are sessions of one name
    (turns.py)."""
    is_one = before.sessions > 0 or (bool(before.session) and before.session == after.session)
    return is_one and any(number in after.rounds for number in before.rounds)


def _by_unit(before, after):
    """Both cells with the same unit."""
    if (before.sessions > 0) == (after.sessions > 0):
        return before, after
    return (pooled([before]), after) if after.sessions else (before, pooled([after]))


def _compared(before, after, threshold, undisturbed=False):
    paired = _are_pairs(before, after)
    units = _units(
        before,
        after,
        paired,
        (before.disturbed, after.disturbed) if undisturbed else (frozenset(), frozenset()),
    )
    old, new = [before.rounds[number] for number in units[0]], [after.rounds[number] for number in units[1]]
    common = sum(number in after.rounds for number in before.rounds)
    cell = Compared(
        before,
        after,
        threshold,
        paired,
        common,
        statistics.median(old),
        statistics.median(new),
        undisturbed=undisturbed,
    )
    if _differ(before.pairs, after.pairs) or _differ(before.contacts, after.contacts):
        cell.verdict = "another_answer"
        return cell
    cell.least_p = _least_p(paired, len(old), len(new))
    if paired:
        cell.ratio = rank_tests.paired_ratio(old, new)
        cell.p, cell.exact = rank_tests.signed_ranks([math.log(b / a) for a, b in zip(old, new)])
    else:
        cell.ratio = rank_tests.unpaired_ratio(old, new)
        cell.p, cell.exact = rank_tests.rank_sums(old, new)
    return cell


def _undisturbed(cell, level):
    """The comparison of the undisturbed rounds of a cell; the cell itself if none of its rounds is disturbed,
    or if the others are not more than half, or too few for a p below the level. The choice depends on numbers
    of rounds, not on times."""
    if not cell.has_disturbed:
        return cell
    every = _units(cell.before, cell.after, cell.paired, (frozenset(), frozenset()))
    units = _units(cell.before, cell.after, cell.paired, (cell.before.disturbed, cell.after.disturbed))
    are_few = all(is_minority(len(all_of) - len(left), len(all_of)) for all_of, left in zip(every, units))
    if not are_few or _least_p(cell.paired, *map(len, units)) >= level:
        return cell
    return _compared(cell.before, cell.after, cell.threshold, undisturbed=True)


def least_effect(log_error, level, power=POWER):
    """The relative change that a normal test at this level detects with this probability, given the standard
    error of the logarithm."""
    normal = statistics.NormalDist()
    return math.expm1((normal.inv_cdf(1 - level / 2) + normal.inv_cdf(power)) * log_error)


def _verdict(cell, level):
    if cell.p_holm >= level:
        return "not_shown"
    if cell.ratio.value > 1 + cell.threshold:
        return "slower"
    return "faster" if cell.ratio.value < 1 / (1 + cell.threshold) else "within_threshold"


def _decide(timed, level):
    """Corrects p-values over all cells whose numbers of rounds allow a p below the level, and sets verdicts.
    Returns the number of these cells. A cell gets verdict too_few if its least p-value, corrected with the
    least p-values of all cells, is not below the level. This is valid because each corrected p-value
    increases with every p-value."""
    tested = [cell for cell in timed if cell.least_p < level]
    least = rank_tests.holm([cell.least_p for cell in tested])
    for cell, p, least_p in zip(tested, rank_tests.holm([cell.p for cell in tested]), least):
        cell.p_holm = float(p)
        cell.verdict = _verdict(cell, level) if least_p < level else "too_few"
        has_effect = least_p < level and cell.ratio.log_error is not None
        cell.least_effect = least_effect(cell.ratio.log_error, level / len(tested)) if has_effect else None
    return len(tested)


def _chosen(whole, seen, used):
    """The result for a cell: `whole` is its comparison with all rounds, which had verdict `seen`, and `used`
    the one that is tested. A change that `used` does not show without disturbed rounds is disturbed."""
    if used is not whole and (used.verdict in OTHER_TIMES or seen not in OTHER_TIMES):
        return used
    if used is not whole or (whole.has_disturbed and whole.verdict in OTHER_TIMES):
        whole.verdict = "disturbed"
    return whole


def _without_disturbance(timed, level):
    """The results of cells, by key, and the number of tested ones. Disturbed rounds are left out where the
    others are enough."""
    tested = _decide(timed, level)
    seen = [cell.verdict for cell in timed]
    used = [_undisturbed(cell, level / len(timed)) for cell in timed]
    if any(one is not cell for one, cell in zip(used, timed)):
        tested = _decide(used, level)
    return {
        cell.before.key: _chosen(*results) for cell, results in zip(timed, zip(timed, seen, used))
    }, tested


def _rounds_needed(paired, level, cells):
    """The smallest number of rounds on each side that can show a change of one cell among this number of
    cells."""
    for rounds in range(1, MAX_ROUNDS):
        if _least_p(paired, rounds, rounds) * cells < level:
            return rounds
    return MAX_ROUNDS


def _threshold(before, after, given):
    if given is not None:
        return given
    return ON_GPUS if before.on_gpus and after.on_gpus else ELSEWHERE


def match(before, after, threshold=None, level=0.05):
    """Compares two RecordedCells. p-values are corrected over all cells whose numbers of rounds allow a p
    below the level; times do not influence this choice (Holm 1979; Tarone 1990). The least effect assumes
    that only one cell changes."""
    new = {cell.key: cell for cell in after.cells}
    old = {cell.key for cell in before.cells}
    both = [_by_unit(cell, new[cell.key]) for cell in before.cells if cell.key in new]
    cells = [_compared(*sides, _threshold(*sides, threshold)) for sides in both]
    timed = [cell for cell in cells if cell.verdict != "another_answer"]
    results, tested = _without_disturbance(timed, level)
    for cell in results.values():
        if cell.verdict == "too_few":
            cell.rounds_needed = _rounds_needed(cell.paired, level, len(timed))
    return Matched(
        [results.get(cell.before.key, cell) for cell in cells],
        [cell for cell in before.cells if cell.key not in new],
        [cell for cell in after.cells if cell.key not in old],
        tested,
    )
