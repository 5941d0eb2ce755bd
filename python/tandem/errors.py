# SPDX-License-Identifier: MIT
"""What ends a command of the program that is written in Python."""


class BadUse(ValueError):
    """One line: what is wrong, and what to do. The command ends with 2."""


class OutputError(OSError):
    """One line: what could not be written, and why. The command ends with 3."""
