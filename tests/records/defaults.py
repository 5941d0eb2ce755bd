# SPDX-License-Identifier: MIT
# test: cost=3
"""Defaults beside other values of the same setting in the records of results/defaults: none takes more than 1.15
times as long, and the records have today's defaults. On processors, where rounds of one cell differ by half, only
differences that noise does not explain count."""

import collections
import json
import sys
import unittest

from tests.program import SOURCE, Case, tandem

sys.path.insert(0, str(SOURCE / "python"))
from tandem.cell import each
from tandem.rank_tests import unpaired_ratio

LIMIT = 1.15  # of a default's time over that of another value
PLAN = ("contact_rule", "k", "threads")  # what the plans give beside the setting that they vary


def behind(cells, presets):
    """Messages: defaults that take longer than LIMIT times another value of the same setting, on processors unless
    noise explains that they are slower, and groups of cells without today's defaults. presets: {(algorithm,
    preset): settings}."""
    groups = collections.defaultdict(lambda: collections.defaultdict(list))
    for cell in cells:
        defaults = presets[cell.algorithm, cell.preset]
        given = {name: value for name, value in cell.asked.items() if name not in PLAN}
        changed = tuple(sorted((name, value) for name, value in given.items() if value != defaults[name]))
        where = (
            cell.on_gpus,
            cell.devices,
            cell.scene,
            cell.algorithm,
            cell.preset,
            *(cell.asked[name] for name in PLAN),
        )
        groups[where][changed] += cell.times()
    messages = []
    for where, found in groups.items():
        is_quiet = where[0]
        name = " ".join(map(str, where[1:]))
        if () not in found:
            messages.append(f"{name}: no record has today's defaults; measure results/defaults again")
            continue
        for changed, times in found.items():
            ratio = unpaired_ratio(times, found[()])
            if len(changed) == 1 and ratio.value > LIMIT and (is_quiet or ratio.low > 1):
                setting, value = changed[0]
                messages.append(f"{name}: takes {ratio.value:.2f} times as long as with {setting}={value}")
    return messages


class Defaults(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.presets = {
            (algorithm["name"], preset["name"]): preset["settings"]
            for algorithm in json.loads(tandem("algorithms", "--json")[1])
            for preset in algorithm["presets"]
        }
        cls.cells = [
            cell
            for path in sorted((SOURCE / "results/defaults").glob("*.jsonl.xz"))
            for cell in each(path)
            if cell.status == "ok"
        ]

    def test_no_default_is_behind(self):
        self.assertGreater(len(self.cells), 100)
        self.assertEqual(behind(self.cells, self.presets), [])

    def test_a_default_that_is_behind_is_found(self):
        presets = {key: dict(value) for key, value in self.presets.items()}
        presets["tiled", "resident"]["builder"] = "morton"
        found = behind(self.cells, presets)
        self.assertTrue(any("tiled" in one and "with builder=sah" in one for one in found), found)
        presets["tiled", "resident"]["most_seeds"] = "17"
        self.assertIn("measure results/defaults again", " ".join(behind(self.cells, presets)))


if __name__ == "__main__":
    unittest.main()
