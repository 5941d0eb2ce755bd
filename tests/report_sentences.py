#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""report_sentences.py PROGRAM SOURCE: what a page about records states (python/tandem/report): groups, ranks, sentences,
conditions, and omissions for lack of space."""
import copy
import json
import sys
import unittest

from program import SOURCE

sys.path.insert(0, str(SOURCE / "python"))
from tandem.comparison.cells import Answer, RecordedCell
from tandem.report.conditions import conditions_text, sampling_text
from tandem.report.data import data_of
from tandem.report.groups import groups_of
from tandem.report.reading import Records
from tandem.report.sentences import group_sentences, summary_sentences
from tandem.report.shown_cells import FIELDS, ShownCell

ONE_MS = [1.0, 1.01, 0.99, 1.0, 1.02, 0.98, 1.0, 1.01, 0.99, 1.0]
TWO_MS = [2 * ms for ms in ONE_MS]


def cell_of(algorithm, rounds, k="18", **changes):
    """A cell with these times of its rounds, in ms of its single frame."""
    names = {"algorithm": algorithm, "preset": "resident", "devices": "cuda:0", "model": "GPU", "driver": "1", "scene": "pile",
             "frames": "frames 0:0", "handling": "", "digest": "digest 1"}
    recorded = RecordedCell(line=1, schema=3, key=f"{algorithm}|k={k}", status="ok", failure="", names=names, settings={"k": k}, frames=1,
                            on_gpus=True, session="", seed=None, samples=len(rounds), rounds={i: 1e6 * ms for i, ms in enumerate(rounds)},
                            pairs=None, contacts=None, commit="", processor="", dirty=False)
    for name, value in changes.items():
        setattr(recorded, name, value)
    return ShownCell(recorded, "pile:bodies=3", "pile", "1", row=[f"text {algorithm}"] * (len(FIELDS) - 1))


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
        self.assertIn("quick is the fastest of 2 with 1.000 ms a frame; the next, slow, takes 2.000 times as long [", sentences)
        summary = summary_sentences(groups, cells)
        self.assertIn("quick is the fastest in 1 of 1 comparisons, told apart from the best other algorithm in 1, which takes 2.000", summary[0])
        self.assertEqual(len(summary), 1)

    def test_the_slowest_of_three(self):
        _, sentences = groups_and_sentences([cell_of("a", ONE_MS), cell_of("b", TWO_MS), cell_of("c", [3 * ms for ms in ONE_MS])])
        self.assertIn("a is the fastest of 3 with 1.000 ms a frame; the next, b, takes 2.000", sentences)
        self.assertIn("The slowest, c, takes 3.000 times as long", sentences)

    def test_indistinguishable_cells(self):
        nearly = [ONE_MS[4], ONE_MS[1] + 0.002, *ONE_MS[2:4], ONE_MS[0], *ONE_MS[5:]]
        groups, sentences = groups_and_sentences([cell_of("a", ONE_MS), cell_of("b", nearly)])
        self.assertFalse(groups[0].ranked[1].is_told_apart)
        self.assertIn("is not told apart from it (1.000 times its time [", sentences)

    def test_one_round_is_not_enough(self):
        groups, sentences = groups_and_sentences([cell_of("a", [1.0]), cell_of("b", [2.0])])
        self.assertFalse(groups[0].ranked[1].is_told_apart)
        self.assertIn("takes 2.000 times as long (one round: no interval)", sentences)

    def test_rounds_of_one_session_are_pairs(self):
        """Rounds that rise and fall together distinguish cells of one session, but not cells of two sessions."""
        tide = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]
        for sessions, is_distinguished in ((("s", "s"), True), (("s", "t"), False)):
            cells = [cell_of(name, [factor * ms for ms in tide], session=session)
                     for name, factor, session in zip("ab", (1, 1.05), sessions)]
            self.assertEqual(groups_of(cells)[0].ranked[1].is_told_apart, is_distinguished)

    def test_failed_wrong_and_older_are_never_ranked(self):
        cells = [cell_of("a", TWO_MS), cell_of("b", ONE_MS, status="wrong"), cell_of("c", ONE_MS, status="failed", failure="no memory"),
                 cell_of("d", ONE_MS)]
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
        _, sentences = groups_and_sentences([cell_of(f"a{i}", [], status="failed", failure="x" * 150) for i in range(40)])
        self.assertTrue(sentences.startswith("None of its cells has valid times."), sentences)
        self.assertTrue(sentences.endswith(" There are more."), sentences)
        self.assertLess(len(sentences), 1300)

    def test_other_bounds_are_another_group(self):
        self.assertEqual(len(groups_of([cell_of("a", ONE_MS), cell_of("a", TWO_MS, "8")])), 2)

    def test_different_answers_have_no_fastest(self):
        cells = [cell_of("a", ONE_MS, pairs=Answer(3, "1", "2")), cell_of("b", TWO_MS, pairs=Answer(4, "1", "2"))]
        groups, sentences = groups_and_sentences(cells)
        self.assertIn("none counts as the fastest", sentences)
        self.assertEqual(summary_sentences(groups, cells), [])

    def test_without_pairs_nothing_is_ranked(self):
        groups, _ = groups_and_sentences([cell_of("a", ONE_MS, pairs=Answer(0, "0", "0")), cell_of("b", TWO_MS)])
        self.assertEqual([ranked.cell for ranked in groups[0].ranked], [1])

    def test_processors(self):
        cells = [cell_of("a", ONE_MS, on_gpus=False)]
        self.assertEqual(summary_sentences(groups_of(cells), cells), ["Times on processors do not predict times on a GPU."])


class Conditions(unittest.TestCase):
    def test_readings_before_and_after(self):
        def reading(mhz, celsius, processes, busy):
            return {"gpus": [{"sm_mhz": mhz, "temperature_c": celsius, "power_w": None, "other_processes": processes}],
                    "processor": {"mhz": [2100, None, 2300], "other_cores": busy}}
        conditions = {"before": reading(1980, 41, 0, 0.5), "after": reading(1980, 52, 0, 0.25), "disturbed": [{"why": "clocks fell"}]}
        self.assertEqual(conditions_text({"conditions": conditions}), "GPU at 1980 MHz, 41 to 52 °C, processor at 2100 to 2300 MHz, "
                         "cores used by other processes: 0.25 to 0.5, 1 doubtful round, the first: clocks fell")
        conditions["after"] = reading(1755, 52, 2, 0.25)
        self.assertIn("GPU at 1755 to 1980 MHz", conditions_text({"conditions": conditions}))
        self.assertIn("other processes on it: 0 to 2", conditions_text({"conditions": conditions}))
        self.assertEqual(conditions_text({}), "not recorded")

    def test_samples(self):
        self.assertEqual(sampling_text({}), "not recorded")
        self.assertEqual(sampling_text({"sampling": {"converged": True, "outliers": 0, "drift": None}}), "no problems")
        self.assertEqual(sampling_text({"sampling": {"converged": False, "interrupted": True, "outliers": 3, "drift": 0.0123}}),
                         "interval wider than requested, interrupted before it had enough samples, outliers: 3, drifted by 1.2 %")


class Data(unittest.TestCase):
    def test_omits_the_last_cells_with_a_note(self):
        data = data_of(Records(cells=[cell_of(f"a{i}", ONE_MS) for i in range(200)]), 40_000, "", "")
        self.assertLess(len(data.json), 50_000)
        made = json.loads(data.json)
        self.assertLess(len(made["cells"]), 200)
        self.assertGreater(len(made["cells"]), 10)
        self.assertEqual((len(made["cells"]), made["notes"]), (data.cells, data.notes))
        self.assertIn("of 200 cells are left out", data.notes[0])

    def test_curves_are_omitted_before_cells(self):
        cells = [cell_of(f"a{i}", ONE_MS) for i in range(20)]
        for cell in cells:
            cell.curve, cell.rounds = [0.123] * 500, [1.5] * 10
        whole = json.loads(data_of(Records(cells=copy.deepcopy(cells)), 1_000_000, "", "").json)
        self.assertEqual((whole["notes"], sum(curve is None for curve in whole["curves"])), ([], 0))
        less = json.loads(data_of(Records(cells=cells), 40_000, "", "").json)
        self.assertEqual(len(less["cells"]), 20)
        missing = sum(curve is None for curve in less["curves"])
        self.assertTrue(0 < missing < 20, missing)
        self.assertEqual(less["notes"], [f"times by frame or by round of some cells are left out ({missing} lists), so that the page stays small"])

    def test_common_values_are_stored_once(self):
        made = json.loads(data_of(Records(cells=[cell_of("a", ONE_MS), cell_of("a", TWO_MS)]), 1_000_000, "p", "d").json)
        self.assertEqual(made["values"], ["text a"])
        self.assertEqual((made["program"], made["date"], made["fields"][-1]), ("p", "d", "label"))
        self.assertEqual([row[0] for row in made["cells"]], [0, 0])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
