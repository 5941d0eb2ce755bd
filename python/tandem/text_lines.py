# SPDX-License-Identifier: MIT
"""Formats text for a terminal where each character is one column wide."""

COLUMNS = 100


def wrap(text, width):
    """Lines of at most `width` characters; at least one. Breaks at spaces, and inside words that are longer than a line."""
    lines = []
    while len(text) > width:
        space = text.rfind(" ", 0, width + 1)
        end = space if space > 0 else width
        lines.append(text[:end])
        text = text[end:].lstrip(" ")
    return [*lines, text]


def paragraph(text, indent):
    """Lines of at most COLUMNS characters with their ends. All lines after the first begin with `indent` spaces."""
    first = wrap(text, COLUMNS)[0]
    rest = text[len(first):].lstrip(" ")
    more = wrap(rest, COLUMNS - indent) if rest else []
    return "".join(f"{line}\n" for line in (first, *(" " * indent + line for line in more)))


def visible(text):
    """A text in one line, with control characters as escapes."""
    names = {"\n": "\\n", "\t": "\\t"}
    return "".join(names.get(c) or f"\\x{ord(c):02x}" if c < " " or c == "\x7f" else c for c in text)


def one_line(text, length):
    """A text in one line, with control characters as spaces, cut after `length` characters."""
    text = "".join(" " if character < " " or character == "\x7f" else character for character in text)
    return text if len(text) <= length else f"{text[:length]}..."


def table(rows, left):
    """Rows of texts as aligned columns with two spaces between, at most COLUMNS wide. `left`: numbers of the columns that are aligned to the
    left. The first column gets the remaining width. A longer text is written on a line above its row."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    rest = sum(width + 2 for width in widths[1:])
    widths[0] = min(widths[0], max(8, COLUMNS - rest))
    text = ""
    for row in rows:
        fits = len(row[0]) <= widths[0]
        if not fits:
            text += paragraph(row[0], 2)
        cells = [row[0] if fits else "", *row[1:]]
        aligned = [cell.ljust(width) if column in left else cell.rjust(width) for column, (cell, width) in enumerate(zip(cells, widths))]
        text += "  ".join(aligned).rstrip(" ") + "\n"
    return text
