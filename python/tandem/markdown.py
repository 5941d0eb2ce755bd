# SPDX-License-Identifier: MIT
"""Tables in Markdown, and pages whose tables are made from records."""
import pathlib
import re

from .errors import BadUse, OutputError


def table(heads, rows, numeric=False):
    """Lines of a table, each with its end. `numeric`: all columns but the first are aligned to the right."""
    line = lambda cells: "| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in cells) + " |\n"
    rule = "|---" + ("|--:" if numeric else "|---") * (len(heads) - 1) + "|\n"
    return "".join([line(heads), rule, *map(line, rows)])


def rewrite(path, mark, made):
    """Puts each text of `made`, by its name, between its marks <!-- MARK: NAME --> and <!-- end --> of a page. Raises BadUse for a page
    that cannot be read and for a name that is none, OutputError for a page that cannot be written."""
    try:
        old = pathlib.Path(path).read_text()
    except OSError as problem:
        raise BadUse(f"{path}: cannot be read ({problem.strerror}); name a page") from None

    def one(match):
        if match[1] not in made:
            raise BadUse(f"{path}: no table '{match[1]}'; there are: {', '.join(made)}")
        return f"<!-- {mark}: {match[1]} -->\n\n{made[match[1]]}\n\n<!-- end -->"

    new = re.sub(rf"<!-- {mark}: ([a-z ]+) -->.*?<!-- end -->", one, old, flags=re.S)
    try:
        if new != old:
            pathlib.Path(path).write_text(new)
    except OSError as problem:
        raise OutputError(f"{path}: cannot be written ({problem.strerror})") from None
