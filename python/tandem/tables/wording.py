# SPDX-License-Identifier: MIT
"""Numbers and notes as tables have them."""
from .. import markdown


def table(heads, rows):
    """A table in Markdown without the columns that are empty everywhere."""
    kept = [i for i in range(len(heads)) if any(row[i] for row in rows)]
    return markdown.table([heads[i] for i in kept], [[row[i] for i in kept] for row in rows])


def number(value):
    return "-" if not value else f"{value:.3g}" if value < 100 else f"{value:.0f}"


def with_interval(summary, scale, rounds):
    """The median and half its interval; nothing of a cell without samples."""
    if not summary or "median" not in summary:
        return ""
    half = f"{(summary['high'] - summary['low']) / 2 * scale:.2g}" if rounds > 1 else "?"
    return f"{number(summary['median'] * scale)} ± {half}"


def verdict(record):
    """Why a record is failed or wrong; nothing of one that is ok."""
    if record["status"] == "failed":
        return f"failed: {record['failure']}"
    if record["status"] == "ok":
        return ""
    agreement = record.get("agreement") or {}
    names = {"missing": "missing", "extra": "extra", "contact_frames_wrong": "frames with other contacts"}
    found = [f"{agreement[name]:,} {text}" for name, text in names.items() if agreement.get(name)]
    return "WRONG: " + (", ".join(found) or "another answer")


def notes(record):
    """What a reader has to know of a cell's numbers, as one text."""
    sampling, conditions, chosen = record["sampling"], record["conditions"] or {}, record.get("chosen")
    found = [verdict(record),
             "not compared" if record["agreement"] is None and record["status"] == "ok" else "",
             "interrupted" if sampling["interrupted"] else "",
             "interval stayed wide" if sampling["converged"] is False else "",
             f"{len(conditions['disturbed'])} rounds disturbed" if conditions.get("disturbed") else "",
             f"chosen by {chosen['by']} of {chosen['of']}" if chosen else ""]
    return "; ".join(filter(None, found))
