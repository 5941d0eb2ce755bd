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
    """The text of a ratio or of milliseconds, with three digits, as `tandem run` writes them, or whole."""
    return f"{value:,.0f}" if value >= 999.5 else f"{value:#.3g}".rstrip(".")


def ratio_digits(ratio):
    """Texts of the value of a Ratio and of the ends of its interval. They have more digits where the interval excludes 1 by
    so little that they would show 1."""
    values = ratio.value, ratio.low, ratio.high
    near = min(abs(value - 1) for value in values)
    if near >= 0.005 or not (ratio.low > 1 or ratio.high < 1):
        return [*map(digits, values)]
    return [f"{value:.{3 if near >= 0.0005 else 4}f}" for value in values]


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def ends_text(values):
    """ "0.8 to 2", or one text if both ends have it."""
    ends = list(dict.fromkeys((values[0], values[-1])))
    return " to ".join(ends)
