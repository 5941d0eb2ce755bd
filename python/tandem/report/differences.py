# SPDX-License-Identifier: MIT
"""Differences of the cells of two files, as of 'tandem compare'."""

import os

from ..comparison import matched_files
from ..comparison.matching import VERDICTS
from ..comparison.naming import label
from ..comparison.notes import notes, summary
from ..pages.tables import number_text
from .numbers import ratio_row, rounded

MAX_SHOWN = 3000  # number of cells; the page also has the total number
LEVEL = 0.05


def _against(cell, old):
    """The comparison of a cell in words."""
    verdict, ratio = VERDICTS[cell.verdict], cell.ratio
    if cell.verdict == "another_answer":
        return verdict
    interval = "" if ratio.low is None else f" [{number_text(ratio.low)}, {number_text(ratio.high)}]"
    return f"{number_text(ratio.value)}{interval} times the time in {old}: {verdict}"


def _row(cell, name, number, old):
    """`number`: that of the new cell on the page, or None. Times are milliseconds per frame, as everywhere on
    the page."""
    row = {"label": name, "verdict": VERDICTS[cell.verdict], "cell": number, "against": _against(cell, old)}
    if cell.verdict == "another_answer":
        return row
    return row | {
        "old": rounded(cell.before_ns / cell.before.frames / 1e6),
        "new": rounded(cell.after_ns / cell.after.frames / 1e6),
        "ratio": ratio_row(cell.ratio),
        "p": None if cell.p_holm is None else rounded(cell.p_holm),
    }


def differences(old, new, cells):
    """The comparison for the page. `cells`: Cells of the new file. Raises RecordError as tandem compare
    does."""
    numbers = {cell.key: number for number, cell in enumerate(cells) if not cell.is_older}
    before, after, matched = matched_files(old, new, level=LEVEL)
    labels, common = label([cell.before for cell in matched.cells])
    old = os.path.basename(old)
    return {
        "old": old,
        "common": common,
        "title": f"{os.path.basename(new)} against {old}: {summary(matched, LEVEL)}",
        "notes": notes(before, after, matched),
        "of": len(matched.cells),
        "cells": [
            _row(cell, name, numbers.get(cell.after.key), old)
            for cell, name in zip(matched.cells[:MAX_SHOWN], labels)
        ],
    }
