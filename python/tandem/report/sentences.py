# SPDX-License-Identifier: MIT
"""Sentences on groups: the fastest cell, its lead and significance, and cells that failed or were wrong."""

import dataclasses

from ..text_lines import one_line
from .leads import Named, compared_text, lead_sentence
from .numbers import digits

MAX_LETTERS = 900  # of sentences on cells that are not ranked


def _label(group, cell):
    return one_line(group.labels[group.cells.index(cell)], 300)


def named_cells(group, cells):
    """leads.Named of the ranked cells of a group, the fastest first."""
    return [Named(one, _label(group, one.cell), cells[one.cell].median_ms) for one in group.ranked]


def _fastest(group, cells):
    named = named_cells(group, cells)
    slowest = f" The slowest, {named[-1].name}, {compared_text(named[-1].ranked)}." if len(named) > 2 else ""
    return lead_sentence(named) + slowest


def _stages(cell):
    """Milliseconds of the stages that take time."""
    return {name: ms for name, ms in cell.stage_ms.items() if ms}


def _stage_sentence(group, cells):
    """Which stage makes the difference between the fastest cell and the first that takes longer with its
    whole interval; empty without such a cell or without stages."""
    slower = next((one for one in group.ranked[1:] if one.is_told_apart and one.ratio.low > 1), None)
    if slower is None:
        return ""
    fast, slow = (_stages(cells[one.cell]) for one in (group.ranked[0], slower))
    if not fast or not slow:
        return ""
    more = {name: slow.get(name, 0) - fast.get(name, 0) for name in sorted({*fast, *slow})}
    stage, whole = max(more, key=more.get), sum(more.values())
    if more[stage] <= 0:
        return ""
    part = "Most" if 0 < whole < 2 * more[stage] else "The largest part"
    return (
        f" {part} of the difference from {_label(group, slower.cell)} is in stage {stage}: {digits(fast[stage]) if stage in fast else 0} ms a frame instead of "
        f"{digits(slow.get(stage, 0))}."
    )


def _not_ranked(group, cells):
    """Sentences on cells that failed or were wrong, cut after about MAX_LETTERS."""
    sentences = ""
    for number in group.cells:
        cell = cells[number]
        if cell.status == "ok":
            continue
        failed = cell.status == "failed"
        why = one_line(cell.failure, 200) if failed else "its answer is not the reference's"
        sentences += (
            f" {_label(group, number)} {'failed' if failed else 'was wrong'}, and is not ranked: {why}."
        )
        if len(sentences) > MAX_LETTERS:
            return f"{sentences} There are more."
    return sentences


def group_sentences(group, cells):
    if not group.ranked:
        first = "None of its cells has valid times."
    elif group.answers_differ:
        first = "Its cells found different sets of candidate pairs, so that times are of different work: none counts as the fastest."
    else:
        first = _fastest(group, cells) + _stage_sentence(group, cells)
    return first + _not_ranked(group, cells)


@dataclasses.dataclass
class _Wins:
    """Numbers of groups in which an algorithm is the fastest, and in which its lead is significant; the range
    of ratios of the best other algorithm to it."""

    all: int = 0
    significant: int = 0
    low: float = 0
    high: float = 0

    def add(self, ratio, is_told_apart):
        self.low = ratio if self.all == 0 else min(self.low, ratio)
        self.high = max(self.high, ratio)
        self.all += 1
        self.significant += is_told_apart


def _wins(groups, cells):
    """Pairs of an algorithm and its _Wins, the most wins first."""

    def algorithm(ranked):
        return cells[ranked.cell].algorithm

    wins = {}
    for group in groups:
        if not group.ranked or group.answers_differ:
            continue
        winner = algorithm(group.ranked[0])
        after = next((ranked for ranked in group.ranked if algorithm(ranked) != winner), None)
        if after is not None:
            wins.setdefault(winner, _Wins()).add(after.ratio.value, after.is_told_apart)
    return sorted(sorted(wins.items()), key=lambda item: -item[1].all)


def _won(name, won, contested):
    """A sentence on an algorithm that has the lowest median in `won.all` of `contested` comparisons."""
    where = (
        "the only comparison"
        if contested == 1
        else f"all {contested} comparisons"
        if won.all == contested
        else f"{won.all} of {contested} comparisons"
    )
    than = digits(won.low) if won.all == 1 else f"{digits(won.low)} to {digits(won.high)}"
    if won.significant == won.all:
        return f"{name} is the fastest in {where}; the best other algorithm takes {than} times as long."
    apart = (
        f"told apart from it in {won.significant} of these" if won.significant else "not told apart from it"
    )
    return f"{name} has the lowest median in {where}; the best other algorithm takes {than} times as long, and is {apart}."


def _wins_sentences(wins):
    contested = sum(won.all for _, won in wins)
    return [" ".join(_won(one_line(name, 100), won, contested) for name, won in wins)]


def summary_sentences(groups, cells):
    """Sentences on all groups together: the numbers of wins of each algorithm, and cells that are not ranked."""
    wins = _wins(groups, cells)
    sentences = _wins_sentences(wins) if wins else []
    failed, wrong = (sum(cell.status == status for cell in cells) for status in ("failed", "wrong"))
    if failed + wrong > 0:
        sentences.append(
            f"{failed} failed and {wrong} gave a wrong answer: they are shown as such and never ranked."
        )
    older = sum(cell.is_older for cell in cells)
    if older:
        sentences.append(f"{older} were recorded again later: the last record that is ok counts.")
    if not all(cell.on_gpus for cell in cells):
        sentences.append("Times on processors do not predict times on a GPU.")
    return sentences
