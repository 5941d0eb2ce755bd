# SPDX-License-Identifier: MIT
"""Differences of the cells of two files, as of 'tandem compare', for a chart of the page."""

import os

from ..comparison import matched_files
from ..comparison.matching import VERDICTS
from ..comparison.naming import label
from ..comparison.notes import notes, summary
from .data import dumped
from .numbers import optional, rounded

MAX_SHOWN = 3000  # number of cells; the page also has the total number
LEVEL = 0.05


def _row(cell, name, number):
    """`number`: that of the new cell on the page, or None. Times are milliseconds a frame, as everywhere on
    the page."""
    row = {"label": name, "verdict": VERDICTS[cell.verdict], "cell": number}
    if cell.verdict == "another_answer":
        return row
    ratio = cell.ratio
    return row | {
        "old": rounded(cell.before_ns / cell.before.frames / 1e6),
        "new": rounded(cell.after_ns / cell.after.frames / 1e6),
        "ratio": [optional(value) for value in (ratio.value, ratio.low, ratio.high)],
        "p": optional(cell.p_holm),
        "would_show": optional(cell.least_effect),
    }


def differences(old, new, cells):
    """JSON text of the comparison. `cells`: Cells of the new file. Raises RecordError as tandem compare
    does."""
    numbers = {cell.key: number for number, cell in enumerate(cells) if not cell.is_older}
    before, after, matched = matched_files(old, new, level=LEVEL)
    labels, common = label([cell.before for cell in matched.cells])
    return dumped(
        {
            "old": os.path.basename(old),
            "new": os.path.basename(new),
            "common": common,
            "summary": summary(matched, LEVEL),
            "notes": notes(before, after, matched),
            "of": len(matched.cells),
            "cells": [
                _row(cell, name, numbers.get(cell.after.key))
                for cell, name in zip(matched.cells[:MAX_SHOWN], labels)
            ],
        }
    )
