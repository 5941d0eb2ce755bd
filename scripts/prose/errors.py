# SPDX-License-Identifier: MIT
"""What ends check_prose with exit code 2."""


class BadUse(Exception):
    """Options, a folder or a program that are no good."""


class BadList(BadUse):
    """A line of a list of this folder that is no good."""
