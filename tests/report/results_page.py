# SPDX-License-Identifier: MIT
# test: cost=10
"""scripts/results-page on made-up submissions: right, wrong, not compared,
refused, hostile."""

import copy
import functools
import json
import re
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
        work = lambda record: (record["scene"]["digest"], record["settings"]["k"])
        found = [
            one
            for one in committed("cpu/walks.jsonl")
            if one["scene"].get("name") == "pile" and one["agreement"]
        ]
        self.base = [record for record in found if work(record) == work(found[0])][:3]
        self.file("results/cpu/walks.jsonl", self.base)
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
        texts = (record if isinstance(record, str) else json.dumps(record) for record in records)
        (self.results / "submitted" / name).write_text("".join(f"{text}\n" for text in texts))

    def changed(self, *path, **values):
        """A submission with other values of fields of the part at a path."""
        record = self.submission()
        part = functools.reduce(dict.get, path, record)
        part.update(values)
        return record

    def test_a_right_answer_is_ranked_with_its_conditions(self):
        rows, errors, _ = self.page(0, "3 records, 0 submitted")
        self.assertEqual([row[0] for row in rows if row], ["1", "2", "3"])
        record = self.submission()
        moment = {"gpus": [], "processor": {"mhz": 2345, "other_cores": 0.5}}
        self.assertLessEqual(
            moment["processor"].keys(), set(re.findall(r"\w+", json.dumps(condition_schema())))
        )
        self.submitted("anna.jsonl", record)
        rows, errors, text = self.page(0, "4 records, 1 submitted (0 wrong, 0 not compared), 0 lines refused")
        self.assertEqual(errors, [])
        (own,) = [row for row in rows if row and row[-1] == "anna.jsonl:1, submitted"]
        self.assertTrue(own[0].isdigit())
        self.assertIn(own[7], COMMIT[:12])
        self.assertIn("1,647,388", own[4])
        disturbed = [{"round": 0, "why": "other work"}]
        record["conditions"] = {"disturbed": disturbed, "before": moment, "after": moment}
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
        digest = self.base[0]["work"]["digest"]
        both = self.changed("work", digest=digest | {"a": "00000000000000aa"})
        both["agreement"]["digest"] = both["work"]["digest"]
        one = self.changed("work", digest=digest | {"b": "00000000000000bb"})
        for record in (both, one, self.changed(status="wrong")):
            self.submitted("bert.jsonl", record)
            rows, errors, text = self.page(1, "1 submitted (1 wrong, ")
            self.assertEqual(len(errors), 1)
            self.assertIn("bert.jsonl:1: its answer is wrong; it is shown and not ranked", errors[0])
            (own,) = [row for row in rows if row and row[-1] == "bert.jsonl:1, submitted"]
            self.assertEqual((own[0], own[3]), ("wrong", ""))
            self.assertEqual(sum(row[0].isdigit() for row in rows if row), 3)
            self.assertIn("is wrong: its answer is not the reference", text)

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
        nan = json.dumps(self.submission()).replace('"median": ', '"median": NaN, "unused": ', 1)
        for line, reason in (
            (self.changed(algorithm=3), "does not match results/record.schema.json (/algorithm: "),
            (self.changed(rank=1), "does not match results/record.schema.json (/: "),
            (self.changed(frames=None), "does not match results/record.schema.json (/frames: "),
            (self.submission(commit="fedcba987654"), "commit fedcba987654 is not in the history"),
            (self.submission(commit=None), "commit unknown is not in"),
            (self.submission(commit="0"), "commit 0 is not in the history"),
            (self.submission(dirty=True), "built with changes that no commit has"),
            (self.changed("agreement", missing=1), "/agreement/missing: "),
            (nan, "is not JSON"),
            (nan.replace("NaN", "1e999"), "is not JSON"),
            ("[]", "does not match"),
            ("{}", "does not match"),
            ("hello", "is not JSON"),
        ):
            self.submitted("frank.jsonl", line, self.submission())
            counts = "4 records, 1 submitted (0 wrong, 0 not compared), 1 lines refused"
            rows, [error], text = self.page(1, counts)
            self.assertIn("frank.jsonl:1: ", error)
            self.assertIn(reason, error)
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
        self.assertGreater(len(gathered.sources), 250)
        self.assertEqual([source.place for source in gathered.sources if source.cell.status != "ok"], [])


def condition_schema():
    return json.loads((SOURCE / "results/record.schema.json").read_text())["definitions"]["condition"]
