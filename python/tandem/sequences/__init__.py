# SPDX-License-Identifier: MIT
"""Runs lists of commands, keeps a journal of how they ended, and continues where the last call stopped. Uses
only the standard library, so that a machine with a GPU needs nothing else."""
