# SPDX-License-Identifier: MIT
# test: cost=15 full=60 processors=2
"""Several processes and ranks compile the same programs at once, with an empty
cache of PoCL."""

import os
import shutil
import subprocess
import tempfile
import unittest

from tests.program import BUILT, LONG, PROGRAM, Case, tandem

SHIM = BUILT / "libopencl_shim.so"
AT_ONCE = 4 if LONG else 2
REPEATS = 5 if LONG else 1


def started_with(words, environment):
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen(words, **pipes, text=True, env=environment)


class Building(Case):
    def setUp(self):
        cell = (
            f"run {self.twice} --device opencl:0 --algorithm tiled --repeat 1 --quiet "
            "--set contact_rule=sat --set decision=recheck --set group_size=33"
        )
        self.words = [str(PROGRAM), *cell.split()]

    def cold(self):
        folder = tempfile.mkdtemp(dir=self.work)
        return {
            **os.environ,
            "POCL_CACHE_DIR": folder,
            "OMPI_ALLOW_RUN_AS_ROOT": "1",
            "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
        }

    def right(self, process):
        out, errors = process.communicate()
        self.assertEqual(process.returncode, 0, errors)
        self.assertIn("right: ", out)

    def at_once(self, environment):
        started = [started_with(self.words, environment) for _ in range(AT_ONCE)]
        for process in started:
            self.right(process)

    @unittest.skipUnless(LONG, "the next test compiles at once, too")
    def test_processes(self):
        for _ in range(REPEATS):
            self.at_once(self.cold())

    def test_processes_whose_first_build_fails(self):
        """As one does on PoCL when another process replaces the same file of its cache."""
        self.at_once({**self.cold(), "LD_PRELOAD": str(SHIM), "SHIM_BUILDS": "1", "SHIM_CODE": "-11"})

    def test_a_program_that_never_builds(self):
        environment = {**self.cold(), "LD_PRELOAD": str(SHIM), "SHIM_BUILDS": "1000", "SHIM_CODE": "-11"}
        status, _, errors = tandem(*self.words[1:], environment=environment)
        self.assertEqual((status, len(errors)), (3, 1), errors)
        self.assertRegex(errors[0], r"does not compile with .* \(code -11\): the driver gives no build log$")

    if shutil.which("mpirun"):

        def test_ranks(self):
            for _ in range(REPEATS):
                ranks = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(AT_ONCE)]
                self.right(started_with([*ranks, *self.words], self.cold()))
