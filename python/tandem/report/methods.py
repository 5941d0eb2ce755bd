# SPDX-License-Identifier: MIT
"""Drawings of how algorithms work (scripts/method_drawings), as parts of the page that fold."""

import pathlib

from .. import names
from ..pages.groups import folded
from ..pages.markup import Html
from .leads import listed

FOLDER = pathlib.Path(__file__).parent / "methods"


def drawings_of(cells):
    """The drawings of the cells' algorithms that have one, each under the names of their methods."""
    drawn = []
    for file in sorted(FOLDER.glob("*.svg")):
        methods = names.in_order(
            names.method(cell.algorithm, cell.preset) for cell in cells if cell.algorithm == file.stem
        )
        if methods:
            title, drawing = f"How it works: {listed(methods)}", Html(file.read_text(encoding="utf-8"))
            drawn.append(folded(f"method-{file.stem}", title, drawing))
    return drawn
