# SPDX-License-Identifier: MIT
"""Tables of pages. On a narrow screen each row becomes a card, with the headings beside its values; a wide table
scrolls instead."""

import dataclasses

from .markup import Html, breakable, element, link, paragraphs


@dataclasses.dataclass(frozen=True)
class Column:
    """name: the heading. is_number: values are aligned to the right. style: class of its values. has_choice:
    a table that sorts offers a choice among its values."""

    name: str
    is_number: bool = False
    style: str = ""
    has_choice: bool = False


@dataclasses.dataclass(frozen=True)
class Row:
    """anchor: id of the row. more: Html of a row below, which is shown if the <details> of the first value are open."""

    values: list
    style: str = ""
    anchor: str = ""
    more: Html | None = None


def number_text(value):
    """A number with about four digits, as page.js writes it."""
    if value is None:
        return ""
    size = abs(value)
    if size and (size >= 1e7 or size < 1e-4):
        digits, _, exponent = f"{value:.2e}".partition("e")
        return f"{digits.rstrip('0').rstrip('.')}e{int(exponent):+d}"
    return f"{value:,.0f}" if size >= 1000 else f"{value:.4g}"


def _value(column, value, is_wide):
    is_number = column.is_number or isinstance(value, (int, float))
    style = " ".join(filter(None, ("number" if is_number else "", column.style)))
    text = number_text(value) if isinstance(value, (int, float)) else value
    return element("td", breakable(text), class_=style, data_label=None if is_wide else column.name)


def _row(columns, row, is_wide):
    row = row if isinstance(row, Row) else Row(row)
    values = [_value(column, value, is_wide) for column, value in zip(columns, row.values)]
    more = None
    if row.more is not None:
        more = element("tr", element("td", row.more, colspan=len(columns)), class_="more")
    return [element("tr", values, class_=row.style, id=row.anchor), more]


def _head(column):
    styles = ("number" if column.is_number else "", "choice" if column.has_choice else "")
    return element("th", breakable(column.name), scope="col", class_=" ".join(filter(None, styles)))


def table(label, columns, rows, *, heading=True, notes=(), csv="", anchor="", sorts=False, is_wide=False):
    """A table in a part of the page. `label`: what it is, also its heading if `heading`. `columns`: Columns,
    or names of columns of texts. `rows`: Rows, or lists of values. `csv`: file with the same numbers.
    `sorts`: page.js lets readers sort and filter it; each row is a body of its own for this. `is_wide`: on a narrow
    screen it stays a table, whose first column stays in sight while the others scroll."""
    columns = [column if isinstance(column, Column) else Column(column) for column in columns]
    shown = [_row(columns, row, is_wide) for row in rows]
    return element(
        "section",
        element("h3", label) if heading else None,
        paragraphs(notes, "quiet"),
        element(
            "div",
            element(
                "table",
                element("thead", element("tr", [_head(column) for column in columns])),
                [element("tbody", row) for row in shown] if sorts else element("tbody", shown),
                class_=" ".join(filter(None, ("sorts" if sorts else "", "wide" if is_wide else ""))),
            ),
            class_="scrolls",
            tabindex=0,
            role="group",
            aria_label=label,
        ),
        element("p", link(csv)) if csv else None,
        id=anchor,
    )
