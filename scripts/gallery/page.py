# SPDX-License-Identifier: MIT
"""The HTML of the page: one table for each group of comparable cells, without scripts."""

import html

from tandem.report.conditions import conditions_text, sampling_text
from tandem.report.groups import groups_of
from tandem.report.leads import interval_text
from tandem.report.numbers import digits
from tandem.report.sentences import group_sentences, summary_sentences
from tandem.report.rows import commit, interval
from tandem.text_lines import visible

HEAD = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>Results of tandem</title>
<style>
body { font: 15px/1.5 system-ui, sans-serif; max-width: 80rem; margin: 1rem auto; padding: 0 1rem }
table { border-collapse: collapse; display: block; overflow-x: auto }
th, td { padding: .15rem .6rem; border-bottom: 1px solid #8888; text-align: left; vertical-align: top }
td.number { text-align: right; white-space: nowrap }
tr.unranked td { opacity: .75 }
</style>
</head>
<body>
<h1>Results of tandem</h1>
"""
COLUMNS = (
    "",
    "cell",
    "ms a frame [95 %]",
    "times the first",
    "candidate pairs",
    "conditions",
    "sampling",
    "commit",
    "record",
)


def escaped(text):
    """A text of a record in one line, safe in HTML."""
    return html.escape(visible(str(text)))


def _time(cell):
    time = interval(cell)
    return (
        ""
        if time is None or not cell.rounds
        else f"{digits(cell.median_ms)} [{digits(time[1])}, {digits(time[2])}]"
    )


def _row(source, rank, label, ratio):
    cell = source.cell
    place = f"{source.place}{', submitted' if source.is_submitted else ''}"
    pairs = cell.pairs.count if cell.pairs else ""
    texts = [
        rank,
        label,
        _time(cell),
        ratio,
        f"{pairs:,}" if pairs != "" else "",
        conditions_text(cell.record),
        sampling_text(cell.record),
        commit(cell),
        place,
    ]
    cells = "".join(
        f"<td{' class=number' if number in (2, 3, 4) else ''}>{escaped(text)}</td>"
        for number, text in enumerate(texts)
    )
    return f"<tr{'' if rank.isdigit() else ' class=unranked'}>{cells}</tr>\n"


def _table(rows):
    head = "".join(f"<th scope=col>{name}</th>" for name in COLUMNS)
    return f"<table>\n<tr>{head}</tr>\n{''.join(rows)}</table>\n"


def _group(group, sources):
    """The sentences and the table of a group: ranked cells, then those that failed or are wrong."""
    labels = dict(zip(group.cells, group.labels))
    rows = []
    if not group.answers_differ:
        rows = [
            _row(
                sources[one.cell],
                str(rank),
                labels[one.cell],
                f"{digits(one.ratio.value)} {interval_text(one.ratio, one.has_interval)}" if rank > 1 else "",
            )
            for rank, one in enumerate(group.ranked, 1)
        ]
    ranked = {one.cell for one in group.ranked} if rows else set()
    rest = [number for number in group.cells if number not in ranked and not sources[number].cell.is_older]
    states = {number: sources[number].cell.status for number in rest}
    rows += [
        _row(sources[number], "answers differ" if state == "ok" else state, labels[number], "")
        for number, state in states.items()
    ]
    sentence = group_sentences(group, [source.cell for source in sources])
    return (
        f"<section>\n<h2>{escaped(group.title)}</h2>\n<p>{escaped(sentence)}</p>\n{_table(rows)}</section>\n"
    )


def html_of(sources, unchecked, refused):
    """The page. unchecked: places of records that are shown apart and not ranked; refused: messages about
    submitted lines."""
    compared = [source for source in sources if source.place not in unchecked]
    apart = [source for source in sources if source.place in unchecked and not source.cell.is_older]
    cells = [source.cell for source in compared]
    groups = sorted(groups_of(cells), key=lambda group: group.title)
    submitted = sum(source.is_submitted for source in sources)
    text = (
        HEAD
        + f"<p>{len(sources)} records of cells, {submitted} of them submitted. Cells of one table do the same work on the same devices.</p>\n"
    )
    text += "".join(f"<p>{escaped(sentence)}</p>\n" for sentence in summary_sentences(groups, cells))
    if refused:
        text += (
            "<section>\n<h2>Refused lines</h2>\n<ul>\n"
            + "".join(f"<li>{escaped(one)}</li>\n" for one in refused)
            + "</ul>\n</section>\n"
        )
    text += "".join(_group(group, compared) for group in groups)
    if apart:
        rows = [_row(source, "not compared", f"{source.cell.key}", "") for source in apart]
        text += f"<section>\n<h2>Not compared</h2>\n<p>Nothing checks these answers, so that they are not ranked.</p>\n{_table(rows)}</section>\n"
    return (
        text
        + "<footer><p>Made by scripts/results-page of tandem, under the MIT license. The page contains no work of others.</p></footer>\n</body>\n</html>\n"
    )
