# SPDX-License-Identifier: MIT
# test: cost=8
"""Numbers of the committed page of 'tandem paper' equal those that pandas computes from its records."""

import re
import unittest

from tests.program import SOURCE

import pandas


COMMITTED = SOURCE / "results/h200/paper"


def read(name):
    """The cells of a committed file of records as a table of pandas."""
    table = pandas.read_json(COMMITTED / "records" / f"{name}.jsonl", lines=True, dtype=False)
    table = table[table["algorithm"].notna()].drop_duplicates("key", keep="last")
    return table.assign(
        k=[settings["k"] for settings in table["settings"]],
        first=[frames["first"] for frames in table["frames"]],
    )


def by_round(row):
    """Medians of the samples of each round."""
    total = row["total_ns"]
    return pandas.Series(total["samples"], index=total["rounds"]).groupby(level=0).median()


def stage_sum(row, stages, kind="device_ns"):
    found = [row["stages"][stage] for stage in stages if stage in row["stages"]]
    return sum(
        (stage["device_ns"]["median"] or stage["host_ns"]["median"]) if kind == "device_ns" else stage[kind]
        for stage in found
    )


def phase_by_round(row, name):
    """Nanoseconds of a phase for each round."""
    return pandas.Series(
        row["phases"][name]["host_ns"]["samples"], index=sorted(set(row["total_ns"]["rounds"]))
    )


class Recomputed(unittest.TestCase):
    """Numbers of the committed claims.csv and page, recomputed from the records with pandas and none of the
    package's code."""

    @classmethod
    def setUpClass(cls):
        table = pandas.read_csv(COMMITTED / "claims.csv")
        cls.rows = {(row["claim"], row["scene"]): row for _, row in table.iterrows()}
        cls.page, cls.checked = (COMMITTED / "index.html").read_text(), 0

    def check(self, claim, label, value):
        """The value equals that of claims.csv to its five digits, and its first three digits stand in the
        claim's row of the page."""
        self.assertAlmostEqual(self.rows[claim, label]["value"] / value, 1, delta=1e-4, msg=(claim, label))
        row = re.search(rf'<tr id="{claim}">.*?</tr>', self.page, re.S)[0]
        digits = (
            f"{value:,.0f}"
            if value == round(value)
            else f"{value:.3g}"
            if value < 1000
            else f"{float(f'{value:.3g}'):,.0f}"
        )
        self.assertIn(digits.rstrip("0").rstrip(".") if "." in digits else digits, row, (claim, label))
        type(self).checked += 1

    def of(self, table, algorithm, preset, k="8"):
        own = table[(table["algorithm"] == algorithm) & (table["preset"] == preset) & (table["k"] == k)]
        self.assertGreater(len(own), 0)
        return own.sort_values("first")

    def test_the_schedule_beside_gproximity(self):
        for scene, step, pattern in (
            ("plates", "resident-plates", "plates:"),
            ("jacks 0.05", "schedules", "density=0.05,"),
            ("jacks 0.2", "schedules", "density=0.2,"),
        ):
            table = read(step)
            own = table[table["scene"].map(lambda place: pattern in place["key"])]
            for k in ("8", "18"):
                other, paper = (
                    by_round(self.of(own, algorithm, preset, k).iloc[0])
                    for algorithm, preset in (("gproximity", "fair"), ("chunked", "paper"))
                )
                self.check("schedule-resident", f"{scene}, k = {k}", (other / paper).dropna().median())
            small, large = (by_round(self.of(own, "chunked", "paper", k).iloc[0]) for k in ("8", "18"))
            self.check("choice-of-k", scene, (large / small).dropna().median())
        self.assertEqual(self.checked_here(), 9)

    def checked_here(self):
        count, type(self).checked = self.checked, 0
        return count

    def test_the_published_pair(self):
        has_phases = False
        kernels = (
            "transform_vertices",
            "refit_tops",
            "traverse",
            "traverse_in_groups",
            "traverse_queues",
            "plan_balance",
            "generate_contacts",
        )
        for scene in ("funnel", "glasses", "plates", "tower"):
            table = read(f"cells-{scene}")
            own, other = self.of(table, "chunked", "published"), self.of(table, "gproximity", "published")
            counted = [
                sum(row["kernel_times"][name]["launches"] for name in kernels if name in row["kernel_times"])
                for _, row in own.iterrows()
            ]
            counted_other = [
                sum(row["kernel_times"][name]["launches"] for name in kernels if name in row["kernel_times"])
                for _, row in other.iterrows()
            ]
            self.check("fewer-launches", scene, sum(counted_other) / sum(counted))
            tests = [
                cells["work"].map(lambda work: work["counters"]["bvtt_nodes"]).sum() for cells in (own, other)
            ]
            self.check("few-more-tests", scene, tests[0] / tests[1])
            launches = [
                other.apply(stage_sum, axis=1, stages=[stage], kind="launches").sum()
                for stage in ("contact", "traverse")
            ]
            self.check("contact-after-traversal", scene, launches[0] / launches[1])
            if "phases" in own:  # records of older programs have none
                has_phases = True
                narrow = [
                    sum(phase_by_round(row, "narrow phase") for _, row in cells.iterrows())
                    for cells in (own, other)
                ]
                together = set(own["session"]) == set(other["session"])  # the rounds of both took turns
                self.check(
                    "narrow-small-array",
                    scene,
                    (narrow[1] / narrow[0]).median() if together else narrow[1].median() / narrow[0].median(),
                )
        self.assertEqual(self.checked_here(), 16 if has_phases else 12)

    def test_simulations_and_thresholds(self):
        claim = "median-contacts"
        tested = [scene for (name, scene), row in self.rows.items() if name == claim and row["value"] > 0]
        for scene in tested:
            steps = pandas.read_json(COMMITTED / self.rows[claim, scene]["records"], lines=True, dtype=False)
            steps = steps[steps["kind"] == "step"].drop_duplicates("step", keep="last")
            self.check(claim, scene, steps["contacts_kept"].median())
        table = read("thresholds")
        own = {
            row["settings"]["seed_threshold"]: row
            for _, row in self.of(table, "chunked", "published").iterrows()
        }
        seeds = {threshold: row["work"]["counters"]["seeds"] for threshold, row in own.items()}
        self.check("threshold-level", "glasses", seeds["10000"] / seeds["1000"])
        self.assertEqual(self.checked_here(), 1 + len(tested))
