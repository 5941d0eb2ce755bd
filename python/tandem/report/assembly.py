# SPDX-License-Identifier: MIT
"""Assembles a self-contained page from the kit, its own scripts, and JavaScript libraries, which it finds."""

import os
import pathlib

from ..errors import BadUse
from ..files import replace_whole
from ..pages.frame import Page, Section, html_of, own_script
from ..names import scene
from ..pages.markup import Html, element

FOLDER = pathlib.Path(__file__).parent / "page"
SYSTEM = "/usr/share/javascript"
# Files of libraries, and their Debian packages.
CHARTS = {"chart.js/chart.min.js": "libjs-chart.js"}
SCENES = {"three/three.min.js": "libjs-three", "three/examples/js/controls/OrbitControls.js": "libjs-three"}
CHART_SCRIPTS = ("axes.js", "charts.js", "overview.js", "figures.js", "stages.js", "errors.js", "kernels.js")
SCENE_SCRIPTS = ("scale.js", "contacts.js", "surfaces.js", "scene.js", "scene_controls.js")


def folders(program):
    """Folders that are searched for libraries: the folder in TANDEM_JAVASCRIPT, or else those beside the
    program, in its build folder or its installation, and the folder of Debian's packages."""
    named = os.environ.get("TANDEM_JAVASCRIPT")
    if named:
        return [pathlib.Path(named)]
    own = pathlib.Path(program).resolve().parent
    return [*(folder / "libexec/tandem/javascript" for folder in (own, own.parent)), pathlib.Path(SYSTEM)]


def library(name, package, program, command):
    """The text of a file of a library. Raises BadUse if it is missing."""
    for folder in folders(program):
        try:
            return (folder / name).read_bytes().decode(errors="replace")
        except OSError:
            continue
    raise BadUse(
        f"{command} needs {os.path.basename(name)}, and there is no {folders(program)[-1] / name}; install {package} (Debian), or "
        "name a folder with such files in TANDEM_JAVASCRIPT"
    )


def open_page(title, has_charts, has_scene, program, command):
    """A Page without sections. Raises BadUse if a library that it needs is missing."""
    libraries = (CHARTS if has_charts else {}) | (SCENES if has_scene else {})
    texts = [*(library(*item, program, command) for item in libraries.items()), own_script()]
    own = lambda name: (FOLDER / name).read_text(encoding="utf-8")
    texts += map(own, CHART_SCRIPTS * has_charts + SCENE_SCRIPTS * has_scene + ("begin.js",))
    return Page(title, footer=Html(own("licences.html")), scripts=texts, style=own("report.css"))


def scene_section(key):
    """The part with the scene of this key, which scripts draw."""
    content = element("p", key, class_="quiet")
    return Section("view", f"The scene: {scene(key)}", content, [("view", "The scene")], is_hidden=True)


def write_page(path, page):
    """Writes the page, atomically, to a file that check_output() has accepted. Returns its size in bytes.
    Raises OutputError."""
    # Names of files and texts of records need not be valid UTF-8.
    html = html_of(page).encode(errors="replace")
    replace_whole(path, html)
    return len(html)
