# SPDX-License-Identifier: MIT
# test: cost=1
"""The paper's tables as data agree with each other and with the output of
scripts/paper."""

import csv
import subprocess
import unittest

from tests.program import SOURCE

FOLDER = SOURCE / "results/paper"


def rows(number):
    with open(FOLDER / f"table{number}.csv", newline="") as file:
        return list(csv.DictReader(file))


class Paper(unittest.TestCase):
    def test_the_readme_has_the_ranges_of_the_script(self):
        done = subprocess.run([SOURCE / "scripts/paper"], capture_output=True, text=True, check=True)
        rows = [line.strip("| ").split(" | ") for line in done.stdout.splitlines()[2:]]
        self.assertEqual(len(rows), 16)
        text = " ".join((FOLDER / "README.md").read_text().split())
        for column, before, unit in (
            (2, "factors of", " in Table 4"),
            (4, "gProximity takes", " times as long as chunked"),
            (6, "is", " % of gProximity's time"),
        ):
            values = sorted((row[column].removesuffix(" %") for row in rows), key=float)
            self.assertIn(f"{before} {values[0]} to {values[-1]}{unit}", text)

    def test_factors_are_ratios_of_the_times(self):
        """Launches and uploads of Table 4 are quotients of Table 5's, up to a fifth and the last printed digit, with
        one exception."""
        times = {(row["scene"], row["gpu"], row["algorithm"]): row for row in rows(5)}
        self.assertEqual(len(times), 2 * len(rows(4)))
        odd = []
        for factors in rows(4):
            one, other = (
                times[factors["scene"], factors["gpu"], algorithm] for algorithm in ("gproximity", "chunked")
            )
            for what, column in (("launches", "launches"), ("write", "write_s")):
                quotient, digit = float(one[column]) / float(other[column]), 0.005 / float(other[column])
                if abs(quotient / float(factors[what]) - 1) > 0.2 + digit:
                    odd.append((factors["scene"], factors["gpu"], what))
            if factors["scene"] in ("plates", "tower"):
                self.assertEqual(int(other["launches"]) % 102, 0, "frames of the same commands")
        self.assertEqual(odd, [("plates", "W8100", "write")])

    def test_transfers_are_fractions_of_the_total(self):
        totals = {(row["scene"], row["gpu"]): row["total_min"] for row in rows(3)}
        self.assertEqual(len(totals), 12)
        for row in rows(6):
            self.assertEqual(row["total_min"], totals[row["scene"], row["gpu"]])
            for what in ("read", "write"):
                if row[f"{what}_min"]:
                    percent = 100 * float(row[f"{what}_min"]) / float(row["total_min"])
                    self.assertAlmostEqual(
                        percent,
                        float(row[f"{what}_percent"]),
                        delta=0.01 + 0.5 / float(row["total_min"]),
                        msg=f"{row}",
                    )

    def test_parts_of_a_step_stay_below_the_whole(self):
        """Kernels of Table 7 take no more time than their phases in Table 3."""
        phases = {(row["scene"], row["gpu"]): row for row in rows(3)}
        for row in rows(7):
            phase = phases[row["scene"], row["gpu"]]
            total = float(phase["total_min"]) / 100
            kernels = {
                name: float(row[f"{name}_min"] or 0) for name in ("transform", "refit", "traverse", "contact")
            }
            self.assertLess(
                kernels["transform"] + kernels["refit"], float(phase["initialization_percent"]) * total + 0.02
            )
            self.assertLess(
                kernels["traverse"] + kernels["contact"], float(phase["narrow_percent"]) * total + 0.02
            )
            self.assertLess(sum(float(phase[name]) for name in phase if name.endswith("_percent")), 100)

    def test_scenes_are_those_of_table_1(self):
        scenes = {row["scene"]: row for row in rows(1)}
        self.assertEqual(set(scenes), {row["scene"] for number in (3, 4) for row in rows(number)})
        for row in scenes.values():
            self.assertGreater(
                float(row["contacts_thousand"]), 102 * float(row["median_contacts_a_step_thousand"])
            )
