# SPDX-License-Identifier: MIT
# test: cost=10
"""scripts/results-page on made-up submissions: right, wrong, not compared,
refused, hostile."""

import copy
import json
import shutil

from tests.program import SOURCE
from tests.report.case import Shown
from tests.script_case import ScriptCase, called, committed, loaded

COMMIT = "0123456789abcdef0123456789abcdef01234567"
page_script = loaded("results-page")  # adds the folders of its modules
from gallery import records as gallery_records
from tandem.errors import BadUse


class ResultsPage(ScriptCase):
    def setUp(self):
        super().setUp()
        self.results = self.work / "results"
        shutil.rmtree(self.results, ignore_errors=True)
        (self.results / "cpu").mkdir(parents=True)
        (self.results / "submitted").mkdir()
        found = [
            record
            for record in committed("cpu/walks.jsonl")
            if record["scene"]["name"] == "pile" and record["agreement"]
        ]
        first = found[0]
        self.base = [
            record
            for record in found
            if record["scene"]["digest"] == first["scene"]["digest"]
            and record["settings"]["k"] == first["settings"]["k"]
        ][:3]
        (self.results / "cpu/walks.jsonl").write_text(
            "".join(json.dumps(record) + "\n" for record in self.base)
        )
        former = page_script.history
        page_script.history = lambda root: {COMMIT}
        self.addCleanup(setattr, page_script, "history", former)

    def submission(self, **environment):
        """A record as somebody with another machine may submit it: three times as fast as the committed one."""
        record = copy.deepcopy(self.base[0])
        record["environment"] |= {"commit": COMMIT[:12], "dirty": False} | environment
        record["session"] = "feedbeef01234567"
        for name in ("samples", "median", "low", "high", "q1", "q3"):
            value = record["total_ns"][name]
            record["total_ns"][name] = [ns // 3 for ns in value] if isinstance(value, list) else value / 3
        return record

    def page(self, code, text, *files):
        out = self.work / "page.html"
        status, output, errors = called(page_script, *files, "--results", self.results, "-o", out)
        self.assertEqual((status, output.count("\n")), (code, 1), (output, errors))
        self.assertIn(text, output)
        shown = Shown(out.read_text())
        self.assertLessEqual(shown.tags & {"script", "img", "iframe", "b"}, set())
        return shown.rows, errors, out.read_text()

    def submitted(self, name, *records):
        text = "".join(
            (record if isinstance(record, str) else json.dumps(record)) + "\n" for record in records
        )
        (self.results / "submitted" / name).write_text(text)

    def test_a_right_answer_is_ranked_with_its_conditions(self):
        rows, errors, _ = self.page(0, "3 records, 0 submitted")
        self.assertEqual([row[0] for row in rows if row], ["1", "2", "3"])
        record = self.submission()
        moment = {"gpus": [], "processor": {"mhz": 2345, "other_cores": 0.5}}
        self.assertLessEqual(
            moment["processor"].keys(), set(json.dumps(gallery_schema()).replace('"', " ").split())
        )
        self.submitted("anna.jsonl", record)
        rows, errors, text = self.page(0, "4 records, 1 submitted (0 wrong, 0 not compared), 0 lines refused")
        self.assertEqual(errors, [])
        (own,) = [row for row in rows if row and row[-1] == "anna.jsonl:1, submitted"]
        self.assertTrue(own[0].isdigit())
        self.assertIn(own[7], COMMIT[:12])
        self.assertIn("1,647,388", own[4])
        record["conditions"] = {
            "disturbed": [{"round": 0, "why": "other work"}],
            "before": moment,
            "after": moment,
        }
        self.assertIn(
            "processor at 2345 MHz, cores used by other processes: 0.5, 1 doubtful round, the first: other work",
            self.shown(record)[5],
        )

    def shown(self, record):
        """The row of a record whose conditions need not match the schema."""
        gathered = gallery_records.Gathered()
        gallery_records.add_file(gathered, self.file("conditions.jsonl", [record]), "conditions.jsonl")
        from gallery.page import page_of

        return next(row for row in Shown(page_of(gathered.sources, set(), [])).rows if row)

    def test_wrong_answers_are_shown_and_never_ranked(self):
        for change in (
            lambda record: [
                part.update(digest={**part["digest"], "a": "00000000000000aa"})
                for part in (record["work"], record["agreement"])
            ],
            lambda record: record["work"].update(
                digest={**record["work"]["digest"], "b": "00000000000000bb"}
            ),
            lambda record: record.update(status="wrong"),
        ):
            record = self.submission()
            change(record)
            self.submitted("bert.jsonl", record)
            rows, errors, text = self.page(1, "1 submitted (1 wrong, ")
            self.assertEqual(len(errors), 1)
            self.assertIn("bert.jsonl:1: its answer is wrong; it is shown and not ranked", errors[0])
            (own,) = [row for row in rows if row and row[-1] == "bert.jsonl:1, submitted"]
            self.assertEqual((own[0], own[3]), ("wrong", ""))
            self.assertEqual(sum(row[0].isdigit() for row in rows if row), 3)
            self.assertIn("was wrong, and is not ranked", text)

    def test_answers_that_nothing_checks_are_shown_apart(self):
        record = self.submission()
        record["agreement"] = None
        self.submitted("carl.jsonl", record)
        self.page(0, "1 submitted (0 wrong, 0 not compared)")  # its digest is that of a compared record
        record["scene"]["digest"] = "00000000000000cc"
        self.submitted("carl.jsonl", record)
        rows, _, _ = self.page(0, "1 submitted (0 wrong, 1 not compared)")
        self.assertEqual([row[0] for row in rows if row and "carl" in row[-1]], ["not compared"])

    def test_submissions_that_contradict_each_other_are_wrong(self):
        first = self.submission()
        first["scene"]["digest"] = "00000000000000dd"
        second = copy.deepcopy(first)
        for part in (second["work"], second["agreement"]):
            part["digest"]["a"] = "00000000000000ee"
        self.submitted("dora.jsonl", first)
        self.page(0, "1 submitted (0 wrong, 0 not compared)")
        self.submitted("emil.jsonl", second)
        self.page(1, "2 submitted (2 wrong, 0 not compared)")

    def test_refused_lines(self):
        def changed(change):
            record = self.submission()
            change(record)
            return record

        nan = json.dumps(self.submission()).replace('"median": ', '"median": NaN, "unused": ', 1)
        for line, reason in (
            (
                changed(lambda record: record.update(algorithm=3)),
                "does not match results/record.schema.json (/algorithm: ",
            ),
            (changed(lambda record: record.update(rank=1)), "does not match results/record.schema.json (/: "),
            (changed(lambda record: record.pop("frames")), "does not match results/record.schema.json"),
            (self.submission(commit="fedcba987654"), "commit fedcba987654 is not in the history"),
            (self.submission(commit=None), "commit unknown is not in"),
            (self.submission(commit="0"), "commit 0 is not in the history"),
            (self.submission(dirty=True), "built with changes that no commit has"),
            (changed(lambda record: record["agreement"].update(missing=1)), "/agreement/missing: "),
            (nan, "is not JSON"),
            (nan.replace("NaN", "1e999"), "is not JSON"),
            ("[]", "does not match"),
            ("{}", "does not match"),
            ("hello", "is not JSON"),
        ):
            with self.subTest(reason):
                self.submitted("frank.jsonl", line, self.submission())
                rows, errors, text = self.page(
                    1, "4 records, 1 submitted (0 wrong, 0 not compared), 1 lines refused"
                )
                self.assertEqual(len(errors), 1)
                self.assertIn("frank.jsonl:1: ", errors[0])
                self.assertIn(reason, errors[0])
                self.assertIn("Refused lines</h2>", text)
        (self.results / "submitted/frank.jsonl").unlink()
        self.assertIn("cannot be read", self.page(1, "1 lines refused", self.work / "absent.jsonl")[1][0])

    def test_texts_of_records_are_no_html(self):
        record = self.submission()
        record["preset"] = "<b>x</b><script>alert(1)</script>\x1b[2J\n"
        self.submitted("<img src=x>.jsonl", record)
        rows, _, text = self.page(0, "1 submitted")
        (own,) = [row for row in rows if row and "submitted" in row[-1]]
        self.assertEqual((own[0].isdigit(), own[-1]), (True, "<img src=x>.jsonl:1, submitted"))
        self.assertIn("<script>alert(1)</script>\\x1b[2J", own[1])
        self.assertNotIn("\x1b", text)

    def test_a_copy_counts_once(self):
        for name in ("gina.jsonl", "hans.jsonl"):
            self.submitted(name, self.submission())
        self.page(0, "4 records, 1 submitted")

    def test_errors_of_the_project_are_errors(self):
        (self.results / "cpu/walks.jsonl").write_text("no record\n")
        status, output, errors = called(page_script, "--results", self.results, "-o", self.work / "none.html")
        self.assertEqual((status, output, len(errors)), (2, "", 1))
        self.assertIn("walks.jsonl:1: is not JSON", errors[0])
        self.assertFalse((self.work / "none.html").exists())
        with self.assertRaisesRegex(BadUse, "use a checkout with its history"):
            gallery_records.history(self.work)

    def test_committed_records_agree(self):
        """Equal work has equal digests in all committed files, over devices and commits."""
        gathered = page_script.gathered_from(SOURCE / "results", [], {COMMIT})
        page_script.judge(gathered.sources)
        self.assertGreater(len(gathered.sources), 400)
        self.assertEqual([source.place for source in gathered.sources if source.cell.status != "ok"], [])


def gallery_schema():
    return json.loads((SOURCE / "results/record.schema.json").read_text())["definitions"]["condition"]
