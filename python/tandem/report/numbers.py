# SPDX-License-Identifier: MIT
"""Numbers as the page has them, and values of records that have to be of one type: what is another raises TypeError."""


def rounded(value):
    """Six digits: more than any time has."""
    return float(f"{value:.6g}")


def digits(value):
    """The text of a ratio or of milliseconds: three digits after the point at most, but for what is less than 0.1."""
    decimals = 5 if value < 0.01 else 4 if value < 0.1 else 3 if value < 10 else 1 if value < 100 else 0
    return f"{value:.{decimals}f}"


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def number(value):
    if not is_number(value):
        raise TypeError(f"{value!r} is no number")
    return value


def count(value):
    if not isinstance(value, int) or isinstance(value, bool) or value < 0:
        raise TypeError(f"{value!r} is no count")
    return value


def text(value):
    if not isinstance(value, str):
        raise TypeError(f"{value!r} is no text")
    return value
