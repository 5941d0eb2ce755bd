# SPDX-License-Identifier: MIT
# test: cost=6 full=50
"""The command `tandem compare --run`, on programs that write made-up
records, and on the program itself."""

import json
import os
import signal
import subprocess
import sys
import time
import unittest

from tests.program import BUILT, LONG, PROGRAM, SOURCE, Case, tandem

CLOCKS = BUILT / "libskewed_clocks.so"
LINE = json.loads((SOURCE / "results/h200/paper/records/resident-plates.jsonl").read_text().splitlines()[3])
# Appends a record to the file of --out, as 'tandem run' does. Times drift by 20 % a turn.
PROGRAM_TEXT = """#!/usr/bin/python3
import json, os, pathlib, select, signal, sys, time
made, words = json.loads({record!r}), sys.argv[1:]
out = pathlib.Path(words[words.index("--out") + 1])
with open({log!r}, "a") as log:
    log.write(json.dumps([{name!r}, *words]) + "\\n")
turn = int(out.stem.rpartition("-")[2])
asked = []
signal.signal(signal.SIGTERM, lambda *_: asked.append(1))
{before}
made["session"] = str(os.getpid())
made["total_ns"]["samples"] = [1e7 * {factor} * 1.2**turn * (1 + 0.001 * (i * turn % 7)) for i in range(9)]
made["total_ns"]["rounds"] = list(range(9))
out.write_text(json.dumps(made) + "\\n")
{after}
"""


class ComparePrograms(Case):
    def program(self, name, factor=1.0, before="", after="", **change):
        path = self.work / name
        path.write_text(
            PROGRAM_TEXT.format(
                record=json.dumps(LINE | change),
                log=str(self.log),
                name=name,
                factor=factor,
                before=before,
                after=after,
            )
        )
        path.chmod(0o755)
        return path

    def setUp(self):
        self.log = self.work / f"{self.id()}.log"

    def started(self):
        """The programs in the order of their starts, with their words."""
        return [json.loads(line) for line in self.log.read_text().splitlines()]

    def run_both(self, old, new, *options, code=0, errors=()):
        status, out, lines = tandem("compare", "--run", *options, old, new, "--", "plates", "--frames", "1:2")
        self.assertEqual((status, lines), (code, list(errors)), out)
        return out

    def test_turns_and_words(self):
        self.run_both(self.program("a"), self.program("b"), "--sessions", 3)
        started = self.started()
        self.assertEqual([name for name, *_ in started], ["a", "b", "b", "a", "a", "b"])
        for _, *words in started:
            self.assertEqual(words[:5], ["run", "plates", "--frames", "1:2", "--quiet"])
        self.assertEqual(
            [words[-1].rpartition("/")[2] for words in started],
            [f"{name}.jsonl" for name in ("old-1", "new-1", "new-2", "old-2", "old-3", "new-3")],
        )

    def test_processes_of_a_turn_are_pairs(self):
        """The drift from turn to turn is far larger than the change."""
        out = self.run_both(self.program("a"), self.program("b", 1.05), "--format", "json", code=1)
        (cell,) = json.loads(out)["cells"]
        self.assertEqual(
            (cell["verdict"], cell["paired"], cell["unit"], cell["old"]["sessions"], cell["old"]["rounds"]),
            ("slower", True, "session", 12, 108),
        )
        self.assertAlmostEqual(cell["times"]["ratio"], 1.05, places=6)
        self.assertAlmostEqual(cell["times"]["p"], 2 / 2**12)
        out = self.run_both(self.program("a"), self.program("b"))
        self.assertIn("1 cell is compared by sessions: 12 of old and 12 of new", out)

    def test_records_are_kept(self):
        folder = self.work / "kept"
        self.run_both(self.program("a"), self.program("b"), "--sessions", 2, "--out", folder)
        self.assertEqual(
            sorted(path.name for path in folder.iterdir()),
            ["new-1.jsonl", "new-2.jsonl", "old-1.jsonl", "old-2.jsonl"],
        )
        self.bad(
            "is not empty; name a new folder", f"compare --run {PROGRAM} {PROGRAM} --out {folder} -- plates"
        )
        self.bad(
            "cannot be a folder", f"compare --run {PROGRAM} {PROGRAM} --out {folder}/old-1.jsonl -- plates"
        )
        self.assertEqual(len(list(folder.iterdir())), 4)

    def test_an_older_program(self):
        """Records of schema 2 have keys with numbers of devices, which are converted."""
        algorithm, _, rest = LINE["key"].split("|", 2)
        older = {
            "schema": 2,
            "key": f"{algorithm}|cuda:0|{rest}",
            "environment": LINE["environment"] | {"clocks_mhz": None},
        }
        folder = self.work / "older"
        out = self.run_both(
            self.program("a", **older), self.program("b"), f"--sessions 6 --out {folder} --format json"
        )
        self.assertEqual(len(json.loads(out)["cells"]), 1)
        self.assertEqual(json.loads((folder / "old-1.jsonl").read_text())["schema"], 4)

    def test_another_answer_and_wrong_answers(self):
        other = LINE["work"] | {"digest": {"count": 7, "a": "00", "b": "00"}}
        self.assertIn(
            "another answer",
            self.run_both(self.program("a"), self.program("b", work=other), "--sessions", 2, code=1),
        )
        wrong = self.program("b", after="sys.exit(1)", status="wrong")
        self.run_both(
            self.program("a"),
            wrong,
            "--sessions 2",
            code=1,
            errors=[f"tandem: {wrong}: none of 2 records is ok and has samples; record its cells again"],
        )

    def test_a_failure_keeps_whole_turns(self):
        lost = self.program(
            "b", before='if turn == 3: print("tandem: the device is lost", file=sys.stderr); sys.exit(3)'
        )
        out = self.run_both(
            self.program("a"), lost, code=3, errors=[f"tandem: {lost} failed in turn 3: the device is lost"]
        )
        self.assertIn("compared by sessions: 3 of old and 2 of new", out)
        killed = self.program("b", before="os.kill(os.getpid(), signal.SIGKILL)")
        self.run_both(
            self.program("a"), killed, code=3, errors=[f"tandem: {killed} failed in turn 1: signal 9"]
        )
        silent = self.program("b", before="sys.exit(0)")
        self.run_both(
            self.program("a"),
            silent,
            code=3,
            errors=[f"tandem: {silent} wrote no record in turn 1; give a build of this program"],
        )

    TURNS = """
goes, asks, seed = map(int, os.environ["TANDEM_TURNS"].split(","))
for i in range(rounds):
    os.write(asks, b"r")
    while not asked and not select.select([goes], [], [], 0.01)[0]: pass
    if not asked: os.read(goes, 1)
    with open({log!r}, "a") as log: log.write(json.dumps([sys.argv[0][-1] + str(i), seed]) + "\\n")
"""

    def test_rounds_alternate(self):
        """The orders of cells in rounds have one seed in a turn. The longer one goes on alone."""
        turns = self.TURNS.format(log=str(self.log))
        self.run_both(
            self.program("a", before="rounds = 3" + turns),
            self.program("b", before="rounds = 2" + turns),
            "--sessions 2",
        )
        rounds = [(name, *rest) for name, *rest in self.started() if name[1:].isdigit()]
        self.assertEqual(
            [name for name, _ in rounds], ["a0", "b0", "a1", "b1", "a2", "b0", "a0", "b1", "a1", "a2"]
        )
        self.assertEqual([seed for _, seed in rounds], [1] * 5 + [2] * 5)
        self.assertEqual([name for name, *_ in self.started() if name in "ab"], ["a", "b", "b", "a"])

    def test_a_failure_ends_the_other_process(self):
        """It waits for its turn, and its round is lost."""
        turns = self.TURNS.format(log=str(self.log))
        ended = "rounds = 3" + turns + "    if asked: sys.exit(143)\n"
        lost = self.program(
            "b",
            before="rounds = 1" + turns + 'print("tandem: the device is lost", file=sys.stderr); sys.exit(3)',
        )
        self.run_both(
            self.program("a", before=ended),
            lost,
            code=3,
            errors=[f"tandem: {lost} failed in turn 1: the device is lost"],
        )
        refused = self.program("b", before='print("tandem: no such scene", file=sys.stderr); sys.exit(2)')
        self.bad(
            f"{refused}: no such scene",
            "compare --run",
            self.program("a", before=ended),
            refused,
            "-- plates",
        )

    def test_many_messages_do_not_block(self):
        many = self.program(
            "a",
            before='print("tandem: x\\n" * 100000, file=sys.stderr)\nrounds = 2'
            + self.TURNS.format(log=str(self.log)),
        )
        self.run_both(many, many, "--sessions", 2)

    def test_an_interrupt_keeps_whole_turns(self):
        waits = self.program("b", before="while turn == 2 and not asked: time.sleep(0.01)")
        folder = self.work / "interrupted"
        process = subprocess.Popen(
            [str(PROGRAM), "compare", "--run", "--out", folder, self.program("a"), waits, "--", "plates"],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=os.environ,
        )
        while not (self.log.exists() and len(self.started()) == 3) and process.poll() is None:
            time.sleep(0.02)
        time.sleep(0.2)  # until the program has set its handler
        process.send_signal(signal.SIGINT)
        out, errors = process.communicate()
        self.assertEqual((process.returncode, errors), (130, "tandem: interrupted in turn 2 of 12\n"), out)
        self.assertIn("compared by sessions: 1 of old and 2 of new", out)
        self.assertEqual(
            sorted(path.name for path in folder.iterdir()), ["new-1.jsonl", "new-2.jsonl", "old-1.jsonl"]
        )

    def test_bad_use(self):
        a, b = (
            self.program("a"),
            self.program("b", before='print("tandem: unknown scene", file=sys.stderr); sys.exit(2)'),
        )
        text = self.work / "text"
        text.write_text("no program")
        for words, arguments in (
            ("--run needs a scene or a plan", (a, a)),
            ("/nowhere: is no program; with --run, NEW is", (a, "/nowhere", "--", "plates")),
            (f"{text}: is no program; with --run, OLD is", (text, a, "--", "plates")),
            (f"{b}: unknown scene", (a, b, "--", "plates")),
            ("--out=x: 'tandem compare --run' decides this itself", (a, a, "--", "plates", "--out=x")),
            ("unknown option --frames", (a, a, "plates", "--frames", "1:2")),
            ("--sessions", (a, a, "--sessions", 1, "--", "plates")),
            ("--commit-old", (a, a, "--commit-old", "f", "--", "plates")),
        ):
            self.bad(words, "compare", "--run", *arguments)
        for arguments in ((a, a, "plates"), (a, a, "--sessions", 3), (a, a, "--out", "x")):
            self.bad("requires --run", "compare", *arguments)

    def test_the_program_itself(self):
        out = self.output(
            f"compare --run --sessions 2 --format json {PROGRAM} {PROGRAM} -- --mesh {self.good} "
            f"--mesh {self.good} --device host --algorithm tiled --truth none --no-count --repeat 2"
        )
        found = json.loads(out)
        self.assertEqual(
            ([cell["verdict"] for cell in found["cells"]], found["old"]["records"]), (["too_few"], 2)
        )
        self.assertIn("old and new are the same program", found["notes"])

    @unittest.skipUnless(LONG, "long form")
    def test_one_program_against_itself(self):
        """No cell of 25 comparisons changes, whatever else the machine does."""
        self.verdicts(PROGRAM, 25, 3, {"not_shown", "within_threshold", "disturbed"})

    @unittest.skipUnless(LONG, "long form")
    def test_five_percent_are_found(self):
        """In 45 of 50 cells that other work does not disturb. The clock of the new program is faster by 5 %."""
        slower = self.work / "slower"
        slower.write_text(f'#!/bin/sh\nLD_PRELOAD={CLOCKS} SKEW_PERCENT=105 exec {PROGRAM} "$@"\n')
        slower.chmod(0o755)
        found = self.verdicts(slower, 13, 10, {"slower", "not_shown", "within_threshold", "disturbed"})
        self.assertGreaterEqual(found.count("slower"), 0.9 * (len(found) - found.count("disturbed")), found)

    def verdicts(self, new, comparisons, rounds, allowed):
        """The verdicts of the program against another one, four cells each, which are all allowed. All
        processes run on one core."""
        found, cores = [], os.sched_getaffinity(0)
        os.sched_setaffinity(0, {max(cores)})
        self.addCleanup(os.sched_setaffinity, 0, cores)
        for _ in range(comparisons):
            _, out, errors = tandem(
                f"compare --run --format json {PROGRAM} {new} -- plates:count=2 --frames 20 --device host "
                f"--threads 1 --algorithm tiled,leaf_query --set k=8,18 --repeat {rounds} --no-check "
                "--truth none --no-count"
            )
            self.assertEqual(errors, [])
            found += [cell["verdict"] for cell in json.loads(out)["cells"]]
        print(
            f"\n  {len(found)} cells: {', '.join(f'{found.count(one)} {one}' for one in sorted(set(found)))}",
            file=sys.stderr,
        )
        self.assertLessEqual(set(found), allowed)
        return found
