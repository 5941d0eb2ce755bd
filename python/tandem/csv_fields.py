# SPDX-License-Identifier: MIT
"""Fields of CSV files that a spreadsheet does not take for formulas, and that a terminal does not obey."""

import re

from .text_lines import visible

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_FORMULA = ("=", "+", "-", "@", "\t", "\r")


def text_field(text):
    """A text with an apostrophe before it if a spreadsheet could take it for a formula, and with control
    characters as escapes."""
    return visible(f"'{text}" if text.startswith(_FORMULA) else text)


def field(value):
    """A value of a table of texts and numbers. Numbers, also as texts, stay as they are."""
    return text_field(value) if isinstance(value, str) and not _NUMBER.fullmatch(value) else value


def fields(row):
    """A dictionary with every value as field()."""
    return {name: field(value) for name, value in row.items()}
