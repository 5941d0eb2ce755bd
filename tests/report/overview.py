# SPDX-License-Identifier: MIT
# test: cost=4
"""The first screen of `tandem report`: a row for each comparison and a mark for each method, then whether all is right, the
conditions, and the table of times, which needs no script."""

from tests.program import cells_of
from tests.report.case import RECORDS, ReportCase, Shown
from tests.report.sentences import NEARLY_ONE_MS, ONE_MS, THREE_MS, TWO_MS, cell_of

from tandem.cell import Answer
from tandem.pages.markup import markup
from tandem.report import overview
from tandem.report.answers import answers
from tandem.report.conditions import conditions
from tandem.report.groups import groups_of

CHART = "Chart.getChart(document.querySelector('#overview canvas'))"
RIGHT = {"agreement": {"missing": 0, "extra": 0, "contact_frames_wrong": 0}}


def of_methods(*times, **changes):
    """Cells of the four methods on GPUs, with these times of their rounds."""
    known = (
        ("tiled", "resident"),
        ("chunked", "grouped"),
        ("gproximity", "fair"),
        ("leaf_query", "resident"),
    )
    return [cell_of(method, own, preset=preset, **changes) for (method, preset), own in zip(known, times)]


def rows_of(cells):
    groups = groups_of(cells)
    return groups, overview.rows_of(groups, cells)


class Overview(ReportCase):
    def test_rows_are_sorted_by_time(self):
        """Those that compare something come first."""
        other = {"scene": {"key": "plates", "name": "plates", "digest": "2", "bodies": 3, "tetrahedra": 6}}
        cells = [
            *of_methods(TWO_MS, THREE_MS),
            *of_methods(ONE_MS, TWO_MS, **other),
            cell_of("tiled", [0.1], "8"),
        ]
        _, rows = rows_of(cells)
        self.assertEqual(
            [row.group.row for row in rows], ["plates", *(f"3 jacks, density 0.2, k = {k}" for k in (18, 8))]
        )
        chart = overview.charted(rows, overview.methods_of(rows), "t")
        self.assertEqual(chart["methods"], ["tiled", "grouped schedule"])
        self.assertEqual([row["marks"] for row in chart["rows"]], [[2, 3], [0, 1], [4, None]])
        self.assertEqual([row["key"] for row in chart["rows"]], ["plates", "pile:bodies=3", "pile:bodies=3"])

    def test_a_method_has_the_mark_of_its_fastest_cell(self):
        cells = [
            cell_of("tiled", own, preset="resident", key=f"{i}") for i, own in enumerate((TWO_MS, ONE_MS))
        ]
        _, [row] = rows_of([*cells, *of_methods([], THREE_MS)[1:]])
        self.assertEqual((row.marks, row.leaders), ({"tiled": 1, "grouped schedule": 2}, ["tiled"]))

    def test_wrong_answers_are_marked_and_do_not_lead(self):
        good, wrong = of_methods(TWO_MS)[0], of_methods([], ONE_MS, status="wrong")[1]
        _, [row] = rows_of([good, wrong])
        self.assertEqual(
            (row.marks, row.wrong, row.leaders), ({"tiled": 0}, {"grouped schedule": 1}, ["tiled"])
        )
        _, [row] = rows_of([wrong])
        self.assertEqual((row.marks, row.wrong, row.leaders), ({}, {"grouped schedule": 0}, []))

    def test_the_table_of_times(self):
        cells = [
            *of_methods(ONE_MS, NEARLY_ONE_MS, THREE_MS),
            *of_methods(*[[]] * 3, TWO_MS, status="wrong")[3:],
        ]
        _, rows = rows_of(cells)
        text = markup(overview.times(rows, overview.methods_of(rows), cells))
        self.assertEqual(Shown(text).rows[1:], [["3 jacks, density 0.2", "1", "1", "3", "wrong"]])
        self.assertEqual(text.count("<strong>"), 2, "those that cannot be told apart")
        self.assertIn('<span title="pile:bodies=3">', text)

    def opened_with(self, *records):
        self.opened(self.report(self.write("some.jsonl", records)))

    def drawn(self, script):
        return self.browser.run(f"(() => {{ const chart = {CHART}; return {script}; }})()")

    def test_the_chart(self):
        """All methods are in the place of their times on a logarithmic axis; the fastest has a name, and a wrong one a cross."""
        records = cells_of((RECORDS / "plan.jsonl").read_text())
        wrong = next(record for record in records if record["algorithm"] == "leaf_query")
        wrong["status"] = "wrong"
        self.opened_with(*records)
        self.assertRegex(
            self.text("#overview h3"),
            r"^tiled is fastest in all 10 comparisons, 1\.\d+ to 2\.\d+ times as fast as the next method$",
        )
        self.assertEqual(self.drawn("chart.scales.x.type"), "logarithmic")
        labels = self.drawn("chart.data.labels.map(lines => lines.join(' '))")
        self.assertEqual(labels[-2:], ["2,000 jacks, density 0.2, k = 18", "2,000 jacks, density 0.2, k = 8"])
        methods = ["tiled", "grouped schedule", "paper's schedule", "gProximity", "leaf queries"]
        self.assertEqual(self.drawn("chart.data.datasets.map(one => one.label)"), methods)
        self.assertEqual(len(self.drawn("chart.namesDrawn")), 10)
        self.assertEqual({name.split()[0] for name in self.drawn("chart.namesDrawn")}, {"tiled"})
        crossed = self.drawn("chart.data.datasets.map(one => one.crossed.filter(is => is).length)")
        self.assertEqual(crossed, [0, 0, 0, 0, 1])
        [[x, y]] = self.drawn(
            "chart.getDatasetMeta(4).data.filter((_, i) => chart.data.datasets[4].crossed[i]).map(({x, y}) => [x, y])"
        )
        self.assertEqual(self.colour(x + 8, y + 8), self.browser.run("tandem.ofStyle('--bad')"))
        self.assertEqual(self.text("#overview .bad"), "A cross marks a wrong answer.")
        top = self.browser.run("document.getElementById('overview').getBoundingClientRect().bottom")
        self.assertLess(top, 900, "the first screen")

    def colour(self, x, y):
        """The colour of the chart there, as "#rrggbb"."""
        script = f"[...chart.ctx.getImageData({x} * chart.currentDevicePixelRatio, {y} * chart.currentDevicePixelRatio, 1, 1).data].slice(0, 3)"
        return "#" + "".join(f"{part:02x}" for part in self.drawn(script))


class Answers(ReportCase):
    def part(self, *cells):
        section = answers(groups_of(cells), cells)
        return section.title, Shown(markup(section.content)).words

    def test_all_right(self):
        equal = "right: no pair is missing or extra, and contacts are equal to the reference's bit for bit."
        cells = of_methods(ONE_MS, TWO_MS, **RIGHT)
        self.assertEqual(self.part(*cells), ("All right", f"All 2 cells are {equal}"))
        self.assertEqual(self.part(cells[0]), ("All right", f"The cell is {equal}"))
        unchecked = of_methods([], [], THREE_MS)[2]
        self.assertEqual(
            self.part(*cells, unchecked),
            ("Answers", f"2 cells of 3 are {equal}1 cell ran without a check of the answer."),
        )

    def test_what_is_not_right(self):
        cells = [
            *of_methods(ONE_MS, TWO_MS, **RIGHT),
            *of_methods([], [], THREE_MS, status="wrong")[2:],
            *of_methods(*[[]] * 4, status="failed", failure="no memory")[3:],
        ]
        title, words = self.part(*cells)
        self.assertEqual(title, "Not all right")
        self.assertIn("2 cells of 4 are right: ", words)
        self.assertIn("3 jacks, density 0.2: gProximity is wrong: its answer is not the reference's.", words)
        cells[2].record["agreement"] = {"missing": 3, "extra": 0, "contact_frames_wrong": 1}
        self.assertIn(
            "gProximity is wrong: 3 pairs missing, contacts differ in 1 of its frames.", self.part(*cells)[1]
        )
        self.assertIn("3 jacks, density 0.2: leaf queries failed: no memory.", words)
        differ = [cell_of(name, ONE_MS, pairs=Answer(i, "1", "2")) for i, name in enumerate("ab", 1)]
        self.assertIn(
            "3 jacks, density 0.2: the cells found different sets of candidate pairs", self.part(*differ)[1]
        )

    def test_conditions_of_each_device(self):
        busy = {
            "before": {"gpus": [{"sm_mhz": 1980}], "processor": {}},
            "after": {"gpus": [{"sm_mhz": 1755}], "processor": {}},
        }
        busy["disturbed"] = [{"round": 0, "why": "busy: other processes"}]
        cells = [
            *of_methods(ONE_MS, TWO_MS[:4], conditions=busy),
            *of_methods(
                ONE_MS,
                sampling={"converged": False},
                environment={"commit": "2", "dirty": True, "date": "2026-01-02T03"},
            ),
        ]
        section = conditions(cells, ["A caution."])
        _, first, second = Shown(markup(section.content)).rows
        self.assertEqual(
            first,
            [
                "GPU (cuda:0)",
                "1",
                "1",
                "2026",
                "2",
                "4 to 10",
                "GPU at 1755 to 1980 MHz",
                "2 of 14 rounds disturbed (busy: other processes)",
            ],
        )
        self.assertEqual(
            second,
            [
                "GPU (cuda:0)",
                "1",
                "2, with changes",
                "2026-01-02",
                "1",
                "10",
                "not recorded",
                "1 cell with an interval wider than requested",
            ],
        )
        self.assertIn("A caution.", section.content[0][0])
