# SPDX-License-Identifier: MIT
"""The answer of a folder in three sentences, and the table of the four methods that it is drawn from."""

import math
import statistics

from .claims import counts, errata
from .methods import FOUR, four_of_scenes
from .quantities import NotMeasured
from .ratios import ratio_of
from .rules import AGREES, BY_CONSTRUCTION, DIFFERS, NOT_SETTLED, UNTESTED
from .tables import written


def interval_text(measured):
    """ "0.633 [0.629, 0.643]", or the value alone for a count and for one sample."""
    value = written(measured.value)
    return (
        value
        if measured.low == measured.high
        else f"{value} [{written(measured.low)}, {written(measured.high)}]"
    )


def four_methods(folder):
    """One row for each scene, its frames and k with at least two of the four methods: milliseconds per frame of
    each case, and gProximity's time over that of the others as a Measured."""
    rows = []
    for scene, k, cases in four_of_scenes(folder, ("8", "18")):
        other = cases["gProximity"]
        if sum(case is not None for case in cases.values()) > 1:
            ratios = {name: _over(other, case) for name, case in cases.items() if name != "gProximity"}
            rows.append({"scene": scene, "k": k, "cases": cases, "ratios": ratios})
    return rows


def _over(other, case):
    try:
        return ratio_of(other, "frame", case, "frame") if other and case else None
    except NotMeasured:
        return None


def _span(values):
    low, high = written(min(values)), written(max(values))
    return low if low == high else f"{low} to {high}"


def _finite(measured):
    """Values of those that were measured, not only in disturbed rounds."""
    return [one.value for one in measured if one and math.isfinite(one.value)]


def _resident(rows):
    parts = []
    for name, words in zip(
        [name for name in FOUR if name != "gProximity"],
        ("the paper's schedule", "the grouped schedule", "tiled"),
    ):
        values = _finite(row["ratios"][name] for row in rows)
        parts.append(
            f"{_span(values)} times as long as {words}" if values else f"an unmeasured time beside {words}"
        )
    return f"Resident on the device, gProximity takes {parts[0]}, {parts[1]} and {parts[2]}."


def _values(claims, wanted):
    [claim] = [claim for claim in claims if claim.id == wanted]
    return _finite(line.measured for line in claim.lines)


def _published(claims):
    whole, small = _values(claims, "narrow-in-all-cases"), _values(claims, "narrow-small-array")
    first = (
        f"As published, gProximity uploads its whole queue array for every batch, and its narrow phase takes {_span(whole)} times as long as chunked's"
        if whole
        else "As published, with gProximity's whole queue array, the narrow phase of no scene can be judged here"
    )
    return f"{first}; with a bounded array, the factor is {_span(small)}." if small else f"{first}."


def _verdicts(claims):
    number, wrong = counts(claims), errata(claims)
    apart = f" {len(wrong)} more are errata: the paper contradicts itself." if wrong else ""
    return (
        f"Among {len(claims) - len(wrong)} claims of the paper, {number[AGREES]} agree with measurements, {number[DIFFERS]} differ, "
        f"{number[NOT_SETTLED]} are not settled, {number[BY_CONSTRUCTION]} hold by construction, and {number[UNTESTED]} are untested.{apart}"
    )


def sentences(folder, claims):
    """Three sentences from the records, and one on errata."""
    return [_resident(four_methods(folder)), _published(claims), _verdicts(claims)]


def method_rows(folder):
    """Rows of texts: scene, k, then for each method milliseconds per frame, and gProximity over it with its
    interval."""
    rows = []
    for row in four_methods(folder):
        texts = []
        for name in FOUR:
            case, measured = row["cases"][name], row["ratios"].get(name)
            texts.append(
                "not measured"
                if case is None
                else written(1e3 * case.total() / case.frames)
                + (f" ({interval_text(measured)})" if measured else "")
            )
        frames = statistics.mode(f"{case.first}:{case.last}" for case in row["cases"].values() if case)
        rows.append([f"{row['scene']}, frames {frames}", row["k"], *texts])
    return rows
