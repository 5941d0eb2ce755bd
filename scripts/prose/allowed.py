# SPDX-License-Identifier: MIT
"""Findings that are allowed, each for a reason."""

import fnmatch
import re

from prose.blocks import Finding
from prose.errors import BadList

MOST = 40
NAME = "scripts/prose/allowed.txt"


class Allowed:
    """The list in a file: a line has a rule, a path (with * and ?), a part of the finding's text and a
    reason, two blanks or more between them. Lines that begin with # are comments. Raises BadList."""

    def __init__(self, path):
        self._entries = []
        for number, line in enumerate(
            path.read_text(encoding="utf-8").splitlines() if path.exists() else [], 1
        ):
            if line.strip() and not line.startswith("#"):
                fields = re.split(r"\s{2,}", line.strip())
                if len(fields) != 4:
                    raise BadList(f"{path}:{number}: is no line of a rule, a path, a text and a reason")
                self._entries.append((number, *fields[:3]))
        self._used = set()

    def has(self, finding):
        """Whether the finding is allowed."""
        for number, rule, path, text in self._entries:
            if rule == finding.rule and text in finding.what and fnmatch.fnmatchcase(finding.path, path):
                self._used.add(number)
                return True
        return False

    def findings(self, rules):
        """Findings of the list itself: too many entries, and entries that allow nothing. rules: those that
        were checked."""
        if len(self._entries) > MOST:
            yield Finding(
                "allowed", NAME, self._entries[MOST][0], f"{len(self._entries)} entries (at most {MOST})"
            )
        for number, rule, *_ in self._entries:
            if rule in rules and number not in self._used:
                yield Finding("allowed", NAME, number, "allows nothing: delete it")
