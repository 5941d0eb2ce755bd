# SPDX-License-Identifier: MIT
"""Formats text for a terminal where each character is one column wide, and in pages."""

import json
import re

COLUMNS = 100


def wrap(text, width):
    """Lines of at most `width` characters; at least one. Breaks at spaces, and inside words that are longer
    than a line."""
    lines = []
    while len(text) > width:
        space = text.rfind(" ", 0, width + 1)
        end = space if space > 0 else width
        lines.append(text[:end])
        text = text[end:].lstrip(" ")
    return [*lines, text]


def paragraph(text, indent):
    """Lines of at most COLUMNS characters with their ends. All lines after the first begin with `indent`
    spaces."""
    first = wrap(text, COLUMNS)[0]
    rest = text[len(first) :].lstrip(" ")
    more = wrap(rest, COLUMNS - indent) if rest else []
    return "".join(f"{line}\n" for line in (first, *(" " * indent + line for line in more)))


# C0, C1, marks of direction (Unicode Bidi_Control), separators of lines and paragraphs, and bytes of C1 that
# are not UTF-8, as Python reads them.
_CONTROL = re.compile(
    "[\\x00-\\x1f\\x7f-\\x9f\\u061c\\u200e\\u200f\\u2028-\\u202e\\u2066-\\u2069\\udc80-\\udc9f]"
)
_NAMES = {"\n": "\\n", "\t": "\\t"}


def _escape(character):
    code = ord(character)
    byte = code - 0xDC00 if code >= 0xDC80 else code
    return _NAMES.get(character) or (f"\\x{byte:02x}" if code < 0x20 or code >= 0xDC80 else f"\\u{code:04x}")


def visible(text, kept=""):
    """A text in one line, with control characters as escapes, as base/text_lines.h has them. Characters in
    `kept` stay."""
    return _CONTROL.sub(lambda found: found[0] if found[0] in kept else _escape(found[0]), text)


def visible_json(text):
    """The same of a JSON text: of the characters in its strings, not of their escapes."""

    def shown(found):
        is_escape = found[0][0] == "\\"
        character = json.loads(f'"{found[0]}"') if is_escape else found[0]
        is_part = is_escape and "\ud800" <= character <= "\udfff"  # of a pair that is one character
        return (
            json.dumps(visible(character))[1:-1]
            if _CONTROL.fullmatch(character) and not is_part
            else found[0]
        )

    return re.sub(r"\\u[0-9a-fA-F]{4}|\\.|" + _CONTROL.pattern, shown, text)


def one_line(text, length):
    """A text in one line, with control characters as spaces, cut after `length` characters."""
    text = _CONTROL.sub(" ", text)
    return text if len(text) <= length else f"{text[:length]}..."


def table(rows, left):
    """Rows of texts as aligned columns with two spaces between, at most COLUMNS wide. `left`: numbers of the
    columns that are aligned to the left. The first column gets the remaining width. A longer text is written
    on a line above its row."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    rest = sum(width + 2 for width in widths[1:])
    widths[0] = min(widths[0], max(8, COLUMNS - rest))
    text = ""
    for row in rows:
        fits = len(row[0]) <= widths[0]
        if not fits:
            text += paragraph(row[0], 2)
        cells = [row[0] if fits else "", *row[1:]]
        aligned = [
            cell.ljust(width) if column in left else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(cells, widths))
        ]
        text += "  ".join(aligned).rstrip(" ") + "\n"
    return text
