# SPDX-License-Identifier: MIT
# test: cost=1
"""What a page about records states (python/tandem/report): groups, ranks,
sentences, conditions, and omissions for lack of space."""

import dataclasses
import json
import re
import unittest

from tests.report.case import Shown

from tandem.cell import Answer, Cell
from tandem.pages.markup import markup
from tandem.report.conditions import conditions_text, sampling_text
from tandem.report.data import data_of
from tandem.report.groups import groups_of
from tandem.report.reading import Records
from tandem.report.sentences import group_sentences, summary_sentences
from tandem.report.sweeps import sweeps_of

ONE_MS = [1.0, 1.01, 0.99, 1.0, 1.02, 0.98, 1.0, 1.01, 0.99, 1.0]
TWO_MS = [2 * ms for ms in ONE_MS]


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
        "preset": "resident",
        "settings": {"k": k},
        "devices": [{"id": "cuda:0", "name": "GPU", "driver": "1", "kind": kind}],
        "scene": {"key": "pile:bodies=3", "name": "pile", "digest": "1", "bodies": 3, "tetrahedra": 36},
        "frames": {"first": 0, "last": 0},
        "total_ns": {"samples": samples, "rounds": [*range(len(samples))]},
        "stages": {
            name: {"device_ns": {"median": 1e6 * ms}, "host_ns": {"median": 0}}
            for name, ms in (stages or {}).items()
        },
        "work": pairs and {"digest": dataclasses.asdict(pairs)},
        "environment": {"commit": "1", "dirty": False, "date": "2026"},
    }
    return Cell(record | changes, "some.jsonl", 1)


def groups_and_sentences(cells):
    """The groups, and the sentences of the first."""
    groups = groups_of(cells)
    return groups, group_sentences(groups[0], cells)


class Sentences(unittest.TestCase):
    def test_the_fastest_and_by_how_much(self):
        cells = [cell_of("slow", TWO_MS), cell_of("quick", ONE_MS)]
        groups, sentences = groups_and_sentences(cells)
        self.assertEqual([group.title for group in groups], ["pile, frames 0:0, k = 18, on cuda:0 (GPU)"])
        self.assertEqual([ranked.cell for ranked in groups[0].ranked], [1, 0])
        self.assertIn(
            "quick is the fastest of 2 with 1.000 ms a frame; the next, slow, takes 2.000 times as long [",
            sentences,
        )
        summary = summary_sentences(groups, cells)
        self.assertEqual(
            "quick is the fastest in the only comparison; the best other algorithm takes 2.000 times as long.",
            summary[0],
        )
        self.assertEqual(len(summary), 1)

    def test_the_slowest_of_three(self):
        _, sentences = groups_and_sentences(
            [cell_of("a", ONE_MS), cell_of("b", TWO_MS), cell_of("c", [3 * ms for ms in ONE_MS])]
        )
        self.assertIn("a is the fastest of 3 with 1.000 ms a frame; the next, b, takes 2.000", sentences)
        self.assertIn("The slowest, c, takes 3.000 times as long", sentences)

    def test_the_stage_that_makes_the_difference(self):
        """Compared with the first cell that takes longer with its whole interval; times of stages that are
        shorter count against others."""

        def named(first, second, third=None):
            cells = [cell_of("a", ONE_MS, stages=first), cell_of("b", TWO_MS, stages=second)] + (
                [cell_of("c", [ms + 0.001 for ms in ONE_MS], stages=third)] if third else []
            )
            return groups_and_sentences(cells)[1].partition("[")[2].partition("]. ")[2]

        self.assertEqual(
            named({"traverse": 0.5, "contact": 0.4}, {"traverse": 1.3, "contact": 0.6}),
            "Most of the difference from b is in stage traverse: 0.500 ms a frame instead of 1.300.",
        )
        self.assertEqual(
            named({"traverse": 0.5}, {"traverse": 0.4, "balance": 1.0}),
            "Most of the difference from b is in stage balance: 0 ms a frame instead of 1.000.",
        )
        self.assertEqual(
            named({"traverse": 0.5, "contact": 0.3}, {"traverse": 0.9, "contact": 0.8, "refit": 0.3}),
            "The largest part of the difference from b is in stage contact: 0.300 ms a frame instead of 0.800.",
        )
        self.assertIn(
            "from b is in stage traverse", named({"traverse": 0.5}, {"traverse": 1.5}, {"traverse": 3.0})
        )
        self.assertEqual(
            [named({}, {"traverse": 1.5}), named({"traverse": 1.0}, {"traverse": 0.9})], ["", ""]
        )

    def test_indistinguishable_cells(self):
        nearly = [ONE_MS[4], ONE_MS[1] + 0.002, *ONE_MS[2:4], ONE_MS[0], *ONE_MS[5:]]
        groups, sentences = groups_and_sentences([cell_of("a", ONE_MS), cell_of("b", nearly)])
        self.assertFalse(groups[0].ranked[1].is_told_apart)
        self.assertIn("is not told apart from it (1.000 times its time [", sentences)

    def test_one_round_is_not_enough(self):
        groups, sentences = groups_and_sentences([cell_of("a", [1.0]), cell_of("b", [2.0])])
        self.assertFalse(groups[0].ranked[1].is_told_apart)
        self.assertIn("takes 2.000 times as long (one round: no interval)", sentences)

    def test_a_title_agrees_with_its_sentence(self):
        """Title, sentence and the words behind the name of the first come from one verdict."""
        nearly = [ONE_MS[4], ONE_MS[1] + 0.002, *ONE_MS[2:4], ONE_MS[0], *ONE_MS[5:]]
        for other, first, behind, word in (
            (
                TWO_MS,
                "a is the fastest; the next takes 2.000 times as long [",
                ", the fastest",
                "is the fastest of 2",
            ),
            (
                nearly,
                "a and the next are not told apart: 1.000 times as long [",
                ", which has the lowest median",
                "is not told apart from it",
            ),
            (
                [2.0],
                "a has the lowest median; the next takes 2.000 times as long (one round: no interval)",
                ", which has the lowest median",
                "(one round: no interval)",
            ),
        ):
            cells = [cell_of("a", ONE_MS[: len(other)]), cell_of("b", other)]
            data = data_of(Records(["some.jsonl"], cells), 1_000_000)
            [group] = json.loads(data.json)["groups"]
            self.assertEqual((group["lead"][: len(first)], group["which"]), (first, behind))
            self.assertIn(word, data.sentences[0])

    def test_a_lower_paired_ratio_is_no_lead(self):
        """The second has the greater median, but most of its rounds are faster than those of the first."""
        rounds = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 3.0, 3.0, 3.0, 3.0]
        cells = [
            cell_of("a", rounds, session="s"),
            cell_of("b", [0.99 * ms + 0.0 for ms in rounds[:5]] + [1.2] + [2.9] * 4, session="s"),
        ]
        groups, sentences = groups_and_sentences(cells)
        self.assertTrue(
            groups[0].ranked[1].is_told_apart and groups[0].ranked[1].ratio.high < 1, groups[0].ranked
        )
        self.assertIn("has the lowest median", sentences)

    def test_wins_that_are_not_all_told_apart(self):
        nearly = [ONE_MS[4], ONE_MS[1] + 0.002, *ONE_MS[2:4], ONE_MS[0], *ONE_MS[5:]]
        cells = [
            cell_of("a", ONE_MS),
            cell_of("b", nearly),
            cell_of("a", ONE_MS, "8"),
            cell_of("b", TWO_MS, "8"),
        ]
        self.assertEqual(
            summary_sentences(groups_of(cells), cells)[0],
            "a has the lowest median in all 2 comparisons; "
            "the best other algorithm takes 1.000 to 2.000 times as long, and is told apart from it in 1 of these.",
        )

    def test_rounds_of_one_session_are_pairs(self):
        """Rounds that rise and fall together distinguish cells of one session, but not cells of two sessions."""
        tide = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]
        for sessions, is_distinguished in ((("s", "s"), True), (("s", "t"), False)):
            cells = [
                cell_of(name, [factor * ms for ms in tide], session=session)
                for name, factor, session in zip("ab", (1, 1.05), sessions)
            ]
            self.assertEqual(groups_of(cells)[0].ranked[1].is_told_apart, is_distinguished)

    def test_failed_wrong_and_older_are_never_ranked(self):
        cells = [
            cell_of("a", TWO_MS),
            cell_of("b", ONE_MS, status="wrong"),
            cell_of("c", ONE_MS, status="failed", failure="no memory"),
            cell_of("d", ONE_MS),
        ]
        cells[3].is_older = True
        groups, sentences = groups_and_sentences(cells)
        self.assertEqual([ranked.cell for ranked in groups[0].ranked], [0])
        self.assertIn("a takes 2.000 ms a frame; there is nothing to compare it with.", sentences)
        self.assertIn("b was wrong, and is not ranked: its answer is not the reference's.", sentences)
        self.assertIn("c failed, and is not ranked: no memory.", sentences)
        summary = summary_sentences(groups, cells)
        self.assertIn("1 failed and 1 gave a wrong answer", summary[0])
        self.assertIn("1 were recorded again later", summary[1])

    def test_of_many_failures_some_are_named(self):
        _, sentences = groups_and_sentences(
            [cell_of(f"a{i}", [], status="failed", failure="x" * 150) for i in range(40)]
        )
        self.assertTrue(sentences.startswith("None of its cells has valid times."), sentences)
        self.assertTrue(sentences.endswith(" There are more."), sentences)
        self.assertLess(len(sentences), 1300)

    def test_other_bounds_are_another_group(self):
        self.assertEqual(len(groups_of([cell_of("a", ONE_MS), cell_of("a", TWO_MS, "8")])), 2)

    def test_different_answers_have_no_fastest(self):
        cells = [
            cell_of("a", ONE_MS, pairs=Answer(3, "1", "2")),
            cell_of("b", TWO_MS, pairs=Answer(4, "1", "2")),
        ]
        groups, sentences = groups_and_sentences(cells)
        self.assertIn("none counts as the fastest", sentences)
        self.assertEqual(summary_sentences(groups, cells), [])

    def test_without_pairs_nothing_is_ranked(self):
        groups, _ = groups_and_sentences(
            [cell_of("a", ONE_MS, pairs=Answer(0, "0", "0")), cell_of("b", TWO_MS)]
        )
        self.assertEqual([ranked.cell for ranked in groups[0].ranked], [1])

    def test_processors(self):
        cells = [cell_of("a", ONE_MS, kind="cpu")]
        self.assertEqual(
            summary_sentences(groups_of(cells), cells), ["Times on processors do not predict times on a GPU."]
        )


def swept(setting, values, times, k="18", pairs=None, **changes):
    """Cells with these values of a setting, each with its rounds."""
    return [
        cell_of(
            "a",
            rounds,
            pairs=pairs and Answer(pairs + i, "1", "2"),
            **{"settings": {"k": k, setting: value}, "key": f"a|k={k}|{setting}={value}"} | changes,
        )
        for i, (value, rounds) in enumerate(zip(values, times))
    ]


class Sweeps(unittest.TestCase):
    def test_a_line_and_its_verdict(self):
        (sweep,) = sweeps_of(
            swept("seed_threshold", ["1000", "0", "10"], [TWO_MS, [3 * ms for ms in ONE_MS], ONE_MS])
        )
        self.assertEqual(
            (sweep["setting"], sweep["of"], sweep["all"]),
            ("seed_threshold", "pile:bodies=3, frames 0:0, k = 18, on cuda:0 (GPU)", 1),
        )
        self.assertEqual(sweep["lines"], [{"name": "a", "points": [[0, 1], [10, 2], [1000, 0]]}])
        self.assertTrue(
            sweep["title"].startswith(
                "seed_threshold = 10 is the fastest; the next takes 2.000 times as long ["
            ),
            sweep,
        )
        self.assertIn(
            "seed_threshold = 10 is the fastest of 3 cells with 1.000 ms a frame; the next, seed_threshold = 1000, takes",
            sweep["words"],
        )

    def test_one_round_has_no_fastest(self):
        (sweep,) = sweeps_of(swept("seed_threshold", ["0", "1", "2"], [[1.0], [2.0], [3.0]]))
        self.assertEqual(
            sweep["title"],
            "seed_threshold = 0 has the lowest median; the next takes 2.000 times as long (one round: no interval)",
        )

    def test_other_answers_and_other_bounds(self):
        times = [ONE_MS, TWO_MS, TWO_MS]
        cells = swept("seed_threshold", ["0", "1", "2"], times, pairs=3)
        self.assertEqual(sweeps_of(cells)[0]["title"], "Answers differ: these times are of different work")
        cells = swept("k", ["6", "8", "18"], times, pairs=3)
        self.assertIn("k = 6 is the fastest", sweeps_of(cells)[0]["title"])
        cells = [
            *swept("seed_threshold", ["0", "1", "2"], times),
            *swept("seed_threshold", ["0", "1", "2"], times, k="8"),
        ]
        self.assertEqual(
            [(sweep["of"].split(", ")[2], sweep["all"]) for sweep in sweeps_of(cells)],
            [("k = 18", 1), ("k = 8", 1)],
        )

    def test_what_is_no_sweep(self):
        times = [ONE_MS, TWO_MS, TWO_MS]
        self.assertEqual(sweeps_of(swept("rounding", ["safe", "1", "2"], times)), [])
        self.assertEqual(sweeps_of(swept("seed_threshold", ["0", "1"], times[:2])), [])
        self.assertEqual(sweeps_of(swept("seed_threshold", ["0", "1", "2"], times, status="wrong")), [])


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
    def test_omits_details_and_curves_then_the_last_cells(self):
        frames = {"frames": {"first": 0, "last": 499}}
        total = {"total_ns": {"samples": [6e7], "rounds": [0], "frames": [[123456] * 500]}}
        cells = [cell_of(f"a{i}", [60], **frames, **total) for i in range(20)]
        left_out = r"times by frame or details of some cells are left out \((\d+) of them\), so that the page stays small"
        last = r"the last (\d+) of 20 cells are left out, so that the page stays small; give fewer files or fewer lines"
        for size, notes in ((1_000_000, []), (60_000, [left_out]), (10_000, [last, left_out])):
            data = data_of(Records(["some.jsonl"], cells), size)
            made, shown = (
                json.loads(data.json)["cells"],
                Shown(markup([part.content for part in data.sections])),
            )
            self.assertLess(len(data.json) + sum(len(markup(part.content)) for part in data.sections), size)
            found = [int(re.fullmatch(note, own)[1]) for note, own in zip(notes, data.notes, strict=True)]
            kept = 20 - found[0] if last in notes else 20
            self.assertEqual((data.cells, len(made), len(shown.rows)), (kept, kept, 1 + 2 * kept))
            missing = sum("curve" not in cell for cell in made) + sum(
                row == ["left out"] for row in shown.rows
            )
            self.assertEqual(missing, found[-1] if notes else 0)
            self.assertTrue(all(note in shown.words for note in data.notes))
