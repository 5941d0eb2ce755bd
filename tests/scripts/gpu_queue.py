# SPDX-License-Identifier: MIT
# test: cost=4
"""scripts/gpu/test_queue over a program that answers like GoogleTest."""

import os
import tempfile
import time
import unittest
from pathlib import Path

from tests.program import SOURCE, ran

# Suite.Passes, Suite.Fails unless the file "mended" exists, Suite.Skips, Suite.Waits until the file "go"
# exists, and Other.RunsNothing, which ends well without having run.
PROGRAM = """#!/usr/bin/bash
cd "$(dirname "$0")"
if [ "$1" = --gtest_list_tests ]; then
  printf 'Suite.\\n  Passes  # GetParam() = 1\\n  Fails\\n  Skips\\n  Waits\\n'
  if [ -e nothing ]; then printf 'Other.\\n  RunsNothing\\n'; fi
  exit
fi
name=${1#--gtest_filter=}
echo "$name" >>runs
case $name in
  *.Fails) [ -e mended ] || { echo "expected 1, got 2"; exit 1; } ;;
  *.Waits) until [ -e go ]; do sleep 0.05; done ;;
  *.Skips) echo '[  PASSED  ] 0 tests.'; echo '[  SKIPPED ] 1 test.'; exit ;;
  *.RunsNothing) exit ;;
esac
echo '[  PASSED  ] 1 test.'
"""


class Queue(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.program = self.folder / "test_made_up"
        self.program.write_text(PROGRAM)
        self.program.chmod(0o755)

    def queue(self, seconds):
        done = ran(
            [SOURCE / "scripts/gpu/test_queue", self.folder / "journal", str(seconds), self.program],
            env={**os.environ, "TEST_PROCESSES": "4"},
        )
        lines = (self.folder / "journal").read_text().splitlines()
        return (
            done,
            [(line.split()[0], line.split()[3]) for line in lines],
            (self.folder / "runs").read_text().split(),
        )

    def test_continues_where_the_last_call_ended(self):
        begin = time.monotonic()
        done, journal, runs = self.queue(2)
        self.assertGreaterEqual(time.monotonic() - begin, 1)  # it waits for Suite.Waits, and then ends it
        self.assertEqual(done.returncode, 1)  # a failure outweighs the end of the time
        self.assertIn("== test_made_up Suite.Fails: status 1\nexpected 1, got 2", done.stderr)
        self.assertIn("failed: test_made_up Suite.Fails", done.stdout)
        self.assertEqual(
            sorted(journal),
            [("failed", "Suite.Fails"), ("passed", "Suite.Passes"), ("skipped", "Suite.Skips")],
        )
        (self.folder / "mended").touch()
        done, journal, runs = self.queue(2)
        self.assertEqual((done.returncode, done.stderr), (75, ""))
        self.assertIn("3 of 4 tests ended without failure, 1 left", done.stdout)
        (self.folder / "go").touch()
        done, journal, runs = self.queue(600)
        self.assertEqual((done.returncode, runs[-1]), (0, "Suite.Waits"))
        self.assertIn("4 of 4 tests ended without failure, 0 left", done.stdout)
        self.assertEqual(runs.count("Suite.Passes"), 1)
        self.assertEqual(self.queue(600)[2], runs)

    def test_a_program_that_ran_no_test_failed(self):
        for name in ("mended", "go", "nothing"):
            (self.folder / name).touch()
        done, journal, _ = self.queue(600)
        self.assertEqual(done.returncode, 1)
        self.assertIn(("failed", "Other.RunsNothing"), journal)
        self.assertEqual(len(journal), 5)
