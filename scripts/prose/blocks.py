# SPDX-License-Identifier: MIT
"""Texts of several lines, and where in a file each letter of them is; findings."""

import bisect
import collections
import itertools

Finding = collections.namedtuple("Finding", "rule path line what")


class Block:
    """Lines that are read as one text: a paragraph, a list item, a comment. kind: prose, heading, table or
    code in a page, else "". lines: (number, text) of each. `text` has them joined by blanks, and `starts`
    where each begins in it."""

    def __init__(self, kind, lines):
        self.kind = kind
        self.text = " ".join(text for _, text in lines)
        self._numbers = [number for number, _ in lines]
        self.starts = [0, *itertools.accumulate(len(text) + 1 for _, text in lines)][:-1]

    def line(self, position):
        """The number of the line that has the letter at this position of `text`."""
        return self._numbers[bisect.bisect_right(self.starts, position) - 1]


def blanked(pattern, text, fill=" "):
    """The text with `fill` in place of every letter that matches but the first group's, so that positions
    stay."""

    def blank(match):
        if not match.re.groups or match[1] is None:
            return fill * len(match[0])
        before, behind = match.start(1) - match.start(), match.end() - match.end(1)
        return fill * before + match[1] + fill * behind

    return pattern.sub(blank, text)
