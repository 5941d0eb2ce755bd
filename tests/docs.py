# SPDX-License-Identifier: MIT
# test: cost=2
"""scripts/docs, without doxygen, which only the reference itself needs."""

import os
import subprocess
import sys
import unittest

from tests.program import SOURCE
from tests.script_case import loaded


class Docs(unittest.TestCase):
    def run_docs(self, *arguments, **environment):
        done = subprocess.run(
            [sys.executable, "-B", SOURCE / "scripts/docs", *map(str, arguments)],
            capture_output=True,
            text=True,
            check=False,
            env={**os.environ, **environment},
        )
        return done.returncode, done.stdout, done.stderr

    def test_doxygen_is_missing(self):
        self.assertEqual(
            self.run_docs(PATH="/nonexistent"), (2, "", "doxygen is missing: apt install doxygen\n")
        )

    def test_links_that_the_reference_can_follow(self):
        code, text, errors = self.run_docs("--filter", SOURCE / "docs/README.md")
        self.assertEqual((code, errors), (0, ""))
        self.assertIn("[Quick start](user/quick_start.md)", text)
        self.assertNotIn("](../", text)
        page = SOURCE / "docs/user/page.md"
        self.assertEqual(
            loaded("docs").filtered(
                page, "[a](../glossary.md#b) [c](../../README.md) [d](https://e.f) [g](#h) `i`"
            ),
            "[a](../glossary.md) c [d](https://e.f) g `i`",
        )

    def test_public_headers(self):
        docs = loaded("docs")
        self.assertGreater(len(docs.public_headers()), 20)
        self.assertIn("backends/mpi/mpi_ranks.h", docs.public_headers())
        self.assertEqual([path for path in docs.public_headers() if not (SOURCE / path).is_file()], [])
