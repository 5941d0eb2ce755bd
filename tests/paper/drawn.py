# SPDX-License-Identifier: MIT
"""The page of the committed results of 'tandem paper' as the present code writes it, for tests of pages."""

import os
import shutil
import tempfile

os.environ.setdefault("MPLCONFIGDIR", tempfile.gettempdir())
from tests.program import SOURCE

from tandem.commands.paper import all_tables
from tandem.paper import claims, page
from tandem.paper.drawing import Figure
from tandem.paper.folder import Folder

COMMITTED = SOURCE / "results/h200/paper"
FIGURES = 14


def page_of_committed(path):
    """Writes index.html in a copy of the committed folder, with its committed images, and returns its path."""
    shutil.copytree(COMMITTED, path, ignore=shutil.ignore_patterns("index.html"))
    folder = Folder(path)
    figures = [Figure(number, f"title of {number}", []) for number in range(1, FIGURES + 1)]
    page.write(folder, all_tables(folder), figures, claims.all_claims(folder))
    return path / "index.html"
