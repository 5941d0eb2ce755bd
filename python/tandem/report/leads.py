# SPDX-License-Identifier: MIT
"""The verdict on cells in words, made once and used by sentences, titles and tables of the page."""

import dataclasses

from .numbers import digits

ONE_ROUND = "one round: no interval"


@dataclasses.dataclass(frozen=True)
class Named:
    """A ranked cell. ranked: its verdicts.Ranked; name: its text; ms: its milliseconds a frame."""

    ranked: object
    name: str
    ms: float


def interval_text(ratio, has_interval):
    return f"[{digits(ratio.low)}, {digits(ratio.high)}]" if has_interval else f"({ONE_ROUND})"


def compared_text(ranked):
    """How long a cell takes, compared with the first: a part of a sentence."""
    ratio, interval = ranked.ratio, interval_text(ranked.ratio, ranked.has_interval)
    if ranked.has_interval and not ranked.is_told_apart:
        return f"is not told apart from it ({digits(ratio.value)} times its time {interval})"
    return f"takes {digits(ratio.value)} times as long {interval}"


def _is_the_fastest(cells):
    """Whether the second takes longer with its whole interval. Paired ratios below 1 are possible: order is
    by medians."""
    return len(cells) > 1 and cells[1].ranked.is_told_apart and cells[1].ranked.ratio.low > 1


def which_text(cells):
    """What the first of Named cells is, to be put behind its name: ", the fastest"."""
    lead = ", the fastest" if _is_the_fastest(cells) else ", which leads"
    return lead if len(cells) > 1 else ""


def lead_sentence(cells, of=""):
    """The sentence on Named cells, the fastest first. `of`: text behind their number, such as " values"."""
    first, *rest = cells
    if not rest:
        return f"{first.name} takes {digits(first.ms)} ms a frame; there is nothing to compare it with."
    lead = "is the fastest" if _is_the_fastest(cells) else "leads"
    return f"{first.name} {lead} of {len(cells)}{of} with {digits(first.ms)} ms a frame; the next, {rest[0].name}, {compared_text(rest[0].ranked)}."


def title(cells, answers_differ):
    """The title of a chart of Named cells."""
    if answers_differ:
        return "Answers differ: these times are of different work"
    if not cells:
        return "None of these cells has valid times"
    first, *rest = cells
    if not rest:
        return f"{first.name} takes {digits(first.ms)} ms a frame"
    second = rest[0].ranked
    than = f"{digits(second.ratio.value)} times as long {interval_text(second.ratio, second.has_interval)}"
    if second.has_interval and not second.is_told_apart:
        return f"{first.name} and the next are not told apart: {than}"
    lead = "is the fastest" if _is_the_fastest(cells) else "leads"
    return f"{first.name} {lead}; the next takes {than}"
