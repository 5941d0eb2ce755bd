# SPDX-License-Identifier: MIT
# test: cost=10
"""The trend of cells over commits in `tandem report`: where a cell moved,
and its chart in Chromium."""

import copy
import random

from tests.report.case import ReportCase

from tandem.comparison import compare
from tandem.report.history import history_of, shown_history
from tandem.report.reading import read_records

NAMES = tuple(letter * 40 for letter in "abcde")


class History(ReportCase):
    def setUp(self):
        super().setUp()
        self.random = random.Random(7)

    def record(self, commit, factor, session="", key=""):
        """A record with `factor` times the time of the committed one, with noise of 0.2 %."""
        record = copy.deepcopy(next(one for one in self.plan if one["key"].startswith("tiled")))
        date = f"2026-05-{10 + NAMES.index(commit)}T00:00:00Z"
        record["environment"] |= {"commit": commit, "dirty": False, "date": date}
        record["settings"]["pad"] = key or "0"
        samples = [round(1e6 * factor * self.random.gauss(1, 0.002)) for _ in range(12)]
        record["total_ns"] |= {"samples": samples, "rounds": list(range(12))}
        session = session or f"{commit[:3]}{factor}{key}"
        return record | {"key": record["key"] + key, "session": session, "conditions": None}

    def history(self, *records):
        return history_of(read_records([str(self.write("history.jsonl", records))]).cells)

    def moves(self, *records):
        """{key's end: commits that moved}"""
        found = self.history(*records)
        return {
            key[-1]: "".join(found.programs[point.program][0] for point in points if point.moved)
            for key, points in found.points.items()
        }

    def series(self, *factors, key="k"):
        return [self.record(commit, factor, key=key) for commit, factor in zip(NAMES, factors)]

    def test_moves_are_found_where_they_are(self):
        for factors, moved in (
            ((1, 1, 1.1, 1.1), "c"),
            ((1, 0.9, 0.9, 1), "bd"),
            ((1, 1, 1, 1), ""),
            ((1, 1.007, 1.014, 1.021), "c"),  # 1 % is the threshold; no step reaches it, but drift adds up
        ):
            self.assertEqual(self.moves(*self.series(*factors)), {"k": moved})
            self.assertEqual(self.moves(*reversed(self.series(*factors))), {"k": moved}, "order is by date")
        two = *self.series(1, 1, 1.1, 1, key="i"), *self.series(1, 1, 1, 1, key="j")
        self.assertEqual(self.moves(*two), {"i": "cd", "j": ""})

    def test_titles_name_the_last_moves(self):
        for factors, title in (
            ((1, 2, 2, 2), "takes .* since b{7}"),
            ((1, 2, 3, 4), "takes .* since b{7}, then .* since c{7}, then .* since d{7}"),
            (
                (1, 2, 3, 4, 5),
                "moved 4 times; it takes .* since c{7}, then .* since d{7}, then .* since e{7}",
            ),
        ):
            cells = read_records([str(self.write("titles.jsonl", self.series(*factors)))]).cells
            self.assertRegex(shown_history(cells)[0]["cells"][0]["title"], f"^tiled {title}$")

    def test_too_few_samples_show_neither_a_move_nor_that_there_is_none(self):
        few = [self.record(name, factor, key="k") for name, factor in zip(NAMES, (1, 1.6))]
        for times in (record["total_ns"] for record in few):
            times["samples"], times["rounds"] = times["samples"][:2], times["rounds"][:2]
        shown, [sentence] = shown_history(read_records([str(self.write("few.jsonl", few))]).cells)
        self.assertRegex(shown["cells"][0]["title"], "may have moved over 2 commits$")
        self.assertEqual(sentence, "Over 2 commits, none of 1 cells moved, and 1 may have.")

    def test_the_rule_is_that_of_compare(self):
        for factors in ((1, 1), (1, 1.02), (1, 1.2), (1.2, 1)):
            records = self.series(*factors)
            point = self.history(*records).points[records[0]["key"]][1]
            verdict = compare(*(self.write(f"{i}.jsonl", [one]) for i, one in enumerate(records))).cells.iloc[
                0
            ]
            self.assertEqual(
                (point.compared.verdict, point.compared.p, point.compared.ratio.value),
                (verdict["verdict"], verdict["p"], verdict["ratio"]),
            )

    def test_sessions_are_the_unit(self):
        """Sessions that differ by more than their rounds do: rounds alone would show a change."""

        def sessions(commit, factor):
            own = (factor * place for place in (1, 1.06, 0.95, 1.03))
            return [self.record(commit, one, f"{commit[0]}{i}", "k") for i, one in enumerate(own)]

        self.assertEqual(self.moves(*sessions(NAMES[0], 1), *sessions(NAMES[1], 1.02)), {"k": ""})
        [[_, point]] = self.history(*sessions(NAMES[0], 1), *sessions(NAMES[1], 1.5)).points.values()
        self.assertEqual((point.moved, point.cell.sessions), (True, 4))

    def test_one_commit_has_no_history(self):
        records = [self.record(NAMES[0], 1, session=str(i), key="k") for i in range(3)]
        self.assertIsNone(self.history(*records))
        self.assertEqual(
            shown_history(read_records([str(self.write("one.jsonl", records))]).cells), (None, [])
        )

    def test_the_chart(self):
        records = [*self.series(1, 1, 1, 1, key="i"), *self.series(1, 1, 1.25, 1.25, key="j")]
        self.opened(self.report(self.write("chart.jsonl", records)))
        self.assertRegex(
            self.text("#results .lead"),
            r"Over 4 commits, 1 of 2 cells moved\. pad=j takes 1\.2\d+ times as long \[1\.2\d*, 1\.2\d*\] since ccccccc\.",
        )
        self.assertRegex(self.text("#history h3"), "^pad=j takes 1.2")
        chart = "Chart.getChart(document.querySelector('#history canvas'))"
        self.assertEqual(self.browser.run(f"{chart}.data.labels"), [name[:7] for name in NAMES[:4]])
        moved, times = self.browser.run(f"{chart}.data.datasets.map(one => one.data)")
        self.assertEqual([one is not None for one in moved], [False, False, True, False])
        for time, factor in zip(times, (1, 1, 1.25, 1.25)):
            frames = records[0]["frames"]["last"] - records[0]["frames"]["first"] + 1
            self.assertAlmostEqual(time * frames, factor, delta=0.02)
        self.choose("history", "cell", "1")
        self.assertEqual(self.text("#history h3"), "pad=i did not move over 4 commits")
