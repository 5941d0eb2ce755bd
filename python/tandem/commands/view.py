# SPDX-License-Identifier: MIT
"""tandem view: writes a three-dimensional view of a scene as a page for a browser."""

import re

from .. import names
from ..files import check_output
from ..report.assembly import open_page, scene_section, write_page
from ..report.scene import add_options, check_device, shown_scene, words_of
from . import Parser, check_together, run


def _parsed(arguments):
    parser = Parser("tandem view", __doc__, "tandem view pile -o pile.html")
    add = parser.add_argument
    scene = "NAME, NAME:par=value,..., a scene description (.json) or a recording (.frames)"
    add("scene", nargs="?", help=scene)
    mesh = "a mesh file of the scene, instead of SCENE; may be repeated"
    add("--mesh", action="append", metavar="FILE", help=mesh)
    pose = '"tx ty tz qw qx qy qz", one per --mesh, in order (default: identity)'
    add("--pose", action="append", metavar="POSE", help=pose)
    page = "the HTML file to write (default: named after the scene)"
    add("-o", "--output", metavar="FILE", help=page)
    add_options(parser)
    options = parser.read(arguments)
    check_together(options, [("pose", "mesh")])
    check_device(options)
    return options


def _file_name(scene):
    """A name that is valid in any file system."""
    return (re.sub(r"[^A-Za-z0-9_-]", "-", scene) or "scene") + ".html"


def _make(options, program):
    if options.output:
        check_output(
            options.output, [*filter(None, (options.scene,)), *(options.mesh or ())], ".partial", is_page=True
        )
    page = open_page("", False, True, program, "tandem view")
    scene = shown_scene(program, words_of(options.scene, options), options.output)
    page.title, page.data["scene"] = f"{names.scene(scene.key)}: a scene of tandem", scene.json
    page.sections = [scene_section(scene.key)]
    path = options.output or _file_name(scene.name)
    if not options.output:
        check_output(path, (), ".partial", is_page=True)
    written = write_page(path, page)
    return (
        f"{path}: {scene.frames} {'frame' if scene.frames == 1 else 'frames'} of {scene.key}, {written / 1e6:.1f} MB\n",
        0,
    )


def main(arguments, program):
    return run(lambda: _make(_parsed(arguments), program))
