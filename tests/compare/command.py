# SPDX-License-Identifier: MIT
# test: cost=5
"""The command `tandem compare`, on records derived from a committed one."""

import copy
import json
import subprocess

from tests.program import PROGRAM, SOURCE, Case, tandem

LINE = json.loads((SOURCE / "results/h200/paper/records/resident-plates.jsonl").read_text().splitlines()[3])
del LINE["session"]


def record(factor=1.0, samples=9, k="8", commit="aaaa11112222", session=None):
    """The committed record with samples around 10 ms times `factor`, 0.1 % apart; with a session it has
    schema 3."""
    made = copy.deepcopy(LINE)
    made["key"] = made["key"].replace(",k=8,", f",k={k},")
    made["settings"]["k"] = k
    made["total_ns"] = {
        "samples": [round(1e7 * factor * (1 + 0.001 * (i * 7 % 11))) for i in range(samples)],
        "frames": [],
    }
    made["environment"]["commit"] = commit
    made["schema"] = 2
    if session:
        made.update(schema=4, session=session, sampling={"seed": 1})
        made["total_ns"]["rounds"] = list(range(samples))
    return made


class Compare(Case):
    def write(self, *records, end="\n"):
        path = self.work / f"{len(list(self.work.iterdir()))}.jsonl"
        path.write_text("\n".join(json.dumps(r) for r in records) + end)
        return path

    def compared(self, old, new, *arguments, code=0):
        status, out, errors = tandem("compare", old, new, *arguments)
        self.assertEqual((status, errors), (code, []), out)
        return out

    def json_of(self, old, new, *arguments, code=0):
        return json.loads(self.compared(old, new, "--format", "json", *arguments, code=code))

    def test_equal(self):
        old, new = self.write(record(), record(k="18")), self.write(record(), record(k="18"))
        out = self.compared(old, new)
        self.assertIn("0 of 2 cells slower, 0 faster beyond 1 % at level 0.05; detectable: 0.", out)
        for label in ("k=8 ", "k=18 "):
            row = next(line for line in out.splitlines() if line.startswith(label))
            self.assertEqual(row.split()[-3:][0], "≈")
        self.assertIn("all  grouped schedule, cuda:0, NVIDIA H200", out)
        self.assertLessEqual(max(map(len, out.splitlines())), 100)

    def test_slower_and_faster(self):
        old, new = self.write(record(), record(k="18")), self.write(record(1.05), record(k="18"))
        for a, b, word, count in (
            (old, new, "slower", "1 of 2 cells slower, 0 faster"),
            (new, old, "faster", "0 of 2 cells slower, 1 faster"),
        ):
            out = self.compared(a, b, code=1)
            self.assertIn(count, out.splitlines()[-1])
            self.assertIn(f" {word} ", next(line for line in out.splitlines() if line.startswith("k=8 ")))
        out = self.compared(old, new, "--threshold", 10)
        self.assertIn("within the threshold", out)
        self.assertIn("beyond 10 % at level 0.05; 1 changed within the threshold", " ".join(out.split()))
        # The smallest p-value of 9 against 9, 2 / 48,620, exceeds 1e-5.
        self.assertIn("too few samples to tell", self.compared(old, new, "--level", 1e-5))
        cell = self.json_of(old, new, code=1)["cells"][0]
        self.assertAlmostEqual(cell["times"]["ratio"], 1.05, places=6)
        self.assertAlmostEqual(cell["times"]["p"], 2 / 48620)
        self.assertAlmostEqual(cell["times"]["p_holm"], 4 / 48620)
        self.assertLess(cell["times"]["low"], 1.05)
        self.assertGreater(cell["times"]["high"], 1.05)

    def test_one_session_is_paired(self):
        for session, paired in (("s", True), ("t", False)):
            old, new = self.write(record(session="s")), self.write(record(1.02, session=session))
            cell = self.json_of(old, new, code=1)["cells"][0]
            self.assertEqual((cell["paired"], cell["common_rounds"]), (paired, 9 if paired else None))
            self.assertAlmostEqual(cell["times"]["p"], 2 / 2**9 if paired else 2 / 48620)
            self.assertEqual(
                "1 of 1 cells were measured in separate runs" in self.compared(old, new, code=1), not paired
            )
            self.assertEqual(
                (cell["old"]["session"], cell["new"]["session"], cell["old"]["seed"]), ("s", session, 1)
            )

    def test_another_answer(self):
        other = record(2)
        other["work"]["digest"] = {"count": 7, "a": "00", "b": "00"}
        old = self.write(record())
        out = self.compared(old, self.write(other), code=1)
        self.assertIn("another answer: grouped schedule: 7 candidate pairs instead of 6883390", out)
        self.assertNotIn("20.0", out)
        cell = self.json_of(old, self.write(other), code=1)["cells"][0]
        self.assertEqual((cell["verdict"], cell["times"]), ("another_answer", None))

    def test_times_are_per_frame(self):
        old, new = self.write(record()), self.write(record())
        self.assertEqual(record()["frames"], {"first": 20, "last": 121})
        out = self.compared(old, new)
        self.assertIn("ms   milliseconds per frame", out)
        self.assertEqual(
            next(line for line in out.splitlines() if line.startswith("grouped schedule ")).split()[2],
            "0.09853",
        )  # 10.05 ms / 102 frames
        cell = self.json_of(old, new)["cells"][0]
        self.assertEqual(cell["old"]["frame_ns"], cell["old"]["median_ns"] / 102)

    def test_a_change_in_disturbed_rounds_only(self):
        disturbed = record(1.5, session="t")
        disturbed["conditions"] = {
            "disturbed": [
                {"round": number, "why": "busy: other processes use 1.0 of 2 cores"} for number in range(9)
            ]
        }
        old, new = self.write(record(session="s")), self.write(disturbed)
        out = self.compared(old, new).replace("\n  ", " ")
        self.assertIn(
            " disturbed ", next(line for line in out.splitlines() if line.startswith("grouped schedule "))
        )
        self.assertIn("new: 9 of 9 rounds are disturbed (busy: other processes use 1.0 of 2 cores)", out)
        self.assertIn("1 changed in disturbed rounds only", out)
        found = self.json_of(old, new, "--strict", code=1)
        self.assertEqual(
            (found["cells"][0]["verdict"], found["changed"], found["cells"][0]["new"]["disturbed_rounds"]),
            ("disturbed", False, 9),
        )
        self.compared(old, old, "--strict")

    def test_too_few_samples(self):
        out = self.compared(self.write(record(samples=3)), self.write(record(9, samples=3)))
        self.assertIn("too few samples to tell", out)
        self.assertIn(
            "1 has too few samples to tell: 4 rounds on each side are enough", out.replace("\n  ", " ")
        )

    def test_few_rounds_have_no_interval(self):
        """One round against one, and 12 against 1: the test rejects no ratio, also at a level at which it
        could show a change."""
        for old, new, level in ((1, 1, 0.05), (12, 1, 0.05), (3, 3, 0.35), (12, 1, 0.35)):
            files = (
                self.write(record(samples=old), record(k="18")),
                self.write(record(2, samples=new), record(k="18")),
            )
            code = 1 if level > 0.05 else 0
            out = self.compared(*files, "--level", level, code=code)
            row, other = (
                next(line for line in out.splitlines() if line.startswith(name)) for name in ("k=8 ", "k=18 ")
            )
            self.assertRegex(row, r"  (2\.0|1\.9)\d\d - ")
            self.assertRegex(other, r"  1\.000 \[0\.99\d, 1\.00\d\] ")
            self.assertEqual(
                out.replace("\n  ", " ").count(
                    "1 of 2 cells has no interval (-): so few rounds exclude no ratio with 95 % confidence"
                ),
                1,
            )
            self.assertRegex(
                self.compared(*files, "--format", "markdown", "--level", level, code=code),
                r"\| (2\.0|1\.9)\d\d - \|",
            )
            times = self.json_of(*files, "--level", level, code=code)["cells"][0]["times"]
            self.assertEqual(
                (times["low"], times["high"], times["log_error"], times["least_effect"]),
                (None, None, None, None),
            )
            self.assertAlmostEqual(times["ratio"], 2, delta=0.02)
        page = self.work / "page.html"
        self.assertEqual(tandem("report", files[1], "--against", files[0], "-o", page)[0], 0)
        self.assertRegex(page.read_text(), r'"ratio": ?\[(2\.0|1\.9)\d*, ?null, ?null\]')

    def test_commits_of_one_file(self):
        both = self.write(record(), record(1.5, commit="bbbb11112222"), record(1, commit="bbbc11112222"))
        for old, new, *more in (
            (f"{both}@aaaa", f"{both}@bbbb"),
            (both, both, "--commit-old", "aaaa", "--commit-new", "bbbb"),
            (f"{both}@aaaa", both, "--commit-new", "bbbb"),
        ):
            found = self.json_of(old, new, *more, code=1)
            self.assertEqual(
                (found["old"]["commits"], found["new"]["commits"]), (["aaaa11112222"], ["bbbb11112222"])
            )
        self.bad(["no record of commit cccc", "aaaa11112222"], "compare", both, f"{both}@cccc")
        self.bad("may be bbbb11112222 or bbbc11112222", "compare", both, f"{both}@bbb")
        self.bad("name one commit", "compare", both, f"{both}@aaaa", "--commit-new", "bbbb")
        out = self.compared(both, both)
        self.assertIn("old and new are the same records", out)
        self.assertIn(
            "1 cell was recorded more than once; the last record that is ok counts", out.replace("\n  ", " ")
        )

    def test_excluded_records_are_reported(self):
        failed, wrong = record(k="26"), record(k="14")
        failed.update(status="failed", failure="device\nlost", total_ns=None, work=None)
        wrong["status"] = "wrong"
        old, new = self.write(record(), record(k="18")), self.write(record(), failed, wrong, record(k="24"))
        out = self.compared(old, new)
        for words in (
            f"{new}:2 is left out: k=26: failed: device lost",
            f"{new}:3 is left out: k=14: its answer is not",
            "1 cell is in old only: k=18",
            "1 cell is in new only: k=24",
            "0 of 1 cell slower",
        ):
            self.assertIn(words, out.replace("\n  ", " "))
        found = self.json_of(old, new)
        self.assertEqual(
            [(r["line"], r["status"]) for r in found["new"]["left_out"]], [(2, "failed"), (3, "wrong")]
        )
        self.assertEqual([len(found[side]["only_here"]) for side in ("old", "new")], [1, 1])
        self.bad("none of 2 records is ok and has samples", "compare", self.write(failed, wrong), new)

    def test_a_torn_line_is_ignored_and_reported(self):
        old, torn = self.write(record()), self.write(record(), record(k="18"), end="")
        for path in (torn, self.write(record(), end="\n" + json.dumps(record())[:77])):
            out = self.compared(old, path)
            self.assertIn("the last line has no end", out)
            self.assertIn("0 of 1 cell slower", out)
            self.assertTrue(self.json_of(old, path)["new"]["torn"])
        self.assertFalse(self.json_of(old, old)["new"]["torn"])
        self.bad("its only line has no end", "compare", old, self.write(record(), end=""))

    def test_bad_files(self):
        good, folder = self.write(record()), self.work
        empty, noise = self.work / "empty.jsonl", self.work / "noise.jsonl"
        empty.write_text("")
        noise.write_text(good.read_text() + "no record\n")
        newer, older = record(), record()
        newer["schema"], older["schema"] = 5, 1
        less = record()
        del less["devices"]
        ceilings = SOURCE / "tests/records/ceilings.jsonl"
        for path, words in (
            (self.work / "none.jsonl", "cannot be read"),
            (folder, "is a folder"),
            (empty, "is empty"),
            (noise, f"{noise}:2: is not JSON"),
            (self.write(record(), newer), ":2: a record of schema 5"),
            (self.write(older), "scripts/convert_records"),
            (self.write(less), ":1: is no record of a cell"),
            (ceilings, f"{ceilings}:1: is no record of a cell"),
        ):
            self.bad(words, "compare", good, path)
            self.bad(words, "compare", path, good)
        self.bad(
            ["have no cell in common", "the nearest differ in k=8 / k=18)"],
            "compare",
            good,
            self.write(record(k="18")),
        )

    def test_bad_use(self):
        good = self.write(record())
        for arguments in (
            (),
            (good,),
            (good, good, good),
            (good, good, "--threshold", "-1"),
            (good, good, "--threshold", "x"),
            (good, good, "--level", "0"),
            (good, good, "--level", "0.6"),
            (good, good, "--format", "xml"),
        ):
            self.bad("", "compare", *arguments)

    def test_formats(self):
        old, new = self.write(record(), record(k="18")), self.write(record(1.05), record(k="18"))
        text, markdown = (self.compared(old, new, "--format", form, code=1) for form in ("text", "markdown"))
        self.assertEqual(text, self.compared(old, new, code=1))
        rows = [line for line in markdown.splitlines() if line.startswith("|")]
        self.assertEqual(len(rows), 4)
        self.assertEqual({row.count("|") for row in rows}, {8})
        found = self.json_of(old, new, code=1)
        self.assertEqual(
            found["verdicts"],
            {
                "slower": 1,
                "faster": 0,
                "within_threshold": 0,
                "not_shown": 1,
                "too_few": 0,
                "disturbed": 0,
                "another_answer": 0,
            },
        )
        self.assertTrue(found["changed"])
        self.assertEqual([c["key"] for c in found["cells"]], [record()["key"], record(k="18")["key"]])
        self.assertIn(found["summary"], " ".join(text.split()))
        for form, out in (("text", text), ("markdown", markdown)):
            self.assertEqual(out, self.compared(old, new, "--format", form, code=1), "not the same twice")
            self.assertNotIn("\x1b", out)

    def test_other_devices_are_reported(self):
        new = record()
        new["devices"][0]["name"] = "NVIDIA A100"
        self.assertIn(
            "other models: old NVIDIA H200, new NVIDIA A100",
            self.compared(self.write(record()), self.write(new)),
        )

    def test_committed_records(self):
        for name in ("plan", "paper/records/convert"):
            path = SOURCE / f"results/h200/{name}.jsonl"
            found = self.json_of(path, path)
            self.assertEqual(len({cell["label"] for cell in found["cells"]}), len(found["cells"]))
            self.assertEqual({cell["times"]["ratio"] for cell in found["cells"]}, {1.0})
            self.assertLessEqual(max(map(len, self.compared(path, path).splitlines())), 100)

    def test_unwritable_output(self):
        path = self.write(record())
        with open("/dev/full", "w") as full:
            done = subprocess.run(
                [str(PROGRAM), "compare", path, path], stdout=full, stderr=subprocess.PIPE, text=True
            )
        self.assertEqual((done.returncode, done.stderr.count("\n")), (3, 1), done.stderr)
        self.assertIn("standard output could not be written", done.stderr)
