# SPDX-License-Identifier: MIT
"""The Python package from its wheel alone."""

import atexit
import functools
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import zipfile

from tests.program import SOURCE


FOLDER = tempfile.TemporaryDirectory(prefix="tandem-package")
atexit.register(FOLDER.cleanup)


@functools.cache
def package():
    """Builds the wheel of a copy of the package's sources without its compiled part, and imports the package
    from there."""
    copy = pathlib.Path(FOLDER.name) / "source"
    shutil.copytree(SOURCE / "python", copy / "python", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(SOURCE / "results/paper", copy / "results/paper")
    for name in ("pyproject.toml", "LICENSE", "NOTICE.md", "CITATION.cff", "scripts/render"):
        (copy / name).parent.mkdir(exist_ok=True)
        shutil.copy(SOURCE / name, copy / name)
    tools = SOURCE / ".cache/python"
    assert tools.exists(), "scikit-build-core is missing; scripts/setup fetches it"
    code = "import sys; from scikit_build_core.build import build_wheel; build_wheel(sys.argv[1], {'wheel.cmake': 'false'})"
    done = subprocess.run(
        [sys.executable, "-c", code, FOLDER.name],
        cwd=copy,
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": str(tools)},
    )
    assert done.returncode == 0, done.stderr
    (wheel,) = pathlib.Path(FOLDER.name).glob("*.whl")
    unpacked = pathlib.Path(FOLDER.name) / "unpacked"
    zipfile.ZipFile(wheel).extractall(unpacked)
    sys.path.insert(0, str(unpacked))
    import tandem

    assert pathlib.Path(tandem.__file__).is_relative_to(unpacked)
    return tandem
