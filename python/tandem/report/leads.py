# SPDX-License-Identifier: MIT
"""The verdict on cells in words, as `tandem run` writes it; used by sentences, titles and tables of the page."""

import dataclasses

from ..verdicts import ROUNDS
from .numbers import digits, ratio_digits

MAX_NAMED = 4  # of cells that cannot be told apart
ONE_ROUND = "one round: no interval"
FEW_ROUNDS = f"fewer than {ROUNDS} rounds: no interval"


@dataclasses.dataclass(frozen=True)
class Named:
    """A ranked cell. ranked: its verdicts.Ranked; name: its text; ms: its milliseconds per frame."""

    ranked: object
    name: str
    ms: float


def ratio_text(ratio, has_interval):
    """ "2.17 [2.14, 2.18]" """
    value, low, high = ratio_digits(ratio)
    return f"{value} {f'[{low}, {high}]' if has_interval else f'({FEW_ROUNDS})'}"


def is_slower(ranked):
    """Whether a cell takes longer than the first with its whole interval."""
    return ranked.is_told_apart and ranked.ratio.low > 1


def listed(names):
    """ "a, b and c" """
    *most, last = names
    return f"{', '.join(most)} and {last}" if most else last


def is_leader(ranked, first):
    """Whether a cell is the first, or nothing tells it apart from the first."""
    return ranked is first or (ranked.has_interval and not is_slower(ranked))


def title(cells, answers_differ=False):
    """The verdict on Named cells, the fastest first, without a full stop."""
    if answers_differ:
        return "Answers differ: these times are of different work"
    if not cells:
        return "None of these cells has valid times"
    first, *rest = cells
    ms = f"{digits(first.ms)} ms per frame"
    if not rest:
        return f"{first.name} takes {ms}; there is nothing to compare it with"
    second = rest[0].ranked
    ratio, low, high = ratio_digits(second.ratio)
    faster = f"{ratio} times as fast as {rest[0].name}"
    if not second.has_interval:
        return f"{first.name} took the least time, in fewer than {ROUNDS} rounds: {ms}, {faster}"
    if is_slower(second):
        return f"{first.name} is fastest: {ms}, {faster} [{low}, {high}]"
    tied = [one.name for one in cells if is_leader(one.ranked, first.ranked)]
    tied = tied if len(tied) <= MAX_NAMED else [tied[0], f"{len(tied) - 1} others"]
    return f"{listed(tied)} cannot be told apart: {ms}, ratio [{low}, {high}]"


def slowest_sentence(cells):
    """A sentence with a blank before it; empty if the slowest of Named cells is the first or second, or a tie."""
    last = cells[-1]
    if len(cells) < 3 or not is_slower(last.ranked):
        return ""
    ratio, low, high = ratio_digits(last.ranked.ratio)
    return f" The slowest, {last.name}, takes {ratio} times as long [{low}, {high}]."
