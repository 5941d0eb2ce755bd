# SPDX-License-Identifier: MIT
"""Rounds and formats numbers for the page."""


def rounded(value):
    """A number with six digits, which is more than the precision of times."""
    return float(f"{value:.6g}")


def ratio_row(ratio):
    """The value of a Ratio and the ends of its interval; None for None."""
    ends = ratio and (ratio.value, ratio.low, ratio.high)
    return ratio and [None if value is None else rounded(value) for value in ends]


def digits(value):
    """The text of a ratio or of milliseconds, with at most three decimals for values of at least 0.1."""
    decimals = 5 if value < 0.01 else 4 if value < 0.1 else 3 if value < 10 else 1 if value < 100 else 0
    return f"{value:.{decimals}f}"


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)
