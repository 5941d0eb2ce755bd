#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""faults.py PROGRAM SHIM: every OpenCL call that can fail does, one a run, with work in flight."""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

if len(sys.argv) != 3:
    sys.exit(__doc__)
# A run for each call; without the tests of label full, for every third.
EACH = 1 if "TANDEM_LONG_FORM" in os.environ else 3
PROGRAM, SHIM = (pathlib.Path(a).resolve() for a in sys.argv[1:])


def run(folder, **variables):
    """Status and lines on standard error of a frame whose contacts OpenCL finds."""
    arguments = ("export", "pile:bodies=2,frames=1", "--frames", "0", "--vtu", folder, "--contacts", "--device", "opencl:0")
    environment = {**os.environ, "LD_PRELOAD": str(SHIM), **{k: str(v) for k, v in variables.items()}}
    done = subprocess.run([str(PROGRAM), *arguments], capture_output=True, text=True, env=environment, timeout=100)
    return done.returncode, done.stderr.splitlines()


def record(calls):
    """For scripts/tried, as tests/program.py has it."""
    if "TANDEM_TRIED" in os.environ:
        commit = re.search(r"commit (\w+)", subprocess.run([str(PROGRAM), "--version"], capture_output=True, text=True, check=True).stdout)[1]
        with open(os.environ["TANDEM_TRIED"], "a", encoding="utf-8") as out:
            out.write(json.dumps({"what": "calls that fail: OpenCL, with work in flight", "count": calls, "unit": "runs", "where": "PoCL", "lost": 0,
                                  "crashes": 0, "hangs": 0, "others": 0, "commit": commit}) + "\n")


class Faults(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def test_every_call(self):
        count = pathlib.Path(self.folder) / "count"
        self.assertEqual(run(self.folder, SHIM_COUNT=count), (0, []))
        calls = int(count.read_text())
        self.assertGreater(calls, 40)
        survived = 0
        for call in range(1, calls, EACH):
            with self.subTest(call=call):
                status, errors = run(self.folder, SHIM_CALL=call)
                if (status, errors) == (0, []):
                    survived += 1
                    continue
                self.assertEqual((status, len(errors)), (3, 1), errors)
                self.assertRegex(errors[0], "^tandem: opencl:0.*(failed with code -5, out of resources|does not compile)")
        # A buffer that grows is asked for again for just what is needed; the contact stage's two lists, and the one that
        # pairs are downloaded through, for half.
        self.assertLessEqual(survived, 4)
        self.assertEqual(survived, 4 if EACH == 1 else survived)
        record(len(range(1, calls, EACH)))
        # The last is the wait of the device's end: the work is done, and what may be read still is not freed.
        self.assertEqual(run(self.folder, SHIM_CALL=calls), (0, []))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
