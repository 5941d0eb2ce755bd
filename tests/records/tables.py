# SPDX-License-Identifier: MIT
# test: cost=20
"""What tables (tandem.tables) and figures of errors (tandem.error_figures)
show of cells of every status."""

import csv
import json
import os

from tests.program import SOURCE
from tests.script_case import ScriptCase, committed, rows_of


def cells_of_plates(name):
    """The cells of plates with k = 8 in a committed file."""
    cells = [record for record in committed(f"h200/{name}.jsonl") if record.get("kind") != "verdict"]
    return [one for one in cells if one["scene"]["name"] == "plates" and one["settings"]["k"] == "8"]


class Tables(ScriptCase):
    def counted(self, header, rows):
        """(launches, launches as in the paper) by the name of a cell."""
        columns = header.index("launches"), header.index("as theirs")
        cells = [row for row in rows if len(row) == len(header) and "±" in "".join(row)]
        return {row[0]: tuple(row[column] for column in columns) for row in cells}

    def test_launches_are_counted_as_in_the_paper_too(self):
        """A frame of plates has three launches in the paper's Table 5: 306 in 102 frames. Ours are 92 of them."""
        records = [
            one for one in cells_of_plates("paper/records/cells-plates") if one["frames"]["first"] == 30
        ]
        header, *rows = rows_of(self.table(*records))
        ratio = next(row for row in rows if row[0] == "gProximity published / chunked published")
        of = self.counted(header, rows)
        paper = {
            (row["scene"], row["algorithm"]): int(row["launches"])
            for row in csv.DictReader((SOURCE / "results/paper/table5.csv").read_text().splitlines())
            if row["gpu"] == "K20c"
        }
        (chunked,) = (value for name, value in of.items() if name.startswith("chunked published"))
        self.assertEqual(chunked, ("4", str(round(paper["plates", "chunked"] / 102))))
        published = next(
            record
            for record in records
            if (record["algorithm"], record["preset"]) == ("gproximity", "published")
        )
        times = {kernel: value["launches"] for kernel, value in published["kernel_times"].items()}
        self.assertEqual(times["plan_balance"], times["traverse_queues"])
        (gproximity,) = (value for name, value in of.items() if name.startswith("gProximity published"))
        self.assertEqual(gproximity[1], f"{2 + 2 * times['traverse_queues'] / 92:.0f}")
        ours = sum(stage["launches"] for stage in published["stages"].values())
        self.assertEqual(
            ratio[-2:], [f"{ours / (4 * 92):.1f}", f"{(2 + 2 * times['traverse_queues'] / 92) / 3:.1f}"]
        )
        header, *rows = rows_of(self.table(*cells_of_plates("plan")))
        of = self.counted(header, rows)
        self.assertEqual({theirs for name, (_, theirs) in of.items() if name.startswith("tiled")}, {"-"})
        bare = [{**record, "kernel_times": {}} for record in records]
        self.assertNotIn("as theirs", self.table(*bare), "nothing is known of their kernels")

    def test_cells_that_failed_or_are_wrong_are_shown_and_never_ranked(self):
        plates = {
            record["algorithm"] + record["preset"]: {
                **record,
                "sampling": {**record["sampling"], "converged": True},
            }
            for record in cells_of_plates("plan")
        }
        first, second, third = (plates[name] for name in ("chunkedgrouped", "chunkedpaper", "gproximityfair"))
        fastest = {**first, "status": "wrong", "agreement": {**first["agreement"], "missing": 7, "extra": 0}}
        lost = {
            **second,
            "status": "failed",
            "failure": "the device | was\nlost",
            "total_ns": None,
            "breakdown_ns": None,
            "stages": {},
            "work": None,
            "agreement": None,
            "conditions": None,
        }
        rows = rows_of(self.table(fastest, lost, third))
        self.assertEqual(
            [row[-1] for row in rows[:4]],
            ["notes", "WRONG: 7 missing", "failed: the device \\| was lost", ""],
        )
        self.assertEqual([cell for row in rows for cell in row if "**" in cell], [])
        self.assertEqual(len(rows), 4)  # no ratios
        rows = rows_of(self.table(third, lost, first))
        self.assertEqual(["**" in row[-2] for row in rows[:4]], [False, False, False, True])
        self.assertEqual(rows[4][0], "gProximity / chunked")

    def test_labels_name_the_differences(self):
        def cell(device=0, commit=None, asked=None, **settings):
            record = json.loads(json.dumps(committed("h200/paper/records/resident-plates.jsonl")[0]))
            record["settings"].update(settings)
            record["asked"] = asked or {}
            record["devices"] = [
                {**record["devices"][0], "id": f"cuda:{d}", "hardware": f"{d}" * 16}
                for d in ([device] if isinstance(device, int) else device)
            ]
            record["environment"]["commit"] = commit or record["environment"]["commit"]
            return record

        name_of = lambda *records: [
            tuple(row[:2]) for row in rows_of(self.table(*records))[1 : len(records) + 1]
        ]
        plain = name_of(cell())[0]
        self.assertEqual(plain[1], "cuda:0")
        self.assertEqual(
            name_of(cell(threads="1"), cell(threads="4")),
            [(f"{plain[0]} threads=1", "cuda:0"), (f"{plain[0]} threads=4", "cuda:0")],
        )
        self.assertEqual(name_of(cell(), cell((0, 1))), [plain, (plain[0], "cuda:0+cuda:1")])
        # An adjusted group size does not make a different cell.
        self.assertEqual(
            name_of(cell(0, group_size="64"), cell(1, asked={"group_size": "64"}, group_size="1")),
            [plain, (plain[0], "cuda:1")],
        )
        self.assertEqual(
            [name for name, _ in name_of(cell(), cell(commit="a" * 40), cell(commit="a" * 40))],
            [
                f"{plain[0]} @{cell()['environment']['commit'][:7]}",
                f"{plain[0]} @aaaaaaa",
                f"{plain[0]} @aaaaaaa (2)",
            ],
        )
        other = cell()
        other["devices"][0].update(name="Another", hardware="f" * 16)
        self.assertEqual(
            [device for _, device in name_of(cell(), other)], ["cuda:0 NVIDIA H200", "cuda:0 Another"]
        )
        self.assertEqual(self.table(cell(rounding="safe"), cell(rounding="published")).count("\n### "), 2)
        chosen = committed("../tests/records/chosen.jsonl")[0]
        self.assertIn(f"chosen by auto of {chosen['chosen']['of']}", self.table(chosen))


class Figures(ScriptCase):
    def test_figures_report_missing_data(self):
        records = [
            record
            for record in committed("../tests/records/accuracy.jsonl")
            if record["settings"]["contact_rule"] == "opposing"
        ][:3]
        truth = {**records[0]["error"]["truth"], "contacts": None}
        bare = [{**record, "error": {**record["error"], "truth": truth}} for record in records]
        counts = "touching overlapping missed_touching missed_overlapping candidates false".split()
        nothing = {**truth, **dict.fromkeys(counts, 0), "candidate_ratio": None}
        met = [{**record, "error": {**record["error"], "truth": nothing}} for record in records]
        hard = [
            {**record, "scene": {**record["scene"], "name": "hard", "key": f"hard:touch:difficulty={i}"}}
            for i, record in enumerate(met)
        ]
        swept = [
            {
                **record,
                "settings": {
                    **record["settings"],
                    "group_size": str(32 << i),
                    "placement": "exact" if i else "rounded",
                },
            }
            for i, record in enumerate(bare)
        ]
        many = [{**bare[0], "settings": {**bare[0]["settings"], "group_size": str(i)}} for i in range(205)]
        folder, drawn = self.work / "lacking", set()
        for name, cells, figure, expected in (
            ("bare", bare, "pareto", "nothing to draw: no cell was asked for this"),
            ("one", bare[:1], "pareto", "one cell"),
            ("met", met, "bars", "nothing to draw: no pairs meet"),
            ("hard", hard, "cliffs", "nothing to draw: no pairs meet"),
            ("swept", swept, "bars", "group_size=64"),
            ("swept", swept, "pareto", "placement exact, rounded"),
            ("many", many, "bars", "the first 200 of 205 configurations"),
            ("many", many, "pareto", "(205 values)"),
        ):
            with self.subTest(name):
                if name not in drawn:
                    drawn.add(name)
                    self.output_of("figures", self.file(f"{name}.jsonl", cells), folder)
                self.assertIn(expected, (folder / f"{figure}.svg").read_text())
        self.assertIn("group_size", (folder / "pareto.csv").read_text().splitlines()[0].split(","))
        wrong = {**records[1], "status": "wrong"}
        self.assertIn(
            "1 records drawn",
            text := self.output_of("figures", self.file("wrong.jsonl", [records[0], wrong]), folder),
        )
        self.assertIn("1 failed, wrong or untimed left out", text)
        self.refused("figures", "the last argument", self.file("a.jsonl", records), self.work / "a.jsonl")
        if os.geteuid() != 0:
            folder.chmod(0o500)
            self.refused("figures", "cannot write", self.work / "a.jsonl", folder, code=3)

    def test_pareto_names_the_cells_that_none_beats(self):
        """Four synthetic cells: fast and coarse, slow and exact, one beaten by both, and the best of all, which
        misses pairs."""
        record = next(
            record
            for record in committed("../tests/records/accuracy.jsonl")
            if record["error"]["truth"]["contacts"]
        )

        def cell(k, ms, ratio, missed=0):
            frames = record["frames"]["last"] - record["frames"]["first"] + 1
            ns = {
                **record["total_ns"],
                "median": ms * 1e6 * frames,
                "low": 0.99 * ms * 1e6 * frames,
                "high": 1.01 * ms * 1e6 * frames,
            }
            truth = {**record["error"]["truth"], "candidate_ratio": ratio, "missed_touching": missed}
            return {
                **record,
                "settings": {**record["settings"], "k": str(k)},
                "total_ns": ns,
                "error": {**record["error"], "truth": truth},
            }

        cells = [
            cell(8, 1, 4),
            cell(26, 2, 1.6),
            cell(14, 3, 3),
            cell(6, 0.5, 1.5, missed=1),
            cell(18, 2.01, 1.6),
        ]
        folder = self.work / "named"
        self.output_of("figures", self.file("named.jsonl", cells), folder)
        text = (folder / "pareto.svg").read_text()
        for expected in (
            "k=8: the fastest; k=26: 2.50 times fewer candidates for 2.00 times the time",
            "<!-- k=8 -->",
            "<!-- k=26 (and 1 alike) -->",
        ):
            self.assertIn(expected, text)
        for beaten in (14, 6, 18):
            self.assertNotIn(f"<!-- k={beaten}", text)
        self.output_of("figures", self.file("named.jsonl", [cell(8, 1, 4), cell(18, 2, 4)]), folder)
        self.assertIn("k=8: the fastest, and nothing is better", (folder / "pareto.svg").read_text())
