# SPDX-License-Identifier: MIT
# test: cost=20
"""What people see of a run in a terminal: widths, names of cells, progress, keys,
signals."""

import fcntl
import json
import os
import pty
import re
import signal
import struct
import subprocess
import termios
import time

from tests.program import PROGRAM, Case, tandem, words_of

LISTED = r"(?m)^ +\d+ +(?:\d+ s|\?)  (.*)$"  # a cell of --dry-run
SMALL = ("plates:count=2", "--frames", "0:1", "--device", "host", "--truth", "none")


def read_whole(descriptor):
    parts = []
    while True:
        try:
            part = os.read(descriptor, 65536)
        except OSError:  # no process has the other end
            part = b""
        if not part:
            return b"".join(parts).decode()
        parts.append(part)


class Terminal(Case):
    def in_terminal(self, columns, *words):
        """(exit code, output and messages as a terminal of that width gets them)."""
        ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 50, columns, 0, 0))
        process = subprocess.Popen(
            [str(PROGRAM), *words_of(words)], stdin=subprocess.DEVNULL, stdout=theirs, stderr=theirs
        )
        os.close(theirs)
        text = read_whole(ours)
        os.close(ours)
        return process.wait(timeout=60), text.replace("\r\n", "\n")

    def test_tables_have_the_width_of_the_terminal(self):
        run = ("run", *SMALL, "--algorithm", "tiled,chunked", "--repeat", 2)
        heads = lambda text: [
            len(line) for line in re.sub("\033[^mK]*[mK]", "", text).splitlines() if "ms/frame" in line
        ]
        blocks = {}
        for columns in (60, 240):
            status, text = self.in_terminal(columns, *run, "--quiet")
            self.assertEqual(status, 0, text)
            tables = re.sub("\033[^mK]*[mK]", "", text.split("right: ")[0]).splitlines()
            self.assertLessEqual(max(map(len, tables[1:-1])), columns, text)
            blocks[columns] = len(tables)
        self.assertLess(blocks[240], blocks[60])
        self.assertEqual(len(heads(text)), 1, text)
        for columns, longest in (("70", 70), ("", 100)):
            text = tandem(*run, environment={"COLUMNS": columns})[1]
            self.assertLessEqual(
                max(map(len, text.split("\n\n", 1)[1].split("\n\ntiled")[0].splitlines())), longest, text
            )

    def test_a_cell_has_one_name(self):
        words = (*SMALL, "--algorithm", "tiled,chunked", "--set", "k=8,18")
        listed = re.findall(LISTED, tandem("run", *words, "--dry-run")[1])
        self.assertEqual(len(listed), 4)
        status, text = self.in_terminal(150, "run", *words, "--repeat", 2)
        self.assertEqual(status, 0, text)
        for name in listed:
            for place in (
                rf"\033\[K\[[^]\n]*\] \d/4 {re.escape(name)}: checking frame 1 of 2",
                rf"(?m)^{re.escape(name.removesuffix(' on host'))} .*± ",
            ):
                self.assertRegex(text, place)
        self.assertRegex(text, r"\[\d+ %, 0:\d\d, 0:\d\d left\] ")

    def test_settings_that_all_rows_have_stand_above_the_table(self):
        words = (
            "run",
            *SMALL,
            "--algorithm",
            "tiled,chunked,embree",
            "--set",
            "contact_rule=none",
            "--repeat",
            1,
        )
        text = tandem(*words, "--set", "k=6")[1]
        self.assertRegex(
            text, "(?m)2 frames on host; contact_rule=none, k=6$"
        )  # embree has k = 6 by its preset
        self.assertEqual(
            re.findall(r"(?m)^(\w[\w ]*\w)  +\d+\.\d+  ", text), ["tiled", "grouped schedule", "Embree"]
        )
        text = tandem("run", *SMALL, "--algorithm", "tiled", "--set", "k=6,8", "--repeat", 1)[1]
        self.assertRegex(text, "(?m)2 frames on host$")
        self.assertEqual(re.findall(r"(?m)^(tiled k=\d)  +\d", text), ["tiled k=6", "tiled k=8"])

    def test_dry_run_lists_the_keys_of_records(self):
        out = self.work / "keys.jsonl"
        words = (
            "run",
            *SMALL,
            "--algorithm all --preset all --no-check --no-count --set queue_capacity=4096",
        )
        status, text, errors = tandem(*words, "--dry-run", "--keys")
        self.assertEqual(status, 0, errors)
        self.assertLess(max(map(len, tandem(*words, "--dry-run")[1].splitlines()[1:])), 100)
        self.assertEqual(tandem(*words, "--out", out)[0], 0)
        records = self.records(out)
        self.assertTrue(
            any(record["asked"] for record in records), "no setting differs from what was asked for"
        )
        self.assertEqual(
            sorted(re.findall(r"(?m)^ +(\w+\|.*)$", text)), sorted(record["key"] for record in records)
        )
        text = tandem("run", *SMALL, "--algorithm", "auto", "--dry-run", "--keys")[1]
        self.assertRegex(text, r"1 +\?  auto on host\n +its key is that of the choice")

    def test_filter(self):
        words = (*SMALL, "--algorithm", "tiled,chunked", "--set", "k=8,18")
        names = lambda *more: re.findall(LISTED, tandem("run", *words, *more, "--dry-run")[1])
        every = names()
        self.assertEqual(
            names("--filter", "^tiled|k=8 "),
            [name for name in every if name.startswith("tiled") or "k=8 " in name],
        )
        self.assertEqual(names("--filter=tiled"), [name for name in every if "tiled" in name])
        for command in ("run", "check", "accuracy", "profile"):
            self.bad("--filter 'a[': is no regular expression (", command, *SMALL[:5], "--filter", "a[")
            self.bad("--filter 'nothing': matches none of ", command, *SMALL[:5], "--filter", "nothing")
        self.bad("one of them is 'tiled on host'", "run", *SMALL[:5], "--algorithm tiled --filter nothing")

    def test_throughput(self):
        out = self.work / "throughput.jsonl"
        text = self.output(
            "run", *SMALL, f"--algorithm tiled --columns pairs/s,GB/s --format markdown --out {out}"
        )
        rows = [
            [cell.strip() for cell in line.strip("|").split("|")]
            for line in text.splitlines()
            if line.startswith("|")
        ]
        table = dict(zip(rows[0], rows[2]))
        (record,) = self.records(out)
        seconds = record["total_ns"]["median"] * 1e-9
        unit, pairs = next(
            (head[: -len("pairs/s")], float(value))
            for head, value in table.items()
            if head.endswith("pairs/s")
        )
        self.assertAlmostEqual(
            pairs
            * {"": 1, "k ": 1e3, "M ": 1e6, "G ": 1e9}[unit]
            * seconds
            / sum(record["work"]["candidate_pairs"]),
            1,
            delta=0.001,
        )
        self.assertGreater(float(table["GB/s"]), 0)
        self.assertEqual(table["ms/frame"], "tiled")
        self.assertNotIn("pairs/s", tandem("run", *SMALL, "--algorithm", "tiled")[1])
        self.bad("--columns", "run", *SMALL, "--columns", "pairs")
        self.bad("--format", "run", *SMALL, "--format", "latex")

    def interrupted(self, number, *words):
        """(exit code, standard error) of a process that gets the signal as soon as its progress begins."""
        ours, theirs = pty.openpty()
        process = subprocess.Popen(
            [str(PROGRAM), *words_of(words)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=theirs,
        )
        os.close(theirs)
        first = b""
        while b"\033[K[" not in first:
            first += os.read(ours, 4096)
        process.send_signal(number)
        text = first.decode() + read_whole(ours)
        os.close(ours)
        return process.wait(timeout=60), text

    def test_a_signal_ends_within_a_frame(self):
        endless = ("plates", "--device", "host", "--algorithm", "tiled")
        for words in (
            ("run", *endless, "--seconds", 1000, "--check-afresh"),
            ("run", *endless, "--isolate"),
            ("check", *endless),
            ("accuracy", *endless, "--check-afresh"),
            ("simulate", "arch", "--device", "host", "--steps", 100000, "-o", self.work / "endless.frames"),
        ):
            for number in (signal.SIGINT, signal.SIGTERM):
                with self.subTest(words=words, number=number):
                    for path in self.work.glob("endless*"):
                        path.unlink()
                    status, text = self.interrupted(number, *words)
                    self.assertEqual(status, 128 + number, text)
                    self.assertEqual(text.count("tandem: stopping after this frame; "), 1, text)

    def test_an_interrupted_simulation_continues(self):
        recording, record = self.work / "stopped.frames", self.work / "stopped.jsonl"
        words = f"simulate arch:segments=2 --device host -o {recording} --record {record} --steps"
        status, text = self.interrupted(signal.SIGINT, f"{words} 100000 --checkpoint 100000")
        self.assertEqual(status, 130, text)
        done = int(
            re.search(r"tandem: interrupted after step (\d+) of 100000; to continue: .* --resume", text)[1]
        )
        self.assertGreater(done, 0)
        status, out, _ = tandem(f"{words} {done + 1} --resume")
        self.assertEqual(status, 0)
        self.assertIn(f"continues after step {done}\n", out)
        steps = [
            line["step"]
            for line in map(json.loads, record.read_text().splitlines())
            if line["kind"] == "step"
        ]
        self.assertEqual(steps, list(range(done + 1)))

    def test_measuring_ceilings_ends_at_once(self):
        process = subprocess.Popen(
            [str(PROGRAM), "devices", "--measure", "--device", "host"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=60), -signal.SIGINT)

    def test_a_simulation_needs_an_output(self):
        self.bad("no output; give -o FILE.frames", "simulate", "arch", "--device", "host")
