# SPDX-License-Identifier: MIT
# test: cost=4
"""scripts/conformance on device host, with this program, with one whose
answers are wrong, one that finds no pairs, one that fails, and one that a driver ends."""

import json
import subprocess

from tests.program import PROGRAM, SOURCE, Case
from tests.script_case import loaded

# Runs the program, then edits the file of records.
WRAPPER = """#!/usr/bin/python3
import os, pathlib, re, signal, subprocess, sys
done = subprocess.run([{program!r}, *sys.argv[1:]])
if sys.argv[1] == "check":
    out = pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
    if {crash}:
        if "leaf_query" in sys.argv[sys.argv.index("--algorithm") + 1]:
            out.unlink()
            os.kill(os.getpid(), signal.SIGSEGV)
        sys.exit(done.returncode)
    if {end}:
        sys.exit("tandem: no memory")
    text = out.read_text()
    if {empty}:
        out.write_text(re.sub('"count":[0-9]+', '"count":0', text))
        sys.exit(0)
    out.write_text(text.replace('"missing":0', '"missing":7').replace('"status":"ok"', '"status":"wrong"'))
    sys.exit(1)
sys.exit(done.returncode)
"""


class ConformancePage(Case):
    def conformance(self, program, *more):
        page = self.work / "page.md"
        done = subprocess.run(
            [
                "/usr/bin/python3",
                SOURCE / "scripts/conformance",
                "--program",
                program,
                "--device",
                "host",
                "--k",
                "8",
                "--algorithm",
                "tiled",
                "-o",
                page,
                *more,
            ],
            capture_output=True,
            text=True,
            check=False,
        )
        return done.returncode, done.stdout, done.stderr, page.read_text() if page.exists() else ""

    def other(self, end=False, empty=False, crash=False):
        path = self.work / f"other{end}{empty}{crash}"
        path.write_text(WRAPPER.format(program=str(PROGRAM), end=end, empty=empty, crash=crash))
        path.chmod(0o755)
        return path

    def test_right(self):
        code, text, errors, page = self.conformance(PROGRAM)
        self.assertEqual((code, errors), (0, ""), text)
        self.assertNotIn("## host", page)
        self.assertRegex(page, r"Right cells \(float, double: k = 8\):\n\n- host .*: 2 of 2\n")

    def test_settings_in_words(self):
        script = loaded("conformance")
        every = script.columns_of(script.EVERY_K)
        self.assertEqual(script.settings_of(every), "float, double: every k; groups of 64: k = 26")
        some = ["k = 8, float", "k = 18, float", "k = 18, groups of 64"]
        self.assertEqual(script.settings_of(some), "float: k = 8, 18; groups of 64: k = 18")
        self.assertEqual(script.settings_of([]), "none")

    def test_other_contacts_with_the_right_pairs(self):
        agreement = {"missing": 0, "extra": 0, "contact_frames_wrong": 2, "digest": {"count": 3}}
        outcome = lambda **more: loaded("conformance").outcome(
            {"status": "wrong", "agreement": {**agreement, **more}}
        )
        self.assertEqual(outcome(), "other contacts")
        self.assertEqual(outcome(extra=4), "4 extra")

    def test_wrong(self):
        code, text, errors, page = self.conformance(self.other())
        self.assertEqual((code, errors), (1, ""), text)
        self.assertIn("| tiled | resident | 7 missing | 7 missing |", page)
        self.assertRegex(page, r"Right cells \(float, double: k = 8\):\n\n- host .*: 0 of 2\n")

    def test_failing(self):
        code, text, _, page = self.conformance(self.other(end=True))
        self.assertEqual(code, 1, text)
        self.assertIn("- float, double: k = 8: tandem: no memory", page)

    def test_a_driver_that_ends_the_process(self):
        """The cells of the other algorithms are on the page."""
        code, text, errors, page = self.conformance(self.other(crash=True), "--algorithm", "tiled,leaf_query")
        self.assertEqual((code, errors), (1, ""), text)
        self.assertIn("- float, double: k = 8: leaf_query: the driver ended the process (SIGSEGV)", page)
        self.assertRegex(page, r"Right cells \(float, double: k = 8\):\n\n- host .*: 2 of 2\n")

    def test_an_empty_answer_shows_nothing(self):
        code, text, errors, page = self.conformance(self.other(empty=True))
        self.assertEqual((code, errors), (1, ""), text)
        self.assertIn("| tiled | resident | no pairs | no pairs |", page)

    def test_columns_are_kept_and_digests_compared(self):
        """A second call repeats cells that failed, and a third finds them; those of another device join the page, and
        a different digest is an error."""
        kept = self.work / "kept.json"
        self.assertEqual(self.conformance(self.other(end=True), "--keep", kept)[0], 1)
        self.assertEqual(self.conformance(PROGRAM, "--keep", kept)[0], 0)
        columns = kept.read_text()
        code, text, _, page = self.conformance(self.other(end=True), "--keep", kept)
        self.assertEqual((code, kept.read_text()), (0, columns), text)
        lines = [json.loads(line) for line in columns.splitlines()]

        def others(**changed):
            """A journal that also has lines of another device."""
            other = [
                {**line, "device": "other device", "key": f"other {line['key']}", **changed} for line in lines
            ]
            kept.write_text("".join(json.dumps(line) + "\n" for line in lines + other))
            return self.conformance(PROGRAM, "--keep", kept)

        code, _, _, page = others()
        self.assertEqual(code, 0)
        self.assertIn(
            "2 cells were right on two devices or more; 2 of these have the same digest on all of them.", page
        )
        self.assertIn("\n- other device: 2 of 2\n", page)
        code, text, _, page = others(digests={"tiled resident": "{}"})
        self.assertEqual(code, 1)
        self.assertIn("tiled resident, k = 8, float: 2 different digests", text)
        self.assertIn("- tiled resident, k = 8, float: 2 different digests", page)
        self.assertIn("is of another program (another)", others(version="another")[2])

    def test_no_such_device(self):
        code, _, errors, _ = self.conformance(PROGRAM, "--device", "cuda:99")
        self.assertEqual(code, 1)
        self.assertRegex(errors, "^conformance: no device cuda:99; there are: host, ")
