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
THREE_MS = [3 * ms for ms in ONE_MS]
NEARLY_ONE_MS = [ONE_MS[4], ONE_MS[1] + 0.002, *ONE_MS[2:4], ONE_MS[0], *ONE_MS[5:]]
PAIRS = Answer(3, "1", "2")


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
            (
                [b, a],
                [1, 0],
                ["a is the fastest of 2 with 1.000 ms a frame; the next, b, takes 2.000 times as long ["],
            ),
            (
                [a, b, cell_of("c", THREE_MS)],
                [0, 1, 2],
                [
                    "a is the fastest of 3 with 1.000 ms a frame; the next, b, takes 2.000",
                    "The slowest, c, takes 3.000 times as long",
                ],
            ),
            ([a, cell_of("b", NEARLY_ONE_MS)], [0, 1], ["is not told apart from it (1.000 times its time ["]),
            (
                [cell_of("a", [1.0]), cell_of("b", [2.0])],
                [0, 1],
                ["takes 2.000 times as long (one round: no interval)"],
            ),
            (
                [b, cell_of("a", ONE_MS, status="wrong"), cell_of("c", ONE_MS, **failed), older],
                [0],
                [
                    "b takes 2.000 ms a frame; there is nothing to compare it with.",
                    "a was wrong, and is not ranked: its answer is not the reference's.",
                    "c failed, and is not ranked: no memory.",
                ],
            ),
            (
                [cell_of("a", ONE_MS, pairs=PAIRS), cell_of("b", TWO_MS, pairs=Answer(4, "1", "2"))],
                [0, 1],
                ["none counts as the fastest"],
            ),
            ([cell_of("a", ONE_MS, pairs=Answer(0, "0", "0")), b], [1], []),
            ([cell_of("a", [], **failed)], [], ["None of its cells has valid times."]),
        ):
            group, sentences = first_group(cells)
            self.assertEqual([one.cell for one in group.ranked], ranked, sentences)
            self.assertEqual([part for part in parts if part not in sentences], [], sentences)
        self.assertEqual(first_group([a])[0].title, "pile, frames 0:0, k = 18, on cuda:0 (GPU)")
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
        for cells, summary in (
            (
                [a, b],
                [
                    "a is the fastest in the only comparison; the best other algorithm takes 2.000 times as long."
                ],
            ),
            (
                [a, cell_of("b", NEARLY_ONE_MS), cell_of("a", ONE_MS, "8"), cell_of("b", TWO_MS, "8")],
                [
                    "a leads in all 2 comparisons; the best other algorithm takes 1.000 to 2.000 times "
                    "as long, and is told apart from it in 1 of these."
                ],
            ),
            (
                [b, *bad, older],
                [
                    "1 failed and 1 gave a wrong answer: they are shown as such and never ranked.",
                    "1 were recorded again later: the last record that is ok counts.",
                ],
            ),
            ([cell_of("a", ONE_MS, pairs=PAIRS), cell_of("b", TWO_MS, pairs=Answer(4, "1", "2"))], []),
            ([cell_of("a", ONE_MS, kind="cpu")], ["Times on processors do not predict times on a GPU."]),
        ):
            self.assertEqual(summary_sentences(groups_of(cells), cells), summary)

    def test_the_stage_that_makes_the_difference(self):
        """Compared with the first cell that takes longer with its whole interval; times of stages that are
        shorter count against others."""
        most, largest = (
            f"{part} of the difference from b is in stage {{}}: {{}} ms a frame instead of {{}}."
            for part in ("Most", "The largest part")
        )
        for first, second, third, sentence in (
            (
                {"traverse": 0.5, "contact": 0.4},
                {"traverse": 1.3, "contact": 0.6},
                {},
                most.format("traverse", "0.500", "1.300"),
            ),
            ({"traverse": 0.5}, {"traverse": 0.4, "balance": 1.0}, {}, most.format("balance", "0", "1.000")),
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
                most.format("traverse", "0.500", "1.500"),
            ),
            ({}, {"traverse": 1.5}, {}, ""),
            ({"traverse": 1.0}, {"traverse": 0.9}, {}, ""),
        ):
            cells = [cell_of("a", ONE_MS, stages=first), cell_of("b", TWO_MS, stages=second)]
            cells += [cell_of("c", [ms + 0.001 for ms in ONE_MS], stages=third)] if third else []
            self.assertEqual(
                first_group(cells)[1].partition("[")[2].partition("]. ")[2].partition(" The s")[0], sentence
            )

    def test_a_title_agrees_with_its_sentence(self):
        """Title, sentence and the words behind the name of the first come from one verdict."""
        lowest, one_round = ", which leads", "(one round: no interval)"
        for other, first, behind, word in (
            (
                TWO_MS,
                "a is the fastest; the next takes 2.000 times as long [",
                ", the fastest",
                "fastest of 2",
            ),
            (
                NEARLY_ONE_MS,
                "a and the next are not told apart: 1.000 times as long [",
                lowest,
                "not told apart",
            ),
            ([2.0], f"a leads; the next takes 2.000 times as long {one_round}", lowest, one_round),
        ):
            cells = [cell_of("a", ONE_MS[: len(other)]), cell_of("b", other)]
            data = data_of(Records(["some.jsonl"], cells), 1_000_000)
            [group] = json.loads(data.json)["groups"]
            self.assertEqual((group["lead"][: len(first)], group["which"]), (first, behind))
            self.assertIn(word, data.sentences[0])

    def test_the_fastest_is_so_by_its_ratios(self):
        """The second has the greater median, but most of its rounds are faster than those of the first."""
        rounds = [1.0] * 6 + [3.0] * 4
        other = [0.99] * 5 + [1.2] + [2.9] * 4
        group, sentences = first_group([cell_of("a", rounds, session="s"), cell_of("b", other, session="s")])
        self.assertEqual([one.cell for one in group.ranked], [1, 0])
        self.assertTrue(group.ranked[1].is_told_apart)
        self.assertIn("b is the fastest", sentences)

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
        [sweep] = sweeps_of(swept("seed_threshold", ["1000", "0", "10"], [TWO_MS, THREE_MS, ONE_MS]))
        self.assertEqual(
            (sweep["setting"], sweep["of"], sweep["all"]),
            ("seed_threshold", "pile:bodies=3, frames 0:0, k = 18, on cuda:0 (GPU)", 1),
        )
        self.assertEqual(sweep["lines"], [{"name": "a", "points": [[0, 1], [10, 2], [1000, 0]]}])
        self.assertIn(
            "seed_threshold = 10 is the fastest of 3 cells with 1.000 ms a frame; the next, seed_threshold = 1000, takes",
            sweep["words"],
        )

    def test_titles(self):
        times = [ONE_MS, TWO_MS, THREE_MS]
        for setting, rounds, pairs, title in (
            ("seed_threshold", times, 0, "= 1 is the fastest; the next takes 2.000 times as long ["),
            ("seed_threshold", [[1.0], [2.0], [3.0]], 0, "= 1 leads; the next takes 2.000 times"),
            ("seed_threshold", times, 3, "Answers differ: these times are of different work"),
            ("k", times, 3, "k = 1 is the fastest"),
        ):
            [sweep] = sweeps_of(swept(setting, ["1", "10", "100"], rounds, pairs=pairs))
            self.assertIn(title, sweep["title"])
        cells = [cell for k in ("18", "8") for cell in swept("seed_threshold", ["0", "1", "2"], times, k)]
        found = [(sweep["of"].split(", ")[2], sweep["all"]) for sweep in sweeps_of(cells)]
        self.assertEqual(found, [("k = 18", 1), ("k = 8", 1)])

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
    def test_omits_the_last_cells(self):
        for size, least, most in ((100_000, 20, 20), (20_000, 5, 15), (1, 0, 0)):
            records = Records(
                ["some.jsonl"], [cell_of(f"a{i}", [60]) for i in range(20)], notes=["a torn line"]
            )
            data = data_of(records, size)
            shown = Shown(markup([section.content for section in data.sections]))
            self.assertEqual(len(json.loads(data.json)["cells"]), data.cells)
            self.assertEqual(sum(len(row) > 1 for row in shown.rows), data.cells)
            self.assertTrue(
                least <= data.cells <= most and (data.size <= size or most == 0), (data.cells, data.size)
            )
            left_out = f"the last {20 - data.cells} of 20 cells are left out, so that the page stays small; "
            self.assertEqual([note.startswith(left_out) for note in data.notes[1:]], [True] * (most < 20))
            self.assertTrue(all(f"Left out: {note}." in shown.words for note in data.notes))
