# SPDX-License-Identifier: MIT
"""The part of the page on answers: whether all are right, and which are not."""

from ..fields import at
from ..pages.frame import Section
from ..pages.markup import element, items, paragraphs
from ..text_lines import one_line
from .numbers import is_number
from .sentences import bad_cell_text

MAX_SHOWN = 100  # of cells that are not right
DIFFER = "the cells found different sets of candidate pairs, so none of them counts as the fastest"


def _is_checked(cell):
    return is_number(at(cell.record, "agreement", "missing"))


def _count(number, what="cell"):
    return f"{number:,} {what}{'s' * (number != 1)}"


def _right(cells):
    """Sentences on cells whose status is ok."""
    right = [cell for cell in cells if cell.status == "ok"]
    checked = sum(map(_is_checked, right))
    if checked:
        who = (
            f"All {_count(checked)} are"
            if checked == len(cells) > 1
            else f"{_count(checked)} of {len(cells):,} are"
        )
        who = "The cell is" if checked == len(cells) == 1 else who
        yield f"{who} right: no pair is missing or extra, and contacts are equal to the reference's bit for bit."
    if checked < len(right):
        yield f"{_count(len(right) - checked)} ran without a check of the answer."
    with_truth = [cell for cell in right if cell.truth is not None]
    if with_truth:
        missed = sum(cell.missed for cell in with_truth)
        yield f"Against the exact truth, {_count(len(with_truth))} missed {missed or 'none'} of {sum(cell.meeting for cell in with_truth):,} meeting pairs."


def _problems(groups, cells):
    """Texts on cells and groups that are not right."""
    for group in groups:
        if group.answers_differ:
            yield f"{group.row}: {DIFFER}."
        for number in group.cells:
            if cells[number].status != "ok":
                yield f"{group.row}: {bad_cell_text(group, number, cells[number])}."


def answers(groups, cells):
    """The Section."""
    problems = [one_line(text, 600) for text in _problems(groups, cells)]
    shown = [element("span", text, class_="bad") for text in problems[:MAX_SHOWN]]
    if len(problems) > MAX_SHOWN:
        shown.append(f"{len(problems) - MAX_SHOWN} more are in the table of cells.")
    is_right = not problems and all(map(_is_checked, cells))
    title = "All right" if is_right else "Not all right" if problems else "Answers"
    return Section("answers", title, [paragraphs(_right(cells)), items(shown) if shown else None])
