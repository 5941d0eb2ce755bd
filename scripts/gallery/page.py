# SPDX-License-Identifier: MIT
"""The page: one table for each group of comparable cells, without scripts."""

from tandem.pages.frame import Page, Section, html_of
from tandem.pages.markup import element, items, paragraphs
from tandem.pages.tables import Column, Row, table
from tandem.report.cells import commit, interval
from tandem.report.conditions import conditions_text, sampling_text
from tandem.report.groups import groups_of
from tandem.report.leads import ratio_text
from tandem.report.numbers import digits
from tandem.report.sentences import group_sentences, summary_sentences

COLUMNS = (
    Column("rank"),
    Column("cell"),
    *(Column(name, True) for name in ("ms per frame [95 %]", "times the first", "candidate pairs")),
    *map(Column, ("conditions", "sampling", "commit", "record")),
)
FOOTER = "Made by scripts/results-page of tandem, under the MIT license. The page contains no work of others."
STYLE = "tr.unranked td { color: var(--quiet); }\n"


def _time(cell):
    time = interval(cell)
    return (
        ""
        if time is None or not cell.rounds
        else f"{digits(cell.median_ms)} [{digits(time[1])}, {digits(time[2])}]"
    )


def _row(source, rank, label, ratio=""):
    cell = source.cell
    values = [
        rank,
        label,
        _time(cell),
        ratio,
        f"{cell.pairs.count:,}" if cell.pairs else "",
        conditions_text(cell.record),
        sampling_text(cell.record),
        commit(cell),
        f"{source.place}{', submitted' if source.is_submitted else ''}",
    ]
    return Row(values, style="" if rank.isdigit() else "unranked")


def _group(group, sources):
    """The sentences and the table of a group: ranked cells, then those that failed or are wrong."""
    labels = dict(zip(group.cells, group.labels))
    ranked = [] if group.answers_differ else group.ranked
    rows = [
        _row(
            sources[one.cell],
            str(rank),
            labels[one.cell],
            ratio_text(one.ratio, one.has_interval) if rank > 1 else "",
        )
        for rank, one in enumerate(ranked, 1)
    ]
    shown = {one.cell for one in ranked}
    for number in group.cells:
        cell = sources[number].cell
        if number not in shown and not cell.is_older:
            state = "answers differ" if cell.status == "ok" else cell.status
            rows.append(_row(sources[number], state, labels[number]))
    sentence = group_sentences(group, [source.cell for source in sources])
    return table(group.title, COLUMNS, rows, notes=[sentence])


def _summary(sources, groups):
    submitted = sum(source.is_submitted for source in sources)
    count = f"{len(sources)} records of cells, {submitted} of them submitted. Cells of one table do the same work on the same devices."
    return paragraphs([count, *summary_sentences(groups, [source.cell for source in sources])])


def page_of(sources, unchecked, refused):
    """The text of the page. unchecked: places of records that are shown apart and not ranked; refused:
    messages about submitted lines."""
    compared = [source for source in sources if source.place not in unchecked]
    apart = [source for source in sources if source.place in unchecked and not source.cell.is_older]
    groups = sorted(groups_of([source.cell for source in compared]), key=lambda group: group.title)
    rows = [_row(source, "not compared", source.cell.key) for source in apart]
    note = "Nothing checks these answers, so that they are not ranked."
    sections = [
        Section("summary", "Summary", _summary(sources, groups)),
        Section("refused", "Refused lines", items(refused) if refused else None),
        Section("compared", "Comparisons", [_group(group, compared) for group in groups]),
        Section(
            "apart",
            "Not compared",
            rows and table("Not compared", COLUMNS, rows, heading=False, notes=[note]),
        ),
    ]
    sections = [section for section in sections if section.content]
    return html_of(Page("Results of tandem", sections, footer=element("p", FOOTER), style=STYLE))
