# SPDX-License-Identifier: MIT
"""Texts of numbers and notes in tables."""

from .. import markdown


def table(heads, rows):
    """A Markdown table without columns that are empty in all rows."""
    filled = [i for i in range(len(heads)) if any(row[i] for row in rows)]
    return markdown.table([heads[i] for i in filled], [[row[i] for i in filled] for row in rows])


def number(value):
    return "-" if not value else f"{value:.3g}" if value < 100 else f"{value:.0f}"


def with_interval(summary, scale, rounds):
    """The median and half the width of its interval; an empty text for a cell without samples."""
    if not summary or "median" not in summary:
        return ""
    half = f"{(summary['high'] - summary['low']) / 2 * scale:.2g}" if rounds > 1 else "?"
    return f"{number(summary['median'] * scale)} ± {half}"


def verdict(record):
    """Why a record is failed or wrong; an empty text if it is ok."""
    if record["status"] == "failed":
        return f"failed: {record['failure']}"
    if record["status"] == "ok":
        return ""
    agreement = record.get("agreement") or {}
    names = {"missing": "missing", "extra": "extra", "contact_frames_wrong": "frames with other contacts"}
    found = [f"{agreement[name]:,} {text}" for name, text in names.items() if agreement.get(name)]
    return "WRONG: " + (", ".join(found) or "another answer")


def notes(record):
    """Notes on the numbers of a cell, as one text."""
    sampling, conditions, chosen = record["sampling"], record["conditions"] or {}, record.get("chosen")
    found = [
        verdict(record),
        "not compared" if record["agreement"] is None and record["status"] == "ok" else "",
        "interrupted" if sampling["interrupted"] else "",
        "wide interval" if sampling["converged"] is False else "",
        f"{len(conditions['disturbed'])} rounds disturbed" if conditions.get("disturbed") else "",
        f"chosen by {chosen['by']} of {chosen['of']}" if chosen else "",
    ]
    return "; ".join(filter(None, found))
