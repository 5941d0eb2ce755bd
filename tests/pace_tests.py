# SPDX-License-Identifier: MIT
# test: cost=10
"""The rules by which tests take a process for hung (tests/pace.py)."""

import os
import re
import subprocess
import sys
import unittest

from tests import pace
from tests.program import SOURCE


def start(text):
    return subprocess.Popen(
        [sys.executable, "-c", text], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


class Pace(unittest.TestCase):
    def test_ctest_has_no_limits(self):
        """A loaded machine misses a limit of ctest, which counts the clock's time; listing cases during the
        build needs one."""
        for path in (SOURCE / "tests").rglob("CMakeLists.txt"):
            self.assertEqual(re.findall(r"(?<!DISCOVERY_)TIMEOUT +\d+", path.read_text()), [], path)

    def test_a_process_that_ends(self):
        process = start("print('done')")
        self.assertEqual((pace.communicate(process, 100), process.returncode), (("done\n", ""), 0))

    def test_a_process_that_runs_without_an_end(self):
        process = start("while True: pass")
        with self.assertRaisesRegex(pace.Hung, "of processor time"):
            pace.communicate(process, 1)
        self.assertLess(process.returncode, 0)

    def test_a_process_that_waits_for_nothing(self):
        process = start("import threading; threading.Event().wait()")
        with self.assertRaisesRegex(pace.Hung, "1 s without any processor time"):
            pace.communicate(process, 100, asleep=1)

    def test_a_process_that_others_keep_waiting(self):
        """Eight busy processes beside it on one processor: it takes several times its own time, and is not hung."""
        one = {min(os.sched_getaffinity(0))}
        busy = [start(f"import os; os.sched_setaffinity(0, {one})\nwhile True: pass") for _ in range(8)]
        try:
            process = start(
                f"import os, time; os.sched_setaffinity(0, {one})\nwhile time.process_time() < 0.5: pass"
            )
            self.assertEqual(pace.communicate(process, 2, asleep=1), ("", ""))
        finally:
            for other in busy:
                other.kill()
                other.communicate()
        self.assertEqual(process.returncode, 0)
