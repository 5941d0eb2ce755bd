# SPDX-License-Identifier: MIT
"""Warnings at the line that called the package."""

import sys
import warnings


def warn(text):
    """A UserWarning at the innermost line of the call stack that is not the package's."""
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and frame.f_globals.get("__package__") == __package__:
        frame, level = frame.f_back, level + 1
    warnings.warn(text, stacklevel=level)
