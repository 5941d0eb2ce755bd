# SPDX-License-Identifier: MIT
# test: cost=1
"""scripts/artefact on made-up pages, and the commands of docs/artefact.md.
scripts/test --full runs them."""

import os
import re

from tests.program import SOURCE, ran, tandem
from tests.script_case import ScriptCase, called, loaded

PAGE = SOURCE / "docs/artefact.md"


class Artefact(ScriptCase):
    def run_page(self, text):
        page = self.work / "page.md"
        page.write_text(text)
        done = ran([SOURCE / "scripts/artefact", page])
        return done.returncode, done.stdout, done.stderr

    def test_commands_run_in_order_and_are_judged(self):
        mark = self.work / "mark"
        text = f"# Page\n\n    echo one > {mark} && echo written\n\nText.\n\n    exit 3\n    grep -q one {mark}\n"
        code, output, _ = self.run_page(text)
        self.assertEqual(code, 1)
        self.assertEqual(
            re.findall(r"^ *(ok|failed \(3\)) +[\d.]+ s  (\w+)", output, re.M),
            [("ok", "echo"), ("failed (3)", "exit"), ("ok", "grep")],
        )
        self.assertIn("\nwritten\n", output)
        self.assertEqual(self.run_page(text.replace("exit 3", "true"))[0], 0)
        for bad in (("x", "y"), ("--fly",), (self.work / "absent.md",), ("--list", "x", "y")):
            self.assertEqual(called(loaded("artefact"), *bad)[0], 1, bad)
        self.assertIn("has no commands", self.run_page("# Page\n\nText.\n")[2])

    def test_commands_of_the_page_exist(self):
        status, output, errors = called(loaded("artefact"), "--list")
        self.assertEqual((status, errors), (0, []))
        commands = output.splitlines()
        self.assertGreater(len(commands), 6)
        for command in commands:
            first, *rest = command.removeprefix("bash ").split()
            if first == "build/tandem":
                status, _, errors = (
                    tandem(*rest, "--dry-run") if rest[0] == "run" else tandem(rest[0], "--help")
                )
                self.assertEqual((status, errors), (0, []), command)
            elif "/" in first:
                self.assertTrue(os.access(SOURCE / first, os.X_OK), command)
            else:
                self.assertEqual(first, "rm", command)
        text = PAGE.read_text()
        for number in range(1, 5):
            self.assertIn(f"**E{number}, ", text)
            self.assertIn(f"| E{number} | ", text)
