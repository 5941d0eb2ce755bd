# SPDX-License-Identifier: MIT
# test: cost=20 full=2000
"""Every call to the C library fails in turn, one per run: malloc (once, or all later
large ones too), open, write, fsync, rename, ftruncate and pthread_create, in every command that records. The
program must end with a documented code and one line that gives the reason; earlier records stay complete.
preload.cpp makes calls fail."""

import collections
import concurrent.futures
import json
import os
import re
import shutil
import subprocess

from tests import pace
from tests.program import BUILT, LONG, PROGRAM, Case, messages, ran, sets, tandem, tried, words_of, write_json

PRELOAD = str(BUILT / "libtandem_faults.so")
CALLS = {family: family for family in ("open", "write", "fsync", "rename")}
CALLS |= {"truncate": "ftruncate", "thread": "pthread_create", "large": "every large malloc from the N-th on"}
CALLS |= {"malloc": "malloc"}
FAMILIES = tuple(CALLS)
FEW = {name: 4096 for name in ("pair_capacity", "contact_capacity", "tile_pair_capacity")}
CELLS = ("plan", "check", "accuracy")  # commands with several cells
LIBRARYS_WORDS = r"std::|::at\b|basic_string|bad_alloc|json\.exception|vector::"
SHORT = 5  # runs per command and family in the short form, except malloc
SHORT_MALLOC = 10
HANGS = 60  # seconds of its own processor time until a run counts as hung
OURS = PROGRAM.name
# Message of glibc before it aborts because a thread's first object with a destructor finds no memory.
NO_MEMORY_FOR_THREADS = "Fatal glibc error: failed to register TLS destructor: out of memory"
Outcome = collections.namedtuple("Outcome", "code signal errors owner hung stack")


def functions(stack):
    """Names of the program's functions in the lines of a stack, the innermost first."""
    places = [
        match[1]
        for line in stack
        if (match := re.search(re.escape(OURS) + r"\([^)]*\+(0x[0-9a-f]+)\)", line))
    ]
    if not places:
        return []
    names = ran(["addr2line", "-Cfe", str(PROGRAM), *places]).stdout.splitlines()[::2]
    return [re.sub(r"nlohmann::json_abi\w+::|std::__cxx11::|\[abi:\w+\]", "", name)[:90] for name in names]


class Sweep(Case):
    counts = collections.Counter()
    lost_by = collections.defaultdict(collections.Counter)  # by family and library
    swept, wanted = set(), {"run", "plan", "check", "accuracy", "simulate", "export"}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.old = cls.work / "old.jsonl"
        assert (
            tandem(f"run {cls.twice} --device host --set k=8 --repeat 1 --truth none --out {cls.old}")[0] == 0
        )
        cls.plan = cls.work / "cells.json"
        write_json(
            cls.plan,
            plan="two cells",
            scenes="pile:bodies=2,frames=1",
            devices="host",
            algorithms=["tiled"],
            settings={"k": [6, 8], **FEW},
            measure={"repeat": 1, "truth": "none"},
        )

    @classmethod
    def tearDownClass(cls):
        counts = ", ".join(f"{cls.counts[family]} of {family}" for family in FAMILIES if cls.counts[family])
        print(
            f"faults injected: {counts}; ended by a signal in other people's libraries: {dict(sum(cls.lost_by.values(), collections.Counter())) or 'none'}"
        )
        # Without a failed test, all of them were checked; otherwise no line is added.
        if cls.swept == cls.wanted:
            for family in FAMILIES:
                lost = sum(cls.lost_by[family].values())
                tried(f"calls that fail: {CALLS[family]}", cls.counts[family], "runs", rest=lost)
        super().tearDownClass()

    def commands(self, folder):
        """By name of the command: words, and the file of records that it appends to, or None. Everything is written
        to the folder."""
        out = folder / "old.jsonl"
        cell = f"{self.twice} --device host --set k=8"
        tiled = ["--algorithm tiled", *sets(FEW)]
        few_seeds = sets({name: 4096 for name in ("pair_capacity", "contact_capacity", "seed_capacity")})
        contacts = "--set contact_rule=sat --set decision=fp32 --set precision=float --set rounding=safe"
        run = f"--repeat 1 --truth contacts --out {out} --dump-pairs {folder}/pairs.csv --trace {folder}/trace.json"
        simulate = (
            f"simulate arch:segments=2 --steps 2 --device host -o {folder}/a.frames --record {out} --quiet "
            "--dynamics absolute_tolerance=1"
        )
        export = (
            f"export pile:bodies=2,frames=2 --frames 0:1 --vtu {folder}/vtu --glb {folder}/a.glb "
            f"--geometry {folder}/g.json --chunks {folder}/c.csv"
        )
        return {
            "run": ((f"run {cell}", *tiled, run), out),
            "plan": (("run", self.plan, "--out", out), out),
            "check": ((f"check {cell} --algorithm chunked --preset grouped,published", *few_seeds), None),
            "accuracy": ((f"accuracy {cell} {contacts}", *tiled, f"--repeat 1 --out {out}"), out),
            "simulate": ((simulate,), out),
            "export": ((export,), None),
        }

    def fault(self, command, family, at, number):
        """One run in a separate folder in which call `number` of a family fails; 0: no call fails, and calls are
        listed."""
        folder = self.work / f"{command}-{family}-{number}"
        folder.mkdir()
        shutil.copy(self.old, folder)
        log = folder / "log"
        words, _ = self.commands(folder)[command]
        environment = {
            **os.environ,
            "LD_PRELOAD": PRELOAD,
            "FAULTS_CALL": family,
            "FAULTS_AT": str(at),
            "FAULTS_LOG": str(log),
            "TANDEM_KERNEL_CACHE": str(folder / "cache"),
        }
        running = subprocess.Popen(
            [str(PROGRAM), *words_of(words)],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            env=environment,
        )
        hung = False
        try:
            errors = messages(pace.communicate(running, HANGS)[1])
        except pace.Hung:
            hung, errors = True, []
        text = log.read_text().splitlines() if log.exists() else []
        lines = [line.split() for line in text if line.startswith(family)]
        stack = [line for line in text if not line.startswith(family)]
        owner = next((line[2] for line in lines if len(line) == 4), None)
        return (
            folder,
            lines,
            Outcome(running.returncode, running.returncode < 0 and not hung, errors, owner, hung, stack),
        )

    def places(self, command, family):
        """Numbers of the calls to fail: every one; for malloc the first 500 and the first of every site in the
        program. In the short form a selection of them."""
        folder, lines, outcome = self.fault(command, family, 0, "list")
        self.assertEqual((outcome.code, outcome.errors), (0, []), (command, family))
        total = int(lines[-1][2])
        if family != "malloc":
            every = range(1, total + 1)
            return list(every) if LONG else list(every)[:: max(1, -(-total // SHORT))]
        firsts = [int(line[1]) for line in lines[:-1] if line[2] == OURS]
        self.assertGreater(len(firsts), 100, "places in the program that take memory")
        return (
            sorted({*range(1, min(total, 500) + 1), *firsts})
            if LONG
            else firsts[:: -(-len(firsts) // SHORT_MALLOC)]
        )

    def judge(self, command, family, at, folder, outcome):
        where = f"{command}: call {at} of {family}, of {outcome.owner}: {outcome.errors}\n  " + "\n  ".join(
            functions(outcome.stack)
        )
        self.assertFalse(outcome.hung, where)
        old = self.old.read_bytes()
        kept = (folder / "old.jsonl").read_bytes()
        self.assertTrue(kept.startswith(old), f"{where}: a record is gone")
        for line in kept.decode().split("\n")[:-1]:
            json.loads(line)
        owner = "glibc" if outcome.errors[:1] == [NO_MEMORY_FOR_THREADS] else outcome.owner
        if outcome.signal and owner != OURS:
            self.lost_by[family][owner] += 1
            return
        self.assertFalse(outcome.signal, f"{where}: signal {-outcome.code}")
        self.assertIn(outcome.code, (0, 2, 3), where)
        if outcome.code != 0:
            # One line for each failed cell, at most two, or one for the command.
            self.assertIn(len(outcome.errors), (1, 2) if command in CELLS else (1,), where)
            self.assertEqual(len(set(outcome.errors)), len(outcome.errors), where)
            for line in outcome.errors:
                self.assertRegex(line, "^tandem: .{15}", where)
                self.assertNotRegex(line, LIBRARYS_WORDS, where)

    def sweep(self, command):
        for family in FAMILIES:
            numbers = self.places(command, family)
            with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as several:
                for at, (folder, _, outcome) in zip(
                    numbers, several.map(lambda at: self.fault(command, family, at, at), numbers)
                ):
                    with self.subTest(family=family, at=at):
                        self.judge(command, family, at, folder, outcome)
                    shutil.rmtree(folder)
            self.counts[family] += len(numbers)
        if self._outcome.success:
            self.swept.add(command)

    def test_run(self):
        self.sweep("run")

    def test_plan(self):
        self.sweep("plan")

    def test_check(self):
        self.sweep("check")

    def test_accuracy(self):
        self.sweep("accuracy")

    def test_simulate(self):
        self.sweep("simulate")

    def test_export(self):
        self.sweep("export")
