# SPDX-License-Identifier: MIT
"""Sources as comments, identifiers and messages (strings), by their tokens."""

import bisect
import re

from prose.blocks import Block, Finding

STRING = r""""(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'"""
TRIPLE = r""""{3}(?:\\.|[^\\])*?"{3}|'{3}(?:\\.|[^\\])*?'{3}"""
NAME = r"(?P<name>[A-Za-z_]\w*)"
# Numbers stand before strings, since their digits may be parted by quotes. The value of #define is read on
# its own.
C_LIKE = re.compile(
    r"(?P<comment>//(?:\\\n|[^\n])*|/\*.*?\*/)|(?P<number>#\s*include[^\n]*|\.?\d(?:'?[\w.])*)"
    rf'|(?P<text>R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)"|{STRING}|`(?:\\.|[^`\\])*`)|{NAME}',
    re.DOTALL,
)
PYTHON = re.compile(
    rf"(?P<comment>#[^\n]*)|(?P<number>\.?\d[\w.]*)|[rRbBfFuU]{{0,2}}(?P<text>{TRIPLE}|{STRING})|{NAME}",
    re.DOTALL,
)
HASHED = re.compile(r"(?m)(?:^|(?<=\s))(?P<comment>#(?!!)[^\n]*)")

MARKER = re.compile(r"""^\s*(?:///?<?|/\*\*?<?|\*(?!/)|#+|"{3}|'{3})?\s?""")
SENTENCE_OF = re.compile(r"[.?!]\s+\(?(?=Of\s)")


def language(path, text):
    """The pattern of the tokens of a file, and whether its identifiers count; None where it is no source."""
    name = path.rsplit("/", 1)[-1]
    if name.endswith((".cpp", ".h", ".cl", ".clh", ".js")):
        return C_LIKE, not name.endswith(".js")
    if name.endswith((".py", ".pyi")) or re.match(r"#!\S*[ /]python", text):
        return PYTHON, True
    if name.endswith((".cmake", ".sh", ".bash")) or name == "CMakeLists.txt" or text.startswith("#!"):
        return HASHED, False
    return None


class Source:
    """A file's comments and messages, as blocks, and of each identifier the line of the first and how many
    there are."""

    def __init__(self, path, text):
        self.path, self.comments, self.messages, self.names = path, [], [], {}
        self._text = text
        self._starts = [0, *(match.end() for match in re.finditer("\n", text))]
        self._gathered, self._end = [], 0  # comments in lines that follow each other are one
        pattern, has_names = language(path, text)
        for match in pattern.finditer(text):
            self._take(match.lastgroup, match, has_names)
        self._end_comment()

    def _take(self, kind, match, has_names):
        if kind == "comment":
            self._add_comment(match)
        elif kind == "name" and has_names:
            line, count = self.names.get(match[0], (self._line(match.start()), 0))
            self.names[match[0]] = line, count + 1
        elif kind in ("text", "mark"):
            if self._is_docstring(match):
                self._end_comment()
                self._add_comment(match)
                self._end_comment()
            else:
                self.messages.append(Block("", self._lines(match)))

    def _line(self, position):
        return bisect.bisect_right(self._starts, position)

    def _lines(self, match):
        return list(enumerate(match[0].split("\n"), self._line(match.start())))

    def _is_docstring(self, match):
        """Whether a text with three quotes is a statement of its own."""
        if match["text"][:3] not in ('"""', "'''"):
            return False
        before = self._text[self._starts[self._line(match.start()) - 1] : match.start()]
        return not before.strip() and not self._text[: match.start()].rstrip().endswith(
            ("(", ",", "=", "[", "{", "+")
        )

    def _add_comment(self, match):
        between = self._text[self._end : match.start()]
        if between.strip() or between.count("\n") != 1:
            self._end_comment()
        self._gathered += [(number, MARKER.sub("", line, count=1)) for number, line in self._lines(match)]
        self._end = match.end()

    def _end_comment(self):
        if self._gathered:
            self.comments.append(Block("", self._gathered))
        self._gathered = []


def of(source):
    """Findings of comments, and sentences in them, that begin with "Of"."""
    for comment in source.comments:
        begun = [start for start in comment.starts if comment.text.startswith("Of ", start)]
        for at in sorted({*begun, *(match.end() for match in SENTENCE_OF.finditer(comment.text))}):
            yield Finding(
                "of",
                source.path,
                comment.line(at),
                f"a comment begins with Of: {comment.text[at : at + 40].strip()} ...",
            )
