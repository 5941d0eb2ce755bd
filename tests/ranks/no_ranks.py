# SPDX-License-Identifier: MIT
# test: cost=1
"""A program without MPI under an MPI launcher."""

import unittest

from tests.program import Case, tandem


@unittest.skipUnless("without MPI" in tandem("--version")[1], "built with MPI")
class NoRanks(Case):
    def test_it_refuses_to_run_as_one_of_several_ranks(self):
        for variable in ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMI_RANK", "PMIX_RANK"):
            self.bad(
                "an MPI launcher started this program, but it was built without MPI",
                "scenes",
                environment={variable: "2"},
            )
