# SPDX-License-Identifier: MIT
"""Short names of cells, made of the values in which they differ."""

import pandas

from . import names

METHOD = "method"  # of the columns algorithm and preset
NAMES = (METHOD, "device", "device_name", "scene", "first_frame", "last_frame")


def _texts(cells, name):
    if name == METHOD:
        methods = [names.method(*map(str, pair)) for pair in zip(cells["algorithm"], cells["preset"])]
        return pandas.Series(methods, index=cells.index)
    column = cells[name].map(names.scene) if name == "scene" else cells[name]
    words = column.astype(str).where(column.notna(), "")
    if not name.startswith("set_"):
        return words
    return words.where(words == "", name.removeprefix("set_") + "=" + words)


def labels(cells, without=()):
    """A text for each row of `cells` (from Records.cells). It has the names of NAMES and then settings, but
    only those that distinguish rows that the columns before do not. Leaves out columns `without`. Rows that
    do not differ have equal texts."""
    settings = [name for name in cells.columns if name.startswith("set_")]
    parts = pandas.Series("", index=cells.index)
    groups = pandas.Series(0, index=cells.index)
    for name in (*NAMES, *settings):
        if name in without:
            continue
        texts = _texts(cells, name)
        if not (texts.groupby(groups).nunique() > 1).any():
            continue
        separator = ", " if (parts + texts).str.contains(",").any() else " "
        parts = parts.where((parts == "") | (texts == ""), parts + separator) + texts
        groups = pandas.Series(list(zip(groups, texts)), index=cells.index).factorize()[0]
        groups = pandas.Series(groups, index=cells.index)
    return parts.where(parts != "", _texts(cells, METHOD))
