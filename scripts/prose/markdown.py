# SPDX-License-Identifier: MIT
"""Pages (Markdown) as blocks, and what of a block is prose."""

import re

from prose.blocks import Block, blanked

COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
FRONT_MATTER = re.compile(r"\A---\n.*?\n---\n", re.DOTALL)
FENCE = re.compile(r"\s*(`{3,}|~{3,})")
HEADING = re.compile(r"#{1,6}\s+(.*?)\s*#*$")
UNDERLINE = re.compile(r" {0,3}(=+|-{2,})\s*$")
RULE = re.compile(r" {0,3}([-*_])(\s*\1){2,}\s*$")
ITEM = re.compile(r"(\s*(?:[-*+]|\d+[.)])\s+)(?:\[[ xX]\]\s+)?")
QUOTE = re.compile(r"\s*(?:>\s?)+")
DEFINITION = re.compile(r" {0,3}\[[^\]]+\]:\s")

CODE = re.compile(r"(`+)(?!`).+?(?<!`)\1(?!`)")
IMAGE = re.compile(r"!\[[^\]]*\]\([^)]*\)")
LINK = re.compile(r"\[([^\[\]]*)\](?:\([^)]*\)|\[[^\]]*\])")
ADDRESS = re.compile(r"<?https?://[^\s)>]*[^\s)>.,;:]>?")
TAG = re.compile(r"</?[a-zA-Z][^<>]*>")


class _Reader:
    """Goes through the lines of a page and gathers blocks."""

    def __init__(self):
        self.blocks = []
        self._kind, self._lines = "", []
        self._fence = ""  # what ends the code
        self._blank = True  # whether the line before had nothing, or was code by its indentation
        self._indent = 0  # of the text of the list item that lines may belong to

    def end(self):
        if self._lines:
            self.blocks.append(Block(self._kind, self._lines))
        self._lines = []

    def _add(self, kind, number, text):
        if kind != self._kind or kind == "heading":
            self.end()
        self._kind = kind
        self._lines.append((number, text))

    def read(self, number, line):
        fence = FENCE.match(line)
        if self._fence:
            if fence and fence[1].startswith(self._fence) and not line.strip(" `~"):
                self._fence = ""
                self.end()
            else:
                self.blocks.append(Block("code", [(number, line)]))
        elif fence:
            self._fence = fence[1]
            self.end()
        elif not line.strip():
            self.end()
            self._blank = True
        elif self._blank and self._is_indented(line):
            self.blocks.append(Block("code", [(number, line)]))
        else:
            self._read_text(number, line)
            self._blank = False

    def _is_indented(self, line):
        indent = len(line.expandtabs(4)) - len(line.expandtabs(4).lstrip())
        if indent < self._indent and not ITEM.match(line):
            self._indent = 0
        return indent >= self._indent + 4

    def _read_text(self, number, line):
        heading, item = HEADING.match(line), ITEM.match(line)
        if heading:
            self._indent = 0
            self._add("heading", number, heading[1])
        elif UNDERLINE.match(line) and self._lines and self._kind == "prose":
            self._kind = "heading"
            self.end()
        elif RULE.match(line):
            self.end()
        elif line.lstrip().startswith("|"):
            self._add("table", number, line)
        else:
            if item:
                self.end()
                self._indent = len(item[1])
            text = line[item.end() :] if item else line
            self._add("definition" if DEFINITION.match(line) else "prose", number, QUOTE.sub("", text))


def blocks(text):
    """Blocks of a page in order: kind prose (a paragraph or a list item), heading, table, definition (of a
    link), code (a line each). HTML comments and what stands before a page (---) are left out."""
    keep_lines = lambda match: re.sub(r"[^\n]", "", match[0])
    reader = _Reader()
    for number, line in enumerate(FRONT_MATTER.sub(keep_lines, COMMENT.sub(keep_lines, text)).split("\n"), 1):
        reader.read(number, line)
    reader.end()
    return reader.blocks


def without_code(text):
    """The text with a word of as many letters in place of each piece of inline code."""
    return CODE.sub(lambda match: "C" * len(match[0]), text)


def plain(text):
    """What a reader sees of a block's text, at the same positions; inline code and addresses are a word each."""
    text = blanked(IMAGE, without_code(text))
    while (shorter := blanked(LINK, text)) != text:
        text = shorter
    return blanked(TAG, blanked(ADDRESS, text, "C"))
