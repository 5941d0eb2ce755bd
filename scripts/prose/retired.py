# SPDX-License-Identifier: MIT
"""Retired words: a list of patterns, and where they stand."""

import functools
import re

from prose.blocks import Finding
from prose.errors import BadList
from prose.markdown import plain

SCOPES = ("identifier", "comment", "message", "page")
WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")


class Words:
    """The list in a file: a line has a regular expression, its scopes (with commas) and what to write
    instead, two blanks or more between them. Lines that begin with # are comments. Raises BadList."""

    def __init__(self, path):
        self._entries = {scope: [] for scope in SCOPES}
        for number, line in enumerate(
            path.read_text(encoding="utf-8").splitlines() if path.exists() else [], 1
        ):
            if line.strip() and not line.startswith("#"):
                try:
                    self._add(*re.split(r"\s{2,}", line.strip()))
                except (TypeError, KeyError, re.error) as problem:
                    raise BadList(
                        f"{path}:{number}: is no line of a pattern, its scopes and a replacement ({problem})"
                    ) from None
        self._in_name = functools.lru_cache(maxsize=None)(self._find_in_name)

    def _add(self, pattern, scopes, instead):
        for scope in scopes.split(","):
            flags = 0 if scope == "identifier" else re.IGNORECASE
            self._entries[scope].append((re.compile(pattern, flags), instead))

    def _find_in_name(self, name):
        # As it stands, and as its words: PassingFolder is "passing folder".
        forms = name, " ".join(WORD.findall(name)).lower()
        return next(
            (
                (found[0], instead)
                for pattern, instead in self._entries["identifier"]
                for form in forms
                if (found := pattern.search(form))
            ),
            None,
        )

    def _in_block(self, scope, path, block, text):
        for pattern, instead in self._entries[scope]:
            for match in pattern.finditer(text):
                yield Finding(
                    f"retired-{scope}", path, block.line(match.start()), f"'{match[0]}': write {instead}"
                )

    def in_page(self, page):
        """Findings in the prose, headings and tables of a page."""
        for block in page.blocks:
            if block.kind in ("prose", "heading", "table"):
                yield from self._in_block("page", page.path, block, plain(block.text))

    def in_names(self, source):
        """Findings among the identifiers of a source, and in its file's name."""
        stem = source.path.rsplit("/", 1)[-1].split(".")[0]
        if found := self._in_name(stem):
            yield Finding(
                "retired-identifier", source.path, 1, f"'{found[0]}' in the file's name: write {found[1]}"
            )
        for name, (line, count) in source.names.items():
            if found := self._in_name(name):
                times = f", {count} times" if count > 1 else ""
                yield Finding(
                    "retired-identifier",
                    source.path,
                    line,
                    f"'{found[0]}' in {name}{times}: write {found[1]}",
                )

    def in_comments(self, source):
        """Findings in the comments of a source."""
        for comment in source.comments:
            yield from self._in_block("comment", source.path, comment, comment.text)

    def in_messages(self, source):
        """Findings in the strings of a source; those of tests quote what users may give."""
        if not source.path.startswith("tests/"):
            for message in source.messages:
                yield from self._in_block("message", source.path, message, message.text)
