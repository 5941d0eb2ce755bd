# SPDX-License-Identifier: MIT
"""Compares two sets of records, as 'tandem compare' does: which cells changed, by how much and how surely."""

import dataclasses
from typing import TYPE_CHECKING

from .. import lines
from .cells import read_cells
from .notes import nothing_common

if TYPE_CHECKING:
    import pandas

COLUMNS = "verdict old_ms new_ms ratio low high p p_holm least_effect paired threshold".split()


@dataclasses.dataclass(frozen=True)
class Comparison:
    """cells: one row per cell of both files, indexed by key: verdict (slower, faster, within_threshold,
    not_shown, too_few, disturbed, another_answer), old_ms and new_ms per frame, ratio with its 95 % interval
    low to high (NaN if none exists), p, p_holm (corrected over all cells that can be tested), least_effect
    (the relative change that would be detected with probability 0.8), paired, threshold. only_old, only_new:
    keys without a counterpart. left_out: "FILE:LINE" of records that failed, are wrong or have no samples."""

    cells: "pandas.DataFrame"
    only_old: list
    only_new: list
    left_out: list

    @property
    def changed(self):
        """Whether a cell is slower, faster or has another answer."""
        return bool(self.cells["verdict"].isin(["slower", "faster", "another_answer"]).any())


def matched_cells(before, after, threshold=None, level=0.05):
    """Two RecordedCells and their Matched. Raises RecordError if no cell is in both."""
    from .matching import match  # needs numpy, which reading cells does not need

    matched = match(before, after, threshold, level)
    if not matched.cells:
        raise lines.RecordError(nothing_common(before, after))
    return before, after, matched


def matched_files(old, new, threshold=None, level=0.05, commits=("", "")):
    """The RecordedCells of both files and their Matched. Raises RecordError, also if no cell is in both."""
    return matched_cells(read_cells(old, commits[0]), read_cells(new, commits[1]), threshold, level)


def _row(cell):
    row = {
        "verdict": cell.verdict,
        "old_ms": cell.before_ns / cell.before.frames / 1e6,
        "new_ms": cell.after_ns / cell.after.frames / 1e6,
        "paired": cell.paired,
        "threshold": cell.threshold,
    }
    if cell.ratio is None:
        return row
    return row | {
        "ratio": cell.ratio.value,
        "low": cell.ratio.low,
        "high": cell.ratio.high,
        "p": cell.p,
        "p_holm": cell.p_holm,
        "least_effect": cell.least_effect,
    }


def compare(old, new, *, threshold=None, level=0.05):
    """Comparison of two files, each FILE or FILE@COMMIT. threshold: the smallest relative change that counts,
    0.01 for 1 %; default: 0.01 on GPUs, 0.03 elsewhere. level: the probability of any false alarm among all
    cells. Raises RecordError."""
    import pandas

    from .matching import VERDICTS

    before, after, matched = matched_files(old, new, threshold, level)
    rows = {cell.before.key: _row(cell) for cell in matched.cells}
    table = pandas.DataFrame.from_dict(rows, orient="index", columns=COLUMNS).rename_axis("key")
    table = table.astype(
        {"verdict": pandas.CategoricalDtype(list(VERDICTS))}
        | {name: "float64" for name in COLUMNS if name not in ("verdict", "paired")}
    )
    left_out = [f"{side.path}:{cell.line}" for side in (before, after) for cell in side.left_out]
    return Comparison(
        table, [cell.key for cell in matched.only_old], [cell.key for cell in matched.only_new], left_out
    )
