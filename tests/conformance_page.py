#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""conformance_page.py PROGRAM SOURCE: scripts/conformance on device host, with this program, with one whose answers are
wrong, and with one that fails."""
import subprocess
import sys
import unittest

from program import PROGRAM, SOURCE, Case

# Runs the program, then edits the file of records.
WRAPPER = """#!/usr/bin/python3
import pathlib, subprocess, sys
done = subprocess.run([{program!r}, *sys.argv[1:]])
if sys.argv[1] == "check":
    if {end}:
        sys.exit("tandem: no memory")
    out = pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
    out.write_text(out.read_text().replace('"missing":0', '"missing":7').replace('"status":"ok"', '"status":"wrong"'))
    sys.exit(1)
sys.exit(done.returncode)
"""


class ConformancePage(Case):
    def conformance(self, program, *more):
        page = self.work / "page.md"
        done = subprocess.run(["/usr/bin/python3", SOURCE / "scripts/conformance", "--program", program, "--device", "host", "--k", "8", "--algorithm", "tiled",
                               "-o", page, *more], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout, done.stderr, page.read_text() if page.exists() else ""

    def other(self, end):
        path = self.work / f"other{end}"
        path.write_text(WRAPPER.format(program=str(PROGRAM), end=end))
        path.chmod(0o755)
        return path

    def test_right(self):
        code, text, errors, page = self.conformance(PROGRAM)
        self.assertEqual((code, errors), (0, ""), text)
        self.assertIn("| tiled | resident | right | right |", page)
        self.assertIn("2 of 2 cells are right.", page)

    def test_wrong(self):
        code, text, errors, page = self.conformance(self.other(False))
        self.assertEqual((code, errors), (1, ""), text)
        self.assertIn("| tiled | resident | 7 missing | 7 missing |", page)
        self.assertIn("0 of 2 cells are right.", page)

    def test_failing(self):
        code, text, _, page = self.conformance(self.other(True))
        self.assertEqual(code, 1, text)
        self.assertIn("- k = 8, float: tandem: no memory", page)

    def test_no_such_device(self):
        code, _, errors, _ = self.conformance(PROGRAM, "--device", "cuda:99")
        self.assertEqual(code, 1)
        self.assertRegex(errors, "^conformance: no device cuda:99; there are: host, ")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
