# SPDX-License-Identifier: MIT
"""Pairs of boxes that the program finds."""

import subprocess
import time
import warnings

import numpy

from boxes import vtu
from boxes.errors import BadData

SETTINGS = ("k=6", "precision=double", "rounding=nearest", "contact_rule=none")
OPTIONS = ("--repeat", "1", "--truth", "none", "--no-check", "--no-count", "--quiet")


def output(program, *arguments):
    """Standard output of the program. Raises BadData."""
    try:
        done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
    except OSError as error:
        raise BadData(
            f"{program}: {error.strerror}; build it by scripts/build, or name it by --program"
        ) from None
    if done.returncode:
        lines = [line for line in done.stderr.splitlines() if line.startswith("tandem: ")]
        code = done.returncode if done.returncode in (1, 2) else 3
        raise BadData(lines[-1] if lines else f"{program}: exit code {done.returncode}", code)
    return done.stdout


class Program:
    """The program at a path. Scenes and dumps are written into a folder."""

    def __init__(self, path, folder):
        self._path, self._folder = path, folder

    def write(self, case):
        """Writes the scene of a case: a mesh for each set of boxes. Raises BadData."""
        for name, boxes in zip(case.names, case.boxes):
            try:
                vtu.write(self._folder / f"{name}.vtu", boxes)
            except OSError as error:
                raise BadData(f"{self._folder / name}.vtu: {error.strerror}") from None

    def find(self, case, device, algorithm):
        """(ascending keys of the pairs, seconds with reading and writing of files) of a case that is written.
        Raises BadData."""
        meshes = [word for name in case.names for word in ("--mesh", self._folder / f"{name}.vtu")]
        settings = [*SETTINGS, *(("self=on",) if len(case.boxes) == 1 else ())]
        pairs = self._folder / "pairs.csv"
        begin = time.monotonic()
        output(
            self._path,
            "run",
            *meshes,
            "--device",
            device,
            "--algorithm",
            algorithm,
            *(word for one in settings for word in ("--set", one)),
            *OPTIONS,
            "--dump-pairs",
            pairs,
        )
        seconds = time.monotonic() - begin
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # no pairs
            found = numpy.loadtxt(pairs, "i8", delimiter=",", skiprows=1, usecols=(2, 4), ndmin=2)
        pairs.unlink()
        if len(case.boxes) == 1:
            found = numpy.sort(found, axis=1)
        return numpy.sort(found[:, 0] * len(case.boxes[-1][0]) + found[:, 1]), seconds
