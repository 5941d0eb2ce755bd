# SPDX-License-Identifier: MIT
"""Assembles a self-contained page from its own files, the libraries that it uses, and its data."""

import dataclasses
import pathlib

from ..files import replace_whole
from ..text_lines import visible, visible_json
from .libraries import CHARTS, SCENES, scripts

FOLDER = pathlib.Path(__file__).parent / "page"
CHART_SCRIPTS = (
    "words.js",
    "tables.js",
    "axes.js",
    "charts.js",
    "figures.js",
    "history.js",
    "stages.js",
    "sweeps.js",
    "errors.js",
    "kernels.js",
)
SCENE_SCRIPTS = ("contacts.js", "scene.js", "scene_controls.js")


@dataclasses.dataclass
class Page:
    """libraries: texts of the libraries of the page; has_charts, has_scene: which of its own scripts it has;
    data: {id: JSON text}."""

    title: str
    libraries: list = dataclasses.field(default_factory=list)
    has_charts: bool = False
    has_scene: bool = False
    data: dict = dataclasses.field(default_factory=dict)


def open_page(title, has_charts, has_scene, program, command):
    """A Page without data. Raises BadUse if a library that it needs is missing."""
    libraries = (CHARTS if has_charts else {}) | (SCENES if has_scene else {})
    return Page(title, scripts(libraries, program, command), has_charts, has_scene)


def _own(name):
    return (FOLDER / name).read_text(encoding="utf-8")


def _escaped(text):
    return visible(text).replace("&", "&amp;").replace("<", "&lt;")


def _data_element(name, json):
    """An element with JSON data, escaped so that no text of a record can end it or contain control characters."""
    escaped = visible_json(json).replace("<", "\\u003c")
    return f'<script type="application/json" id="data-{name}">{escaped}</script>\n'


def _script_element(script):
    script = script.replace("</script", "<\\/script").replace("<!--", "<\\!--")
    return f"<script>\n{script}\n</script>\n"


def html_of(page):
    own = [
        "data.js",
        *(CHART_SCRIPTS if page.has_charts else ()),
        *(SCENE_SCRIPTS if page.has_scene else ()),
        "page.js",
    ]
    elements = [
        *(_data_element(*item) for item in page.data.items()),
        *map(_script_element, [*page.libraries, *map(_own, own)]),
    ]
    html = (
        _own("page.html")
        .replace("/*styles*/", _own("page.css"), 1)
        .replace("<!--title-->", _escaped(page.title))
    )
    return html.replace("<!--scripts-->", "".join(elements), 1)


def write_page(path, page):
    """Writes the page, atomically, to a file that check_output() has accepted. Returns its size in bytes.
    Raises OutputError."""
    # Names of files and texts of records need not be valid UTF-8.
    html = html_of(page).encode(errors="replace")
    replace_whole(path, html)
    return len(html)
