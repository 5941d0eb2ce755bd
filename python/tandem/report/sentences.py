# SPDX-License-Identifier: MIT
"""Sentences on groups: the fastest cell, its lead and significance, and cells that failed or were wrong."""

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


def _wins(groups, cells):
    """{algorithm: (ratio of the best other algorithm to it, whether that is told apart) of each group in which
    the algorithm is the fastest}, the most wins first."""
    wins = {}
    for group in groups:
        algorithms = [cells[one.cell].algorithm for one in group.ranked]
        after = next((one for one, name in zip(group.ranked, algorithms) if name != algorithms[0]), None)
        if after is not None and not group.answers_differ:
            wins.setdefault(algorithms[0], []).append((after.ratio.value, after.is_told_apart))
    return dict(sorted(sorted(wins.items()), key=lambda item: -len(item[1])))


def _won(name, won, contested):
    """A sentence on an algorithm that leads in so many of `contested` comparisons."""
    name, ratios, significant = (
        one_line(name, 100),
        [ratio for ratio, _ in won],
        sum(is_apart for _, is_apart in won),
    )
    where = (
        f"all {contested} comparisons" if len(won) == contested else f"{len(won)} of {contested} comparisons"
    )
    where = "the only comparison" if contested == 1 else where
    than = digits(ratios[0]) if len(won) == 1 else f"{digits(min(ratios))} to {digits(max(ratios))}"
    if significant == len(won):
        return f"{name} is the fastest in {where}; the best other algorithm takes {than} times as long."
    apart = f"told apart from it in {significant} of these" if significant else "not told apart from it"
    return f"{name} leads in {where}; the best other algorithm takes {than} times as long, and is {apart}."


def summary_sentences(groups, cells):
    """Sentences on all groups together: the numbers of wins of each algorithm, and cells that are not ranked."""
    wins = _wins(groups, cells)
    contested = sum(map(len, wins.values()))
    sentences = [" ".join(_won(name, won, contested) for name, won in wins.items())] if wins else []
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
