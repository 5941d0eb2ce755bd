# SPDX-License-Identifier: MIT
"""Exceptions that end commands of the program that are written in Python."""


class BadUse(ValueError):
    """Bad use or bad input. The message is one line: what is wrong and what to do. The command exits with 2."""


class OutputError(OSError):
    """Output that could not be written. The message is one line: which output, and why. The command exits
    with 3."""
