# SPDX-License-Identifier: MIT
"""Compares cells of equal keys: the ratio of their times, its significance, and the verdict. The unit of every test is the round,
because samples of one round share its preparation."""
import dataclasses
import math
import statistics

from .. import rank_tests, resampling
from .cells import RecordedCell

POWER = 0.8  # probability that the least effect is detected
ON_GPUS, ELSEWHERE = 0.01, 0.03  # thresholds
VERDICTS = {"slower": "slower", "faster": "faster", "within_threshold": "within the threshold", "not_shown": "≈", "too_few": "too few samples to tell",
            "another_answer": "another answer"}  # with their texts
CHANGES = ("slower", "faster", "another_answer")
MAX_ROUNDS = 1000  # upper limit of rounds_needed


@dataclasses.dataclass
class ComparedCell:
    """One cell in both files.

    verdict: slower or faster: p is below the level and the ratio is beyond the threshold; within_threshold: only p is; not_shown: p is
        not below the level; too_few: with so few rounds p cannot fall below the level; another_answer: digests differ, so that the times
        are of different work and are not compared.
    paired: both records are of one session, so that rounds of equal number are pairs; other rounds are not used. common: rounds of both.
    before_ns, after_ns: medians over the rounds that are used.
    p: of the signed-rank test of logarithms if paired, else of the rank-sum test. exact: whether p is exact. least_p: the smallest p that
        this number of rounds can give. p_holm: p after correction; None for cells that cannot be tested.
    least_effect: the relative change that is detected with probability POWER; None for cells that cannot be tested.
    rounds_needed: for too_few, the number of rounds on each side that is enough.
    """
    before: RecordedCell
    after: RecordedCell
    threshold: float
    paired: bool
    common: int
    before_ns: float
    after_ns: float
    verdict: str = "too_few"
    ratio: resampling.Ratio | None = None
    p: float = 1
    exact: bool = True
    least_p: float = 1
    p_holm: float | None = None
    least_effect: float | None = None
    rounds_needed: int | None = None


@dataclasses.dataclass
class Matched:
    """cells: ComparedCells in the order of the old file. only_old, only_new: RecordedCells without a counterpart. tested: number of cells
    in the correction."""
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


def _compared(before, after, threshold):
    if threshold is None:
        threshold = ON_GPUS if before.on_gpus and after.on_gpus else ELSEWHERE
    common = [number for number in before.rounds if number in after.rounds]
    paired = bool(before.session) and before.session == after.session and bool(common)
    old, new = before.times(), after.times()
    if paired:
        old, new = [before.rounds[number] for number in common], [after.rounds[number] for number in common]
    cell = ComparedCell(before, after, threshold, paired, len(common), statistics.median(old), statistics.median(new))
    if _differ(before.pairs, after.pairs) or _differ(before.contacts, after.contacts):
        cell.verdict = "another_answer"
    elif paired:
        cell.ratio = resampling.paired_ratio(old, new)
        cell.p, cell.exact = rank_tests.signed_ranks([math.log(b / a) for a, b in zip(old, new)])
        cell.least_p = rank_tests.least_signed_rank_p(len(old))
    else:
        cell.ratio = resampling.unpaired_ratio(old, new)
        cell.p, cell.exact = rank_tests.rank_sums(old, new)
        cell.least_p = rank_tests.least_rank_sum_p(len(old), len(new))
    return cell


def least_effect(log_error, level, power=POWER):
    """The relative change that a normal test at this level detects with this probability, given the standard error of the logarithm."""
    normal = statistics.NormalDist()
    return math.expm1((normal.inv_cdf(1 - level / 2) + normal.inv_cdf(power)) * log_error)


def _verdict(cell, level):
    if cell.p_holm >= level:
        return "not_shown"
    if cell.ratio.value > 1 + cell.threshold:
        return "slower"
    return "faster" if cell.ratio.value < 1 / (1 + cell.threshold) else "within_threshold"


def _decide(tested, level):
    """Corrects p-values and sets verdicts. A cell keeps verdict too_few if its least p-value, corrected with the least p-values of all
    cells, is not below the level. This is valid because each corrected p-value increases with every p-value."""
    least = rank_tests.holm([cell.least_p for cell in tested])
    for cell, p, least_p in zip(tested, rank_tests.holm([cell.p for cell in tested]), least):
        cell.p_holm = float(p)
        if least_p < level:
            cell.verdict = _verdict(cell, level)
            cell.least_effect = least_effect(cell.ratio.log_error, level / len(tested))


def _rounds_needed(paired, level, cells):
    """The smallest number of rounds on each side that can show a change of one cell among this number of cells."""
    for rounds in range(1, MAX_ROUNDS):
        least = rank_tests.least_signed_rank_p(rounds) if paired else rank_tests.least_rank_sum_p(rounds, rounds)
        if least * cells < level:
            return rounds
    return MAX_ROUNDS


def match(before, after, threshold=None, level=0.05):
    """Compares two RecordedCells. p-values are corrected over all cells whose numbers of rounds allow a p below the level; times do not
    influence this choice (Holm 1979; Tarone 1990). The least effect assumes that only one cell changes."""
    new = {cell.key: cell for cell in after.cells}
    old = {cell.key for cell in before.cells}
    cells = [_compared(cell, new[cell.key], threshold) for cell in before.cells if cell.key in new]
    timed = [cell for cell in cells if cell.verdict != "another_answer"]
    tested = [cell for cell in timed if cell.least_p < level]
    _decide(tested, level)
    for cell in timed:
        if cell.verdict == "too_few":
            cell.rounds_needed = _rounds_needed(cell.paired, level, len(timed))
    return Matched(cells, [cell for cell in before.cells if cell.key not in new], [cell for cell in after.cells if cell.key not in old], len(tested))
