# SPDX-License-Identifier: MIT
"""What ends scripts/external with exit code 2."""


class BadData(Exception):
    """Files, options or a program that cannot be used; the text is one line."""
