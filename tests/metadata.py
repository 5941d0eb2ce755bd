# SPDX-License-Identifier: MIT
# test: cost=2
"""Lists of packages name CMake's libraries."""

import re
import unittest

from tests.program import SOURCE


class Metadata(unittest.TestCase):
    def test_lists_of_packages_have_every_library(self):
        """scripts/gpu/fetch is for machines without a network, where a missing library shows too late."""
        setup, fetch = ((SOURCE / "scripts" / name).read_text() for name in ("setup", "gpu/fetch"))
        needed = {
            "libboost1.74-dev" if name == "libboost-dev" else name
            for name in re.findall(r"\b[a-z0-9.-]+-dev\b", setup.partition("packages=(")[2].partition(")")[0])
        }
        self.assertGreater(len(needed), 9)
        fetched = set(re.findall(r"[a-z0-9.-]+", fetch.partition("packages=(")[2].partition(")")[0]))
        self.assertEqual(needed - fetched, set())
