# SPDX-License-Identifier: MIT
"""Drawings of how algorithms work (scripts/method_drawings), as parts of the page that fold."""

import pathlib

from ..pages.groups import folded
from ..pages.markup import Html

FOLDER = pathlib.Path(__file__).parent / "methods"


def drawings_of(algorithms):
    """The drawings of those algorithms that have one, each under its name."""
    return [
        folded(f"method-{file.stem}", f"How {file.stem} works", Html(file.read_text(encoding="utf-8")))
        for file in sorted(FOLDER.glob("*.svg"))
        if file.stem in algorithms
    ]
