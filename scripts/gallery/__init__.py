# SPDX-License-Identifier: MIT
"""The page of results by many: which records it accepts, which answers are right, and its HTML."""
