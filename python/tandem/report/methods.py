# SPDX-License-Identifier: MIT
"""Drawings of how algorithms work (scripts/method_drawings), as parts of the page that fold."""

import pathlib

from .. import names
from ..pages.groups import folded
from ..pages.markup import Html
from .leads import listed

FOLDER = pathlib.Path(__file__).parent / "methods"


def _methods(algorithm):
    return listed([name for (own, _), name in names.METHODS.items() if own == algorithm])


def drawings_of(algorithms):
    """The drawings of those algorithms that have one, each under the names of its methods."""
    return [
        folded(
            f"method-{file.stem}",
            f"How it works: {_methods(file.stem)}",
            Html(file.read_text(encoding="utf-8")),
        )
        for file in sorted(FOLDER.glob("*.svg"))
        if file.stem in algorithms
    ]
