# SPDX-License-Identifier: MIT
"""The JavaScript libraries that draw charts and scenes: where they are, and what to install where they are not."""
import os
import pathlib

from ..errors import BadUse

CHARTS = {"chart.js/chart.min.js": "libjs-chart.js"}
SCENES = {"three/three.min.js": "libjs-three", "three/examples/js/controls/OrbitControls.js": "libjs-three"}  # and their Debian packages
SYSTEM = "/usr/share/javascript"


def folders(program):
    """Where libraries are looked for: in the folder that TANDEM_JAVASCRIPT names, or else beside the program, in its build folder or its
    installation, and where Debian has them."""
    named = os.environ.get("TANDEM_JAVASCRIPT")
    if named:
        return [pathlib.Path(named)]
    beside = pathlib.Path(program).resolve().parent
    return [*(folder / "libexec/tandem/javascript" for folder in (beside, beside.parent)), pathlib.Path(SYSTEM)]


def _script(name, package, program, command):
    for folder in folders(program):
        try:
            return (folder / name).read_bytes().decode(errors="replace")
        except OSError:
            continue
    raise BadUse(f"{command} needs {os.path.basename(name)}, and there is no {folders(program)[-1] / name}; install {package} (Debian), or "
                 "name a folder with such files in TANDEM_JAVASCRIPT")


def scripts(libraries, program, command):
    """The texts of libraries, in their order. Raises BadUse, one line, where one is missing."""
    return [_script(name, package, program, command) for name, package in libraries.items()]
