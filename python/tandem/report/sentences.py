# SPDX-License-Identifier: MIT
"""Sentences on groups: the fastest cell and its lead, the stage that makes the difference, cells that failed or
were wrong, and what all groups show together."""

from .. import names
from ..fields import at
from ..text_lines import one_line
from .leads import Named, is_slower, slowest_sentence, title
from .numbers import digits, ends_text, is_number

WRONG = {
    "missing": "{} pairs missing",
    "extra": "{} extra",
    "contact_frames_wrong": "contacts differ in {} of its frames",
}
ANOTHER = "its answer is not the reference's"
MAX_LETTERS = 900  # of sentences on cells that are not ranked


def _label(group, number):
    return one_line(group.label(number), 300)


def named_cells(group, cells):
    """leads.Named of the ranked cells of a group, the fastest first."""
    return [Named(one, _label(group, one.cell), cells[one.cell].median_ms) for one in group.ranked]


def _stages(cell):
    """Milliseconds of the stages that take time."""
    return {name: ms for name, ms in cell.stage_ms.items() if ms}


def stage_text(group, cells):
    """Which stage makes the difference between the fastest cell and the first that takes longer with its
    whole interval; empty without such a cell or without stages."""
    slower = next((one for one in group.ranked[1:] if is_slower(one)), None)
    if slower is None or group.answers_differ:
        return ""
    first = group.ranked[0]
    fast, slow = (_stages(cells[one.cell]) for one in (first, slower))
    if not fast or not slow:
        return ""
    more = {name: slow.get(name, 0) - fast.get(name, 0) for name in sorted({*fast, *slow})}
    stage, whole = max(more, key=more.get), sum(more.values())
    if more[stage] <= 0:
        return ""
    part = "most" if 0 < whole < 2 * more[stage] else "the largest part"
    ms = [digits(own[stage]) if stage in own else "0" for own in (fast, slow)]
    return (
        f"Stage {stage} makes {part} of the difference: {ms[0]} ms per frame with {_label(group, first.cell)}, "
        f"{ms[1]} with {_label(group, slower.cell)}"
    )


def bad_cell_text(group, number, cell):
    """Why a cell of a group is not ranked."""
    if cell.status == "failed":
        return f"{_label(group, number)} failed: {one_line(cell.failure, 200)}"
    counts = ((at(cell.record, "agreement", name), text) for name, text in WRONG.items())
    wrong = ", ".join(text.format(count) for count, text in counts if is_number(count) and count)
    return f"{_label(group, number)} is wrong: {wrong or ANOTHER}"


def _not_ranked(group, cells):
    """Sentences on cells that failed or were wrong, cut after about MAX_LETTERS."""
    sentences = ""
    for number in group.cells:
        if cells[number].status == "ok":
            continue
        sentences += f" {bad_cell_text(group, number, cells[number])}."
        if len(sentences) > MAX_LETTERS:
            return f"{sentences} There are more."
    return sentences


def group_sentences(group, cells):
    named = named_cells(group, cells)
    first = f"{title(named, group.answers_differ)}."
    if named and not group.answers_differ:
        stages = stage_text(group, cells)
        first += (f" {stages}." if stages else "") + slowest_sentence(named)
    return first + _not_ranked(group, cells)


def method_of(cell):
    return names.method(cell.algorithm, cell.preset)


def best_of_methods(group, cells):
    """{method: the Ranked of its fastest cell in a group}, the fastest first."""
    found = {}
    for one in group.ranked:
        found.setdefault(method_of(cells[one.cell]), one)
    return found


def _won(found, contested, noun):
    """ "tiled is fastest in 8 of 10 scenes, 1.3 to 2.1 times as fast as the next method", then "gProximity in 2, 1.1 to
    1.4 times". `found`: {method: ratios}."""
    for number, (method, ratios) in enumerate(sorted(found.items(), key=lambda item: -len(item[1]))):
        name, times = one_line(method, 100), f"{ends_text([*map(digits, sorted(ratios))])} times"
        if number > 0:
            yield f"{name} in {len(ratios)}, {times}"
            continue
        where = f"all {contested}" if len(ratios) == contested else f"{len(ratios)} of {contested}"
        yield f"{name} is fastest in {where} {noun}, {times} as fast as the next method"


def _single(groups, contested, cells):
    """finding() if at most one group compares methods."""
    if contested:
        [(group, best)] = contested
        named = [Named(one, method_of(cells[one.cell]), cells[one.cell].median_ms) for one in best]
    else:
        group = max(groups, key=lambda group: len(group.ranked))
        named = named_cells(group, cells)
    return f"{f'{group.row}: ' if len(groups) > 1 else ''}{title(named, group.answers_differ)}"


def finding(groups, cells):
    """What all groups show together, without a full stop: the title of the first chart."""
    compared = [
        (group, [*best_of_methods(group, cells).values()]) for group in groups if not group.answers_differ
    ]
    contested = [(group, best) for group, best in compared if len(best) > 1]
    if len(contested) < 2:
        return _single(groups, contested, cells)
    found = {}
    for _, (first, second, *_) in contested:
        if is_slower(second):
            found.setdefault(method_of(cells[first.cell]), []).append(second.ratio.value)
    is_one_each = len({group.key for group, _ in contested}) == len(contested)
    noun = "scenes" if is_one_each else "comparisons"
    parts = [*_won(found, len(contested), noun)]
    ties = len(contested) - sum(map(len, found.values()))
    if ties:
        where = f"in {ties}" if parts else f"in all {ties} {noun}"
        parts.append(f"the two fastest methods cannot be told apart {where}")
    return "; ".join(parts)


def summary_sentences(groups, cells):
    """Sentences on all groups together: who is fastest, and cells that are not ranked."""
    sentences = [f"{finding(groups, cells)}."]
    failed, wrong = (sum(cell.status == status for cell in cells) for status in ("failed", "wrong"))
    if failed + wrong > 0:
        sentences.append(
            f"{failed} failed and {wrong} gave a wrong answer: they are shown as such and never ranked."
        )
    return [*sentences, *cautions(cells)]


def cautions(cells):
    """Sentences on cells that were recorded again, and on processors."""
    older = sum(cell.is_older for cell in cells)
    sentences = [f"{older} were recorded again later: the last record that is ok counts."] if older else []
    if not all(cell.on_gpus for cell in cells):
        sentences.append("Times on processors do not predict times on a GPU.")
    return sentences
