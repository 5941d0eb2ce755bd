# SPDX-License-Identifier: MIT
"""tandem view: writes a three-dimensional view of a scene as a page for a browser."""

import argparse
import re

from ..files import check_output
from ..report.assembly import open_page, write_page
from ..report.scene import ExportEnded, shown_scene, words_of
from . import run


def _parsed(arguments):
    parser = argparse.ArgumentParser(prog="tandem view", description=__doc__, allow_abbrev=False)
    parser.add_argument("scene", nargs="?")
    for name in ("mesh", "pose"):
        parser.add_argument(f"--{name}", action="append")
    for name in ("output", "frames", "every", "device", "duplicates", "weld"):
        parser.add_argument(f"--{name}")
    for name in ("contacts", "corners", "only-tetrahedra"):
        parser.add_argument(f"--{name}", action="store_true")
    return parser.parse_args(arguments)


def _file_name(scene):
    """A name that is valid in any file system."""
    return (re.sub(r"[^A-Za-z0-9_-]", "-", scene) or "scene") + ".html"


def _make(options, program):
    if options.output:
        check_output(options.output, [*filter(None, (options.scene,)), *(options.mesh or ())], ".partial")
    page = open_page("", False, True, program, "tandem view")
    try:
        scene = shown_scene(program, words_of(options.scene, options), options.output)
    except ExportEnded as ended:
        return "", ended.code
    page.title, page.data["scene"] = f"{scene.name}, a scene of tandem", scene.json
    path = options.output or _file_name(scene.name)
    if not options.output:
        check_output(path, (), ".partial")
    written = write_page(path, page)
    return (
        f"{path}: {scene.frames} {'frame' if scene.frames == 1 else 'frames'} of {scene.key}, {written / 1e6:.1f} MB\n",
        0,
    )


def main(arguments, program):
    options = _parsed(arguments)
    return run(lambda: _make(options, program))
