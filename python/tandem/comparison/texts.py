# SPDX-License-Identifier: MIT
"""A comparison as text for terminals, as Markdown for pull requests, and as JSON for programs."""

import dataclasses
import json

from ..text_lines import one_line, paragraph, table
from .matching import POWER, VERDICTS
from .naming import label
from .notes import notes, summary

HEADING = ("cell", "old ms", "new ms", "new/old [95 %]", "p (Holm)", "verdict", "detectable")
LEFT = (0, len(HEADING) - 2)
UNIT = "milliseconds per frame, medians"


def _milliseconds(ns):
    """Milliseconds with about four digits, at most six decimals."""
    ms = ns * 1e-6
    limits = ((0.01, 6), (0.1, 5), (1, 4), (10, 3), (100, 2), (1000, 1))
    return f"{ms:.{next((decimals for limit, decimals in limits if ms < limit), 0)}f}"


def _row(cell, name):
    verdict, name = VERDICTS[cell.verdict], one_line(name, 1000)
    if cell.verdict == "another_answer":
        return name, "-", "-", "-", "-", verdict, "-"
    interval = "-" if cell.ratio.low is None else f"[{cell.ratio.low:.3f}, {cell.ratio.high:.3f}]"
    ratio = f"{cell.ratio.value:.3f} {interval}"
    p = "-" if cell.p_holm is None else "<0.0001" if cell.p_holm < 0.0001 else f"{cell.p_holm:.4f}"
    effect = "-" if cell.least_effect is None else f"{100 * cell.least_effect:.1f} %"
    return (
        name,
        _milliseconds(cell.before_ns / cell.before.frames),
        _milliseconds(cell.after_ns / cell.after.frames),
        ratio,
        p,
        verdict,
        effect,
    )


def _rows(matched):
    """The values that all cells share, and a heading with one row per cell."""
    names, common = label([cell.before for cell in matched.cells])
    return one_line(common, 1000), [HEADING, *map(_row, matched.cells, names)]


def _origin(side):
    """Origin of records: "FILE: 24 cells, commit 133aed5766b2"."""
    commits = [commit or "unknown" for commit in side.commits]
    changed = " with uncommitted changes" if any(cell.dirty for cell in side.cells) else ""
    cells = f"{len(side.cells)} {'cell' if len(side.cells) == 1 else 'cells'}"
    return one_line(
        f"{side.path}: {cells}, {'commit' if len(commits) == 1 else 'commits'} {', '.join(commits)}{changed}",
        1000,
    )


def text(before, after, matched, level):
    common, rows = _rows(matched)
    parts = [paragraph(f"old  {_origin(before)}", 5), paragraph(f"new  {_origin(after)}", 5)]
    if common:
        parts.append(paragraph(f"all  {common}", 5))
    parts.append(paragraph(f"ms   {UNIT}", 5))
    parts += ["\n", table(rows, LEFT), "\n", *(paragraph(note, 2) for note in notes(before, after, matched))]
    return "".join(parts) + paragraph(summary(matched, level), 2)


def _escaped(part):
    """Escapes characters that Markdown or HTML would interpret, such as bars of tables."""
    return "".join(f"\\{character}" if character in "|<>*_`\\[]" else character for character in part)


def markdown(before, after, matched, level):
    common, rows = _rows(matched)
    lines = [
        f"**{_escaped(summary(matched, level))}**",
        "",
        f"old: {_escaped(_origin(before))}  ",
        f"new: {_escaped(_origin(after))}  ",
        f"all: {_escaped(common)}  ",
        f"ms: {UNIT}",
        "",
    ]
    drawn = ["".join(f"| {_escaped(part)} " for part in row) + "|" for row in rows]
    lines += [drawn[0], "|---|---:|---:|---:|---:|---|---:|", *drawn[1:], ""]
    return (
        "\n".join(
            [*lines, *(f"- {_escaped(one_line(note, 2000))}" for note in notes(before, after, matched))]
        )
        + "\n"
    )


def _origin_json(cell, median_ns):
    def answer(digest):
        return dataclasses.asdict(digest) if digest else None

    return {
        "line": cell.line,
        "median_ns": median_ns,
        "frame_ns": median_ns / cell.frames,
        "samples": cell.samples,
        "rounds": cell.all_rounds,
        "disturbed_rounds": cell.disturbed_rounds,
        "sessions": cell.sessions or 1,
        "session": cell.session or None,
        "seed": cell.seed,
        "commit": cell.commit or None,
        "dirty": cell.dirty,
        "digest": answer(cell.pairs),
        "contact_digest": answer(cell.contacts),
    }


def _times_json(cell):
    """Ratio and tests of times; None for a cell with another answer, and for an interval that does not exist."""
    if cell.ratio is None:
        return None
    test = f"{'signed ranks' if cell.paired else 'rank sums'}, {'exact' if cell.exact else 'normal approximation'}"
    return {
        "ratio": cell.ratio.value,
        "low": cell.ratio.low,
        "high": cell.ratio.high,
        "log_error": cell.ratio.log_error,
        "test": test,
        "p": cell.p,
        "p_holm": cell.p_holm,
        "least_p": cell.least_p,
        "least_effect": cell.least_effect,
        "rounds_needed": cell.rounds_needed,
    }


def _cell_json(cell, name):
    return {
        "key": cell.before.key,
        "label": name,
        "verdict": cell.verdict,
        "threshold": cell.threshold,
        "paired": cell.paired,
        "unit": "session" if cell.before.sessions else "round",
        "undisturbed_only": cell.undisturbed,
        "common_rounds": cell.common if cell.paired else None,
        "times": _times_json(cell),
        "old": _origin_json(cell.before, cell.before_ns),
        "new": _origin_json(cell.after, cell.after_ns),
    }


def _file_json(side, only):
    left_out = [
        {"line": cell.line, "key": cell.key, "status": cell.status, "failure": cell.failure or None}
        for cell in side.left_out
    ]
    return {
        "file": side.path,
        "records": side.records,
        "cells": len(side.cells),
        "commits": [commit or None for commit in side.commits],
        "repeated": side.repeated,
        "pooled": side.pooled,
        "torn": side.torn,
        "left_out": left_out,
        "only_here": [cell.key for cell in only],
    }


def as_json(before, after, matched, level):
    names, _ = label([cell.before for cell in matched.cells])
    made = {
        "level": level,
        "power": POWER,
        "tested": matched.tested,
        "changed": matched.changed,
        "summary": summary(matched, level),
        "notes": notes(before, after, matched),
        "verdicts": {verdict: matched.count(verdict) for verdict in VERDICTS},
        "old": _file_json(before, matched.only_old),
        "new": _file_json(after, matched.only_new),
        "cells": list(map(_cell_json, matched.cells, names)),
    }
    return json.dumps(made, indent=2, ensure_ascii=False) + "\n"
