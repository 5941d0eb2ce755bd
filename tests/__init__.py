# SPDX-License-Identifier: MIT
"""The tests find the package `tandem` in the tree, unless they put another before it."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "python"))
