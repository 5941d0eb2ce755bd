# SPDX-License-Identifier: MIT
"""Finds the JavaScript libraries that draw charts and scenes, or names the package to install."""

import os
import pathlib

from ..errors import BadUse

CHARTS = {"chart.js/chart.min.js": "libjs-chart.js"}
SCENES = {
    "three/three.min.js": "libjs-three",
    "three/examples/js/controls/OrbitControls.js": "libjs-three",
}  # and their Debian packages
SYSTEM = "/usr/share/javascript"


def folders(program):
    """Folders that are searched for libraries: the folder in TANDEM_JAVASCRIPT, or else those beside the
    program, in its build folder or its installation, and the folder of Debian's packages."""
    named = os.environ.get("TANDEM_JAVASCRIPT")
    if named:
        return [pathlib.Path(named)]
    own = pathlib.Path(program).resolve().parent
    return [*(folder / "libexec/tandem/javascript" for folder in (own, own.parent)), pathlib.Path(SYSTEM)]


def _script(name, package, program, command):
    for folder in folders(program):
        try:
            return (folder / name).read_bytes().decode(errors="replace")
        except OSError:
            continue
    raise BadUse(
        f"{command} needs {os.path.basename(name)}, and there is no {folders(program)[-1] / name}; install {package} (Debian), or "
        "name a folder with such files in TANDEM_JAVASCRIPT"
    )


def scripts(libraries, program, command):
    """The texts of libraries, in their order. Raises BadUse if one is missing."""
    return [_script(name, package, program, command) for name, package in libraries.items()]
