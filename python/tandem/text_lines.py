# SPDX-License-Identifier: MIT
"""Text in lines of a terminal: a character is one column wide."""

COLUMNS = 100


def wrap(text, width):
    """Lines of at most `width` characters, broken at spaces, and inside words that are longer; at least one line."""
    lines = []
    while len(text) > width:
        space = text.rfind(" ", 0, width + 1)
        end = space if space > 0 else width
        lines.append(text[:end])
        text = text[end:].lstrip(" ")
    return [*lines, text]


def paragraph(text, indent):
    """Lines of COLUMNS, each with its end; those after the first begin with `indent` spaces."""
    first = wrap(text, COLUMNS)[0]
    rest = text[len(first):].lstrip(" ")
    more = wrap(rest, COLUMNS - indent) if rest else []
    return "".join(f"{line}\n" for line in (first, *(" " * indent + line for line in more)))


def visible(text):
    """A text in one line: control characters become escapes."""
    names = {"\n": "\\n", "\t": "\\t"}
    return "".join(names.get(c) or f"\\x{ord(c):02x}" if c < " " or c == "\x7f" else c for c in text)


def one_line(text, most):
    """A text in one line: control characters become spaces, and what is longer than `most` characters is cut."""
    text = "".join(" " if character < " " or character == "\x7f" else character for character in text)
    return text if len(text) <= most else f"{text[:most]}..."


def table(rows, left):
    """Rows of texts in columns, two spaces between, in COLUMNS. `left` has the numbers of the columns that are aligned to the left. The
    first column takes what the others leave; a text too long for it stands in a line above its row."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    others = sum(width + 2 for width in widths[1:])
    widths[0] = min(widths[0], max(8, COLUMNS - others))
    text = ""
    for row in rows:
        fits = len(row[0]) <= widths[0]
        if not fits:
            text += paragraph(row[0], 2)
        cells = [row[0] if fits else "", *row[1:]]
        aligned = [cell.ljust(width) if column in left else cell.rjust(width) for column, (cell, width) in enumerate(zip(cells, widths))]
        text += "  ".join(aligned).rstrip(" ") + "\n"
    return text
