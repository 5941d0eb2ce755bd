# SPDX-License-Identifier: MIT
"""Assembles a self-contained page from the kit, its own scripts, and the libraries that it uses."""

import pathlib

from ..files import replace_whole
from ..pages.frame import Page, Section, html_of, own_script
from ..pages.markup import Html
from .libraries import CHARTS, SCENES, scripts

FOLDER = pathlib.Path(__file__).parent / "page"
CHART_SCRIPTS = """
    axes.js charts.js figures.js history.js stages.js sweeps.js errors.js kernels.js
""".split()
SCENE_SCRIPTS = ("contacts.js", "scene.js", "scene_controls.js")
SCENE = Section("view", "The scene", is_hidden=True)


def _own(name):
    return (FOLDER / name).read_text(encoding="utf-8")


def open_page(title, has_charts, has_scene, program, command):
    """A Page without sections. Raises BadUse if a library that it needs is missing."""
    libraries = (CHARTS if has_charts else {}) | (SCENES if has_scene else {})
    own = [*(CHART_SCRIPTS if has_charts else ()), *(SCENE_SCRIPTS if has_scene else ()), "begin.js"]
    texts = [*scripts(libraries, program, command), own_script(), *map(_own, own)]
    return Page(title, footer=Html(_own("licences.html")), scripts=texts, style=_own("report.css"))


def write_page(path, page):
    """Writes the page, atomically, to a file that check_output() has accepted. Returns its size in bytes.
    Raises OutputError."""
    # Names of files and texts of records need not be valid UTF-8.
    html = html_of(page).encode(errors="replace")
    replace_whole(path, html)
    return len(html)
