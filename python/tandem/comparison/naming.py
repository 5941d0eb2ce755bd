# SPDX-License-Identifier: MIT
"""Short names of cells, made only of what differs among them."""

from .. import names

LAST = "digest"  # least informative, so it comes after the settings


class _Growing:
    """Labels under construction, and groups of cells that still have equal labels."""

    def __init__(self, count):
        self.labels, self.groups = [""] * count, [0] * count

    def add(self, texts):
        """Appends a text to each label if this distinguishes cells of a group. Returns whether it does."""
        pairs = list(zip(self.groups, texts))
        if len(set(pairs)) == len(set(self.groups)):
            return False
        numbers = {pair: number for number, pair in enumerate(dict.fromkeys(pairs))}
        self.groups = [numbers[pair] for pair in pairs]
        separator = ", " if any("," in text for text in (*self.labels, *texts)) else " "
        self.labels = [separator.join(filter(None, pair)) for pair in zip(self.labels, texts)]
        return True


def _numbered(cells, labels):
    """Adds numbers to equal labels of cells with different keys."""
    numbers, numbered = {}, []
    for cell, label in zip(cells, labels):
        number_of_key = numbers.setdefault(label, {})
        number = number_of_key.setdefault(cell.key, len(number_of_key) + 1)
        numbered.append(label if number == 1 else f"{label} #{number}")
    return numbered


def _names(cell):
    """Texts that name a cell, the most significant first, with the name of its method."""
    return {"method": names.method(cell.algorithm, cell.preset)} | {
        name: text for name, text in cell.names.items() if name not in ("algorithm", "preset")
    }


def label(cells):
    """A text for each Cell, in order, and one text with the values that all share. Texts of different
    keys differ. A text has those names, and then those settings in alphabetical order, that distinguish cells
    which the values before do not."""
    if not cells:
        return [], ""
    growing, common, named = _Growing(len(cells)), [], [*map(_names, cells)]
    for name, first in named[0].items():
        texts = [own[name] for own in named]
        if name != LAST and not growing.add(texts) and len(set(texts)) == 1 and first:
            common.append(first)
    for setting in sorted({name for cell in cells for name in cell.described}):
        growing.add(
            [f"{setting}={cell.described[setting]}" if setting in cell.described else "" for cell in cells]
        )
    growing.add([cell.names[LAST] for cell in cells])
    labels = [text or named[0]["method"] for text in growing.labels]
    return _numbered(cells, labels), ", ".join(common)
