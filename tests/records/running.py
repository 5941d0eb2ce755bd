# SPDX-License-Identifier: MIT
# test: cost=25
"""Cells of several scenes and ranges are listed, interrupted and continued."""

import json
import re
import signal
import subprocess
import time

from tests.program import PROGRAM, SOURCE, Case, cells_of, tandem, words_of

SCENES = ("plates:count=2", "pile:bodies=2,frames=1")
CELLS = (*SCENES, "--frames", 0, "--device", "host", "--algorithm", "chunked,tiled", "--truth", "none")


class Running(Case):
    def records(self, path):
        return cells_of(path.read_text())

    def cells(self, path):
        """Scene, algorithm and k of each record."""
        return sorted((r["scene"]["name"], r["algorithm"], r["settings"]["k"]) for r in self.records(path))

    def test_committed_cells_have_the_keys_that_a_run_lists(self):
        """Scene with digest, frames and every recorded setting; settings that are newer than the record are
        listed too."""
        committed = self.records(SOURCE / "results/cpu/walks.jsonl") + self.records(
            SOURCE / "tests/records/chunk_sizes.jsonl"
        )
        self.assertEqual(len(committed), 20)
        for record in committed:
            settings = {**record["settings"], **record["asked"]}
            sets = [word for name, value in settings.items() for word in ("--set", f"{name}={value}")]
            frames = f"{record['frames']['first']}:{record['frames']['last']}"
            out = self.output(
                "run",
                record["scene"]["key"],
                f"--frames {frames} --algorithm",
                record["algorithm"],
                "--preset",
                record["preset"],
                "--device",
                record["devices"][0]["id"],
                *sets,
                "--dry-run --keys",
            )
            (key,) = re.findall(rf"(?m)^ +({record['algorithm']}\|.*)$", out)
            listed, recorded = key.split("|"), record["key"].split("|")
            self.assertEqual(listed[2:-1], recorded[2:-1])
            listed, recorded = (
                dict(part.split("=") for part in parts[-1].split(",")) for parts in (listed, recorded)
            )
            self.assertEqual({name: listed.get(name) for name in recorded}, recorded)
            self.assertLessEqual(
                set(listed) - set(recorded),
                {"builder", "convert", "most_seeds", "origin", "pair_layout", "sizes", "submission"},
            )

    def test_ranges(self):
        for text, values in (
            ("6..8:2", "6 8"),
            ("6..26*2", "6 12 24"),
            ("6,8..12*1.5", "6 8 12"),
            ("18", "18"),
        ):
            out = self.output(
                f"run plates:count=2 --frames 0 --device host --algorithm tiled --set k={text} --dry-run --keys"
            )
            self.assertEqual(re.findall(r",k=(\d+),", out), values.split())
        for text, message in (
            ("8..6", "never ends"),
            ("6..8*1", "never ends"),
            ("0..8*2", "never ends"),
            ("6..8:0", "never ends"),
            ("x..8", "a range is"),
            ("6..", "a range is"),
            ("6..8*", "a range is"),
            ("0..1e9", "more than 10000 values"),
            ("6..1e999", "a range is"),
            ("-2..6", "a range is"),
        ):
            self.bad(message, "run", "plates:count=2", "--set", f"k={text}")

    def test_dry_run_lists_and_writes_nothing(self):
        out = self.work / "dry.jsonl"
        status, text, errors = tandem(
            "run", *CELLS, "--set", "k=6,8,6", "--seconds", 7, "--dry-run", "--keys", "--out", out
        )
        self.assertEqual((status, len(errors)), (0, 1), errors)
        self.assertIn("4 cells are named more than once", errors[0])
        self.assertIn("8 cells, about 56 s of rounds;", text)
        self.assertEqual(len(re.findall(r"(?m)^ +\d+ +7 s  (?:grouped schedule|tiled) .*on host$", text)), 8)
        self.assertEqual(len(re.findall(r"(?m)^ +(?:chunked|tiled)\|host:", text)), 8)
        self.assertFalse(out.exists())

    def test_checks_are_cached(self):
        """The next run reuses the results of reference and truth for a frame; none of them makes an answer wrong."""
        folder = self.work / "cache"
        arguments = ("run", "plates:count=2", "--frames", "0:1", "--device", "host", "--algorithm", "tiled")
        words = lambda *more: re.search(
            r"truth: (\d+) of (\d+)\s+meeting pairs missed,\s+(\d+)\s+candidates do\s+not\s+meet",
            tandem(*arguments, *more, environment={"TANDEM_KERNEL_CACHE": str(folder)})[1],
        ).groups()
        first = words()
        files = {path: path.read_text() for path in folder.glob("checks-*.jsonl")}
        self.assertEqual((len(files), [text.count("question") for text in files.values()]), (2, [2, 2]))
        self.assertEqual(words("--isolate"), first)
        self.assertEqual({path: path.read_text() for path in files}, files)  # nothing was recomputed
        for path, text in files.items():
            path.write_text(
                re.sub(r'"disjoint":(\d+)', '"disjoint":1000000', text).replace('"pairs":[', '"pairs":[1')
            )
        self.assertEqual(words(), (*first[:2], "2000000"))
        self.assertEqual(words("--check-afresh"), first)
        for path, text in files.items():
            path.write_text(
                text[: len(text) // 3] + '\n{"question": 3}\n[]\n' + text.replace('"pairs":', '"pair":')
            )
        self.assertEqual(words(), first)

    def test_resume_measures_the_remaining_cells(self):
        out = self.work / "resumed.jsonl"
        arguments = ("run", *CELLS, "--set", "k=6,8", "--out", out)
        self.assertEqual(tandem(*arguments)[0], 0)
        whole = self.cells(out)
        self.assertEqual(len(set(whole)), 8)
        lines = [json.dumps(record) + "\n" for record in cells_of(out.read_text())]
        # Records of another program version, and failed or interrupted ones, do not count as finished.
        other = json.loads(lines[3])
        other["environment"]["sources"] = "0" * 16
        failed = {**json.loads(lines[4]), "status": "failed", "failure": "device lost"}
        short = json.loads(lines[5])
        short["sampling"]["interrupted"] = True
        out.write_text(
            "".join(lines[:3]) + "".join(json.dumps(record) + "\n" for record in (other, failed, short))
        )
        text = self.output(*arguments, "--resume", "--dry-run", "--repeat", 2)
        self.assertEqual(sorted(re.findall(r"(?m)^ +\d +(\d+ s|\?)  \w", text), key=len), ["?"] * 4 + ["0 s"])
        self.assertIn("5 cells, about 0 s of rounds and 4 cells of unknown duration; 3 more", text)
        text = self.output(*arguments, "--resume", "--dry-run")
        self.assertIn("5 cells, about ", text)
        self.assertIn("; 3 more are already in ", text)
        self.assertEqual(tandem(*arguments, "--resume")[0], 0)
        self.assertEqual(len(self.records(out)), 11)
        self.assertEqual(
            self.cells(out), sorted(whole + [whole_of(other), whole_of(failed), whole_of(short)])
        )
        status, text, _ = tandem(*arguments, "--resume")
        self.assertIn("8 cells are already in ", text)
        self.assertEqual((status, len(self.records(out))), (0, 11))
        self.bad("--resume requires --out", "run", *CELLS, "--resume")
        out.write_text(json.dumps({**json.loads(lines[0]), "schema": 2}) + "\n")
        self.bad("has records of schema 2", *arguments, "--resume")

    def test_an_interrupt_keeps_finished_measurements(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            out = self.work / f"interrupted{number}.jsonl"
            words = [
                f"run {self.twice} --device host --algorithm chunked,tiled "
                f"--truth none --no-count --noise 0.0001% --seconds 100000 --quiet --out {out}"
            ]
            process = subprocess.Popen(
                [str(PROGRAM), *words_of(words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
            )
            left = self.work / f"{out.name}.unfinished"
            while (
                not (left.exists() and left.read_text().count("\n") >= 8) and process.poll() is None
            ):  # several rounds of both cells
                time.sleep(0.02)
            process.send_signal(number)
            if number == signal.SIGTERM:  # Slurm sends two when the time limit is reached
                time.sleep(0.002)
                process.send_signal(number)
            text, errors = process.communicate()
            self.assertEqual(process.returncode, 128 + number, errors)
            self.assertRegex(
                errors,
                r"^tandem: stopping after this frame; .*\ntandem: interrupted; 2 cells are measured; to continue: tandem run .* --resume\n$",
            )
            self.assertIn("ms/frame", text)
            records = self.records(out)
            self.assertEqual([r["status"] for r in records], ["ok", "ok"])
            for record in records:
                self.assertTrue(record["sampling"]["interrupted"])
                self.assertGreater(record["sampling"]["rounds"], 1)

    def test_doubts_about_a_time_are_reported(self):
        """One line for all cells."""
        words = f"run {self.twice} --device host --truth none --noise 0.0001% --seconds 0.01 --algorithm"
        for algorithms, doubt in (
            ("tiled", "the interval is wider than asked for"),
            ("tiled,chunked", "2 of 2 intervals are wider than asked for"),
        ):
            status, text, _ = tandem(words, algorithms)
            self.assertEqual(status, 0)
            self.assertRegex(text, rf"(?m)^{doubt}(?:;|$)")
            self.assertEqual(len(re.findall("asked for", text)), 1, text)

    def test_tables_fit_a_hundred_columns(self):
        status, text, _ = tandem(
            "run plates:count=2 --frames 0 --device host --algorithm all --preset all --truth none "
            "--no-count --set pair_capacity=65536 --set queue_capacity=4096"
        )
        self.assertEqual(status, 0, text)
        tables = re.split(r"\n\n.*right: ", text)[0].split("\n", 1)[1]
        self.assertLessEqual(max(map(len, tables.splitlines())), 100, tables)
        self.assertNotIn("\033", text)
        self.assertIn("times as long", tables)

    def test_scenes_are_opened_before_they_are_measured(self):
        self.bad("unknown scene", "run plates:count=2 plaits --frames 0 --device host --algorithm tiled")
        self.bad("dumps need one scene", "run", *CELLS, "--dump-pairs", self.work / "pairs.csv")
        self.bad("exclude each other", "run", *SCENES, "--mesh", self.good)


def whole_of(record):
    return record["scene"]["name"], record["algorithm"], record["settings"]["k"]
