# SPDX-License-Identifier: MIT
"""Markdown tables, and pages with tables that are written from records."""

import pathlib
import re

from .errors import BadUse, OutputError


def table(heads, rows, numeric=False):
    """A table as lines with their ends. `numeric`: aligns all columns except the first to the right."""
    line = lambda cells: (
        "| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in cells) + " |\n"
    )
    rule = "|---" + ("|--:" if numeric else "|---") * (len(heads) - 1) + "|\n"
    return "".join([line(heads), rule, *map(line, rows)])


def rewrite(path, mark, texts):
    """Writes each of `texts`, a dictionary by name, between the marks <!-- MARK: NAME --> and <!-- end --> of
    a page. Raises BadUse if the page cannot be read or has an unknown name, OutputError if it cannot be
    written."""
    try:
        old = pathlib.Path(path).read_text()
    except OSError as problem:
        raise BadUse(f"{path}: cannot be read ({problem.strerror}); name a page") from None

    def one(match):
        if match[1] not in texts:
            raise BadUse(f"{path}: no table '{match[1]}'; there are: {', '.join(texts)}")
        return f"<!-- {mark}: {match[1]} -->\n\n{texts[match[1]]}\n\n<!-- end -->"

    new = re.sub(rf"<!-- {mark}: ([a-z ]+) -->.*?<!-- end -->", one, old, flags=re.S)
    try:
        if new != old:
            pathlib.Path(path).write_text(new)
    except OSError as problem:
        raise OutputError(f"{path}: cannot be written ({problem.strerror})") from None
