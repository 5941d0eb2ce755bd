# SPDX-License-Identifier: MIT
"""Short names of cells: what differs among them, and nothing else."""

LAST = "digest"  # says least, so it comes after the settings


class _Growing:
    """Labels that grow, and groups of cells that they do not tell apart yet."""

    def __init__(self, count):
        self.labels, self.groups = [""] * count, [0] * count

    def add(self, texts):
        """Appends a text for each cell where that tells cells apart; whether it does."""
        pairs = list(zip(self.groups, texts))
        if len(set(pairs)) == len(set(self.groups)):
            return False
        numbers = {pair: number for number, pair in enumerate(dict.fromkeys(pairs))}
        self.groups = [numbers[pair] for pair in pairs]
        self.labels = [f"{label} {text}".strip() for label, text in zip(self.labels, texts)]
        return True


def _numbered(cells, labels):
    """Cells whose keys differ in what no record names get numbers."""
    numbers, made = {}, []
    for cell, label in zip(cells, labels):
        of_key = numbers.setdefault(label, {})
        number = of_key.setdefault(cell.key, len(of_key) + 1)
        made.append(label if number == 1 else f"{label} #{number}")
    return made


def label(cells):
    """A text for each RecordedCell, in order, none equal to another where keys are not; and what all share, as one text. A name stands
    in the texts where it tells cells apart that those before it do not; then settings likewise, by the alphabet."""
    if not cells:
        return [], ""
    growing, common = _Growing(len(cells)), []
    for name, first in cells[0].names.items():
        texts = [cell.names[name] for cell in cells]
        if name != LAST and not growing.add(texts) and len(set(texts)) == 1 and first:
            common.append(first)
    for setting in sorted({name for cell in cells for name in cell.settings}):
        growing.add([f"{setting}={cell.settings[setting]}" if setting in cell.settings else "" for cell in cells])
    growing.add([cell.names[LAST] for cell in cells])
    labels = [text or cells[0].names["algorithm"] for text in growing.labels]
    return _numbered(cells, labels), ", ".join(common)
