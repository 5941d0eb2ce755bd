# SPDX-License-Identifier: MIT
# test: cost=1
"""What a page about records states (python/tandem/report): groups, ranks,
sentences, conditions, and omissions for lack of space."""

import dataclasses
import json
import statistics
import unittest

from tests.report.case import Shown

from tandem.cell import Answer, Cell
from tandem.pages.markup import markup
from tandem.report.cells import COLUMNS
from tandem.report.conditions import conditions_text, sampling_text
from tandem.report.data import data_of
from tandem.report.groups import groups_of
from tandem.report.leads import ratio_text
from tandem.report.reading import Records
from tandem.ratio import Ratio
from tandem.report.sentences import group_sentences, stage_text, summary_sentences

ONE_MS = [1.0, 1.01, 0.99, 1.0, 1.02, 0.98, 1.0, 1.01, 0.99, 1.0]
TWO_MS = [2 * ms for ms in ONE_MS]
THREE_MS = [3 * ms for ms in ONE_MS]
NEARLY_ONE_MS = [ONE_MS[4], ONE_MS[1] + 0.002, *ONE_MS[2:4], ONE_MS[0], *ONE_MS[5:]]
PAIRS = Answer(3, "1", "2")


def _summary(samples):
    return (
        {"median": statistics.median(samples), "low": min(samples), "high": max(samples)} if samples else {}
    )


def cell_of(algorithm, rounds, k="18", pairs=None, kind="gpu", stages=None, **changes):
    """A cell with these times of its rounds, in ms of its frames."""
    samples = [1e6 * ms for ms in rounds]
    record = {
        "schema": 4,
        "key": f"{algorithm}|k={k}",
        "session": "",
        "status": "ok",
        "failure": None,
        "algorithm": algorithm,
        "preset": "",
        "settings": {"k": k},
        "devices": [{"id": "cuda:0", "name": "GPU", "driver": "1", "kind": kind}],
        "scene": {"key": "pile:bodies=3", "name": "pile", "digest": "1", "bodies": 3, "tetrahedra": 36},
        "frames": {"first": 0, "last": 0},
        "total_ns": {"samples": samples, "rounds": [*range(len(samples))], **_summary(samples)},
        "stages": {
            name: {"device_ns": {"median": 1e6 * ms}, "host_ns": {"median": 0}}
            for name, ms in (stages or {}).items()
        },
        "work": pairs and {"digest": dataclasses.asdict(pairs)},
        "environment": {"commit": "1", "dirty": False, "date": "2026"},
    }
    return Cell(record | changes, "some.jsonl", 1)


def first_group(cells):
    """The first group and its sentences."""
    group = groups_of(cells)[0]
    return group, group_sentences(group, cells)


class Sentences(unittest.TestCase):
    def test_sentences_of_a_group(self):
        failed = {"status": "failed", "failure": "no memory"}
        older = cell_of("d", ONE_MS)
        older.is_older = True
        a, b = cell_of("a", ONE_MS), cell_of("b", TWO_MS)
        for cells, ranked, parts in (
            ([b, a], [1, 0], ["a is fastest: 1.00 ms per frame, 2.00 times as fast as b ["]),
            (
                [a, b, cell_of("c", THREE_MS)],
                [0, 1, 2],
                [
                    "a is fastest: 1.00 ms per frame, 2.00 times as fast as b [",
                    "The slowest, c, takes 3.00 times as long [",
                ],
            ),
            (
                [a, cell_of("b", NEARLY_ONE_MS)],
                [0, 1],
                ["a and b cannot be told apart: 1.00 ms per frame, ratio ["],
            ),
            (
                [cell_of("a", [1.0]), cell_of("b", [2.0])],
                [0, 1],
                [
                    "a took the least time, in fewer than 5 rounds: 1.00 ms per frame, 2.00 times as fast as b."
                ],
            ),
            (
                [b, cell_of("a", ONE_MS, status="wrong"), cell_of("c", ONE_MS, **failed), older],
                [0],
                [
                    "b takes 2.00 ms per frame; there is nothing to compare it with.",
                    "a is wrong: its answer is not the reference's.",
                    "c failed: no memory.",
                ],
            ),
            (
                [cell_of("a", ONE_MS, pairs=PAIRS), cell_of("b", TWO_MS, pairs=Answer(4, "1", "2"))],
                [0, 1],
                ["Answers differ: these times are of different work."],
            ),
            ([cell_of("a", ONE_MS, pairs=Answer(0, "0", "0")), b], [1], []),
            ([cell_of("a", [], **failed)], [], ["None of these cells has valid times."]),
        ):
            group, sentences = first_group(cells)
            self.assertEqual([one.cell for one in group.ranked], ranked, sentences)
            self.assertEqual([part for part in parts if part not in sentences], [], sentences)
        self.assertEqual(
            first_group([a])[0].title, "3 jacks, density 0.2, frames 0:0, k = 18, on cuda:0 (GPU)"
        )
        self.assertEqual(len(groups_of([a, cell_of("a", TWO_MS, "8")])), 2)  # other bounds
        for name, usual, value in (
            ("margin", "0", "0.1"),
            ("motion", "none", "linear"),
            ("self", "off", "on"),
        ):
            for text, count in ((usual, 1), (value, 2)):  # records of before have none of these settings
                other = cell_of("a", TWO_MS, settings={"k": "18", name: text})
                self.assertEqual(len(groups_of([a, other])), count, (name, text))

    def test_summaries(self):
        a, b = cell_of("a", ONE_MS), cell_of("b", TWO_MS)
        older = cell_of("d", ONE_MS)
        older.is_older = True
        bad = cell_of("b", ONE_MS, status="wrong"), cell_of("c", ONE_MS, status="failed", failure="x")
        differ = [cell_of("a", ONE_MS, pairs=PAIRS), cell_of("b", TWO_MS, pairs=Answer(4, "1", "2"))]
        eight = [cell_of("a", ONE_MS, "8"), cell_of("b", TWO_MS, "8")]
        elsewhere = cell_of("c", ONE_MS, "8", scene=a.record["scene"] | {"key": "plates", "digest": "2"})
        nearly = cell_of("b", NEARLY_ONE_MS)
        for cells, summary in (
            ([a, b], ["a is fastest: 1.00 ms per frame, 2.00 times as fast as b [1.97, 2.03]."]),
            (
                [a, b, elsewhere],
                [
                    "3 jacks, density 0.2: a is fastest: 1.00 ms per frame, 2.00 times as fast as b [1.97, 2.03]."
                ],
            ),
            ([a, b, *eight], ["a is fastest in all 2 comparisons, 2.00 times as fast as the next method."]),
            (
                [
                    a,
                    b,
                    cell_of("a", [4.0, 4.1, 4.05, 4.0, 4.1], "8"),
                    cell_of("b", ONE_MS, "8"),
                    elsewhere,
                    cell_of("a", THREE_MS, "8", scene=elsewhere.record["scene"]),
                ],
                [
                    "a is fastest in 1 of 3 comparisons, 2.00 times as fast as the next method; b in 1, 4.05 times; c in 1, 3.00 times."
                ],
            ),
            (
                [a, nearly, *eight],
                [
                    "a is fastest in 1 of 2 comparisons, 2.00 times as fast as the next method; the two fastest methods "
                    "cannot be told apart in 1."
                ],
            ),
            (
                [b, *bad, older],
                [
                    "b takes 2.00 ms per frame; there is nothing to compare it with.",
                    "1 failed and 1 gave a wrong answer: they are shown as such and never ranked.",
                    "1 were recorded again later: the last record that is ok counts.",
                ],
            ),
            (differ, ["Answers differ: these times are of different work."]),
            (
                [cell_of("a", ONE_MS, kind="cpu")],
                [
                    "a takes 1.00 ms per frame; there is nothing to compare it with.",
                    "Times on processors do not predict times on a GPU.",
                ],
            ),
        ):
            self.assertEqual(summary_sentences(groups_of(cells), cells), summary)

    def test_the_stage_that_makes_the_difference(self):
        """Compared with the first cell that takes longer with its whole interval; times of stages that are
        shorter count against others."""
        most, largest = (
            f"Stage {{}} makes {part} of the difference: {{}} ms per frame with a, {{}} with b"
            for part in ("most", "the largest part")
        )
        for first, second, third, sentence in (
            (
                {"traverse": 0.5, "contact": 0.4},
                {"traverse": 1.3, "contact": 0.6},
                {},
                most.format("traverse", "0.500", "1.30"),
            ),
            ({"traverse": 0.5}, {"traverse": 0.4, "balance": 1.0}, {}, most.format("balance", "0", "1.00")),
            (
                {"traverse": 0.5, "contact": 0.3},
                {"traverse": 0.9, "contact": 0.8, "refit": 0.3},
                {},
                largest.format("contact", "0.300", "0.800"),
            ),
            (
                {"traverse": 0.5},
                {"traverse": 1.5},
                {"traverse": 3.0},
                most.format("traverse", "0.500", "1.50"),
            ),
            ({}, {"traverse": 1.5}, {}, ""),
            ({"traverse": 1.0}, {"traverse": 0.9}, {}, ""),
        ):
            cells = [cell_of("a", ONE_MS, stages=first), cell_of("b", TWO_MS, stages=second)]
            cells += [cell_of("c", [ms + 0.001 for ms in ONE_MS], stages=third)] if third else []
            group, sentences = first_group(cells)
            self.assertEqual(stage_text(group, cells), sentence)
            self.assertIn(f" {sentence}." if sentence else "", sentences)

    def test_a_title_agrees_with_its_sentence(self):
        """The title of the first chart, its marks and the sentence come from one verdict."""
        for other, first, leaders in (
            (TWO_MS, "a is fastest: 1.00 ms per frame, 2.00 times as fast as b [", [True, False]),
            (NEARLY_ONE_MS, "a and b cannot be told apart: 1.00 ms per frame, ratio [", [True, True]),
            (
                [2.0],
                "a took the least time, in fewer than 5 rounds: 1.00 ms per frame, 2.00 times as fast as b",
                [True, False],
            ),
        ):
            cells = [cell_of("a", ONE_MS[: len(other)]), cell_of("b", other)]
            data = data_of(Records(["some.jsonl"], cells), 1_000_000)
            chart = json.loads(data.json)["overview"]
            self.assertEqual(chart["title"][: len(first)], first)
            self.assertEqual((chart["methods"], chart["rows"][0]["leaders"]), (["a", "b"], leaders))
            self.assertIn(f"{chart['title']}.", data.sentences[0])

    def test_ratios_near_1_have_more_digits(self):
        for values, text in (
            ((1.0031, 1.0012, 1.0049), "1.003 [1.001, 1.005]"),
            ((1.0003, 1.0001, 1.0005), "1.0003 [1.0001, 1.0005]"),
            ((1.004, 0.998, 1.012), "1.00 [0.998, 1.01]"),
            ((2.168, 2.145, 2184.2), "2.17 [2.15, 2,184]"),
        ):
            self.assertEqual(ratio_text(Ratio(*values, 0.0), True), text)

    def test_the_fastest_is_so_by_its_ratios(self):
        """The second has the greater median, but most of its rounds are faster than those of the first."""
        rounds = [1.0] * 6 + [3.0] * 4
        other = [0.99] * 5 + [1.2] + [2.9] * 4
        group, sentences = first_group([cell_of("a", rounds, session="s"), cell_of("b", other, session="s")])
        self.assertEqual([one.cell for one in group.ranked], [1, 0])
        self.assertTrue(group.ranked[1].is_told_apart)
        self.assertIn("b is fastest: ", sentences)

    def test_rounds_of_one_session_are_pairs(self):
        """Rounds that rise and fall together distinguish cells of one session, but not cells of two sessions."""
        tide = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]
        for sessions, is_distinguished in (("ss", True), ("st", False)):
            cells = [
                cell_of(name, [factor * ms for ms in tide], session=session)
                for name, factor, session in zip("ab", (1, 1.05), sessions)
            ]
            self.assertEqual(groups_of(cells)[0].ranked[1].is_told_apart, is_distinguished)

    def test_of_many_failures_some_are_named(self):
        cells = [cell_of(f"a{i}", [], status="failed", failure="x" * 150) for i in range(40)]
        _, sentences = first_group(cells)
        self.assertTrue(sentences.endswith(" There are more."), sentences)
        self.assertLess(len(sentences), 1300)


class Conditions(unittest.TestCase):
    def test_readings_before_and_after(self):
        def reading(mhz, celsius, processes, busy):
            return {
                "gpus": [
                    {"sm_mhz": mhz, "temperature_c": celsius, "power_w": None, "other_processes": processes}
                ],
                "processor": {"mhz": [2100, None, 2300], "other_cores": busy},
            }

        conditions = {
            "before": reading(1980, 41, 0, 0.5),
            "after": reading(1980, 52, 0, 0.25),
            "disturbed": [{"why": "clocks fell"}],
        }
        self.assertEqual(
            conditions_text({"conditions": conditions}),
            "GPU at 1980 MHz, 41 to 52 °C, processor at 2100 to 2300 MHz, "
            "cores used by other processes: 0.25 to 0.5, 1 doubtful round, the first: clocks fell",
        )
        conditions["after"] = reading(1755, 52, 2, 0.25)
        self.assertIn("GPU at 1755 to 1980 MHz", conditions_text({"conditions": conditions}))
        self.assertIn("other processes on it: 0 to 2", conditions_text({"conditions": conditions}))
        self.assertEqual(conditions_text({}), "not recorded")

    def test_samples(self):
        self.assertEqual(sampling_text({}), "not recorded")
        self.assertEqual(
            sampling_text({"sampling": {"converged": True, "outliers": 0, "drift": None}}), "no problems"
        )
        self.assertEqual(
            sampling_text(
                {"sampling": {"converged": False, "interrupted": True, "outliers": 3, "drift": 0.0123}}
            ),
            "interval wider than requested, interrupted before it had enough samples, outliers: 3, drifted by 1.2 %",
        )


class Data(unittest.TestCase):
    def test_omits_the_last_cells(self):
        for size, least, most in ((100_000, 20, 20), (20_000, 5, 15), (1, 0, 0)):
            records = Records(
                ["some.jsonl"], [cell_of(f"a{i}", [60]) for i in range(20)], notes=["a torn line"]
            )
            data = data_of(records, size)
            shown = Shown(markup([section.content for section in data.sections]))
            self.assertEqual(len(json.loads(data.json)["cells"]), data.cells)
            self.assertEqual(sum(len(row) == len(COLUMNS) for row in shown.rows), data.cells)
            self.assertTrue(
                least <= data.cells <= most and (data.size <= size or most == 0), (data.cells, data.size)
            )
            left_out = f"the last {20 - data.cells} of 20 cells are left out, so that the page stays small; "
            self.assertEqual([note.startswith(left_out) for note in data.notes[1:]], [True] * (most < 20))
            self.assertTrue(all(f"Left out: {note}." in shown.words for note in data.notes))
