# SPDX-License-Identifier: MIT
# test: cost=20 full=50
"""Cells in separate processes, and the effects of killing these processes or the
program."""

import json
import os
import pathlib
import signal
import subprocess
import time

from tests.program import PROGRAM, SMALL, Case, messages, sets, tandem, words_of

CAPACITIES = {
    name: capacity for name, capacity in SMALL.items() if name in ("pair_capacity", "contact_capacity")
}
CELLS = (
    "plates:count=2",
    "--frames 0:1 --device host --algorithm chunked,tiled --truth none",
    *sets(CAPACITIES),
)


def children(process):
    """Cell processes that it has started and that are past exec; the program waits for exec."""
    try:
        started = [
            int(word) for word in pathlib.Path(f"/proc/{process}/task/{process}/children").read_text().split()
        ]
        return [
            child for child in started if b"isolated" in pathlib.Path(f"/proc/{child}/cmdline").read_bytes()
        ]
    except (FileNotFoundError, ProcessLookupError):
        return []


def is_alive(process):
    try:
        return pathlib.Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] not in "ZX"
    except FileNotFoundError:
        return False


def wait_for(what):
    """Waits without a limit of its own: that of the whole test ends it."""
    while not (result := what()):
        time.sleep(0.002)
    return result


class Isolation(Case):
    def start(self, *arguments):
        return subprocess.Popen(
            [str(PROGRAM), "run", *words_of(arguments)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def end(self, process):
        out, errors = process.communicate()
        return process.returncode, out, messages(errors)

    def test_the_same_answers(self):
        local, isolated = self.work / "local.jsonl", self.work / "isolated.jsonl"
        for path, more in ((local, ()), (isolated, ("--isolate", "--timeout", 100))):
            self.output("run", *CELLS, "--repeat", 2, "--out", path, *more)
        one, two = ({r["key"]: r for r in self.records(path)} for path in (local, isolated))
        self.assertEqual(set(one), set(two))
        for key, record in one.items():
            other = two[key]
            for part in ("agreement", "error", "settings"):
                self.assertEqual(record[part], other[part])
            for part in ("body_pairs", "candidate_pairs", "contacts", "digest", "counters", "submissions"):
                self.assertEqual(record["work"][part], other["work"][part], part)
            self.assertEqual(
                len(other["stages"]["traverse"]["device_ns"]["samples"]), self.rounds_of_two_samples(other)
            )

    def test_a_crash_affects_its_cell_only(self):
        out = self.work / "crash.jsonl"
        process = self.start(*CELLS, "--repeat", 2, "--isolate", "--out", out)
        victim = wait_for(lambda: children(process.pid))[0]
        os.kill(victim, signal.SIGSEGV)
        status, text, errors = self.end(process)
        self.assertEqual((status, len(errors)), (3, 1), (text, errors))
        self.assertIn("its process ended by signal 11 (Segmentation fault)", errors[0])
        self.assertEqual([r["status"] for r in self.records(out)], ["failed", "ok"])

    def test_a_hang_affects_its_cell_only(self):
        out = self.work / "hang.jsonl"
        process = self.start(*CELLS, "--repeat", 2, "--isolate", "--timeout", 10, "--out", out)
        victim = wait_for(lambda: children(process.pid))[0]
        os.kill(victim, signal.SIGSTOP)
        status, text, errors = self.end(process)
        self.assertEqual((status, len(errors)), (3, 1), (text, errors))
        self.assertIn("its process took longer than 10 s and was ended", errors[0])
        self.assertEqual([r["status"] for r in self.records(out)], ["failed", "ok"])
        self.assertFalse(is_alive(victim))

    def test_no_process_outlives_the_program(self):
        process = self.start(
            "pile:bodies=300,frames=1 --device host --algorithm chunked --isolate --noise 1e-09 "
            "--seconds 100000"
        )
        child = wait_for(lambda: children(process.pid))[0]
        time.sleep(1)  # it has read its task
        self.assertTrue(is_alive(child))
        process.kill()
        process.wait()
        wait_for(lambda: not is_alive(child))  # long before its cell has its samples

    def test_bad_use(self):
        self.bad("--timeout requires --isolate", "run", *CELLS, "--timeout", 3)
        self.bad("--timeout", "run", *CELLS, "--isolate", "--timeout", 0)

    def test_rounds_survive_a_kill(self):
        """A cell that was killed in its third round continues with the fourth, without another check."""
        out, left = self.work / "rounds.jsonl", self.work / "rounds.jsonl.unfinished"
        arguments = (
            "plates:count=2",
            f"--frames 0:8 --device host --algorithm chunked,tiled --repeat 8 --truth none --out {out}",
        )
        process = self.start(*arguments)
        wait_for(lambda: left.exists() and len(left.read_text().splitlines()) >= 5)
        process.kill()
        self.end(process)
        self.assertEqual(out.read_text(), "")
        kept = [json.loads(line) for line in left.read_text().splitlines() if line.endswith("}")]
        taken = [round["frame_ns"] for line in kept for round in line["rounds"]["samples"]]
        status, text, errors = tandem("run", *CELLS, "--repeat", 1, "--out", out)
        self.assertEqual(status, 0, errors)
        # the run must not remove rounds of other cells
        self.assertGreaterEqual(len(left.read_text().splitlines()), len(kept))
        status, text, errors = tandem("run", *arguments, "--resume")
        # a half-written round
        self.assertEqual((status, [line for line in errors if "torn" not in line]), (0, []), text)
        records = self.records(out)[2:]
        self.assertEqual([len(r["total_ns"]["samples"]) for r in records], [8, 8])
        self.assertTrue(all(len(r["sampling"]["continued"]) == 1 for r in records))
        frames = [sample for r in records for sample in r["total_ns"]["frames"]]
        self.assertEqual(len([sample for sample in taken if sample in frames]), len(taken))
        at = {r["sampling"]["continued"][0] for r in records}
        self.assertEqual(len(at), 1)  # all later ones interleave
        self.assertFalse(left.exists())
