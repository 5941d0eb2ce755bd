# SPDX-License-Identifier: MIT
# test: cost=25 full=50
"""run, plans, simulate and paper are killed at random moments and resumed until they
finish, repeatedly: no record is lost, and the final result equals that without a kill."""

import collections
import json
import os
import random
import shutil
import signal
import subprocess
import time

from tests.program import LONG, PROGRAM, Case, sets, tried, words_of

KILLS = 200 if LONG else 6  # per command
CAPACITIES = {
    name: 4096 for name in ("pair_capacity", "contact_capacity", "tile_pair_capacity", "seed_capacity")
}
PLAN = {
    "plan": "to be killed",
    "scenes": ["plates:count=2", "pile:bodies=2,frames=1", "pile:bodies=3,frames=1"],
    "frames": 0,
    "devices": ["host", "opencl:0"] if LONG else "host",
    "algorithms": ["chunked", "tiled"],
    "settings": {"k": [6, 8]},
    "measure": {"repeat": 3, "truth": "none"},
}


def whole_lines(path):
    return path.read_bytes().split(b"\n")[:-1] if path.exists() else []


class Kills(Case):
    counts, clear = collections.Counter(), set()

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.chance = random.Random(2018)
        cls.plan = cls.work / "plan.json"
        cls.plan.write_text(json.dumps(PLAN))

    @classmethod
    def tearDownClass(cls):
        print(f"kills: {dict(cls.counts)}")
        if cls.clear == {"run", "plan", "simulate", "paper"}:
            tried(
                "kills at random moments: run, plans, simulate and paper", sum(cls.counts.values()), "kills"
            )
        super().tearDownClass()

    def words(self, command, folder):
        cells = (
            f"{self.twice} --device host --algorithm chunked,tiled",
            *sets({"k": "6,8", **CAPACITIES}),
            "--repeat 2 --truth none",
        )
        return {
            "run": ("run", *cells, "--resume", "--out", folder / "new.jsonl"),
            "plan": ("run", self.plan, "--resume", "--out", folder / "new.jsonl"),
            "simulate": (
                f"simulate arch:segments=2 --steps 20 --checkpoint 3 --device host -o {folder}/a.frames "
                f"--record {folder}/new.jsonl --quiet",
            ),
            "paper": (
                f"paper --device host -o {folder} --steps chunks-morton,chunks-breadth --measure-only",
            ),
        }[command]

    def start(self, command, folder):
        words = self.words(command, folder)
        if command == "simulate" and (folder / "a.frames").exists():
            words += ("--resume",)
        if command == "plan" and self.chance.random() < 0.3:
            words += ("--isolate",)
        # A separate process group: a kill by a user or a scheduler also reaches children; half of the kills
        # here do not.
        return subprocess.Popen(
            [str(PROGRAM), *words_of(words)],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )

    def end(self, process, wait):
        """Its exit code. If it has not ended after `wait` seconds, kills it or its whole group."""
        try:
            process.communicate(timeout=wait)
        except subprocess.TimeoutExpired:
            process.kill() if self.chance.random() < 0.5 else os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
        return process.returncode

    @staticmethod
    def records(command, folder):
        """The file to which lines are appended."""
        return folder / ("steps.jsonl" if command == "paper" else "new.jsonl")

    @staticmethod
    def answers(path):
        """Values that every run must record equally, with their counts."""
        lines = [json.loads(line) for line in whole_lines(path)]
        return collections.Counter(
            json.dumps(
                [line.get(name) for name in ("key", "kind", "step", "exit", "status", "asked", "agreement")]
                + [line["work"]["candidate_pairs"] if "work" in line else None]
            )
            for line in lines
            if line.get("kind") not in ("run", "verdict")
        )

    def undisturbed(self, command):
        """(folder, seconds) of a run without a kill."""
        folder = self.work / f"{command}-whole"
        if command != "paper":
            folder.mkdir()
        begin = time.monotonic()
        process = self.start(command, folder)
        errors = process.communicate()[1]
        self.assertEqual(process.returncode, 0, errors)
        return folder, time.monotonic() - begin

    def compare(self, command, folder, whole):
        self.assertEqual(
            self.answers(self.records(command, folder)), self.answers(self.records(command, whole))
        )
        for path in (*whole.glob("*.frames"), *whole.glob("*.csv")):
            self.assertEqual((folder / path.name).read_bytes(), path.read_bytes(), path.name)
        self.assertEqual([path.name for path in folder.glob("*.unfinished")], [])

    def kill(self, command):
        """Resumes after every kill, and restarts after every finished run."""
        whole, seconds = self.undisturbed(command)
        done = 0
        while self.counts[command] < KILLS or done == 0:
            folder = self.work / f"{command}-{done}"
            if command != "paper":
                folder.mkdir(exist_ok=True)
            before = whole_lines(self.records(command, folder))
            # After the last kill the run may end, as for a user who resumes.
            code = self.end(
                self.start(command, folder),
                self.chance.uniform(0, seconds) if self.counts[command] < KILLS else 120,
            )
            after = whole_lines(self.records(command, folder))
            self.assertEqual(after[: len(before)], before, "a record is gone")
            for line in after[len(before) :]:
                json.loads(line)
            self.assertIn(code, (0, -signal.SIGKILL))
            if code == 0:
                self.compare(command, folder, whole)
                shutil.rmtree(folder)
                done += 1
            else:
                self.counts[command] += 1
        self.clear.add(command)

    def test_run(self):
        self.kill("run")

    def test_plan(self):
        self.kill("plan")

    def test_simulate(self):
        self.kill("simulate")

    def test_paper(self):
        self.kill("paper")
