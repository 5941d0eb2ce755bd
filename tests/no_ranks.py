#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""no_ranks.py PROGRAM SOURCE: a program without MPI under an MPI launcher."""

import sys
import unittest

from program import Case, tandem


class NoRanks(Case):
    def test_it_refuses_to_run_as_one_of_several_ranks(self):
        for variable in ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMI_RANK", "PMIX_RANK"):
            self.bad(
                "an MPI launcher started this program, but it was built without MPI",
                "scenes",
                environment={variable: "2"},
            )
        status, out, errors = tandem("--version")
        self.assertEqual((status, errors), (0, []))
        self.assertIn("without MPI", out)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
