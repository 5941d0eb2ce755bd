# SPDX-License-Identifier: MIT
"""Formats numbers for the page, and checks types of values of records: a wrong type raises TypeError."""


def rounded(value):
    """A number with six digits, which is more than the precision of times."""
    return float(f"{value:.6g}")


def optional(value):
    return None if value is None else rounded(value)


def digits(value):
    """The text of a ratio or of milliseconds, with at most three decimals for values of at least 0.1."""
    decimals = 5 if value < 0.01 else 4 if value < 0.1 else 3 if value < 10 else 1 if value < 100 else 0
    return f"{value:.{decimals}f}"


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def number(value):
    if not is_number(value):
        raise TypeError(f"{value!r} is not a number")
    return value


def count(value):
    if not isinstance(value, int) or isinstance(value, bool) or value < 0:
        raise TypeError(f"{value!r} is not a count")
    return value


def text(value):
    if not isinstance(value, str):
        raise TypeError(f"{value!r} is not a text")
    return value
