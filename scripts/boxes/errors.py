# SPDX-License-Identifier: MIT
"""What ends a script."""


class BadData(Exception):
    """Files, options or a program that cannot be used; the text is one line. `code`: the exit code."""

    def __init__(self, text, code=2):
        super().__init__(text)
        self.code = code
