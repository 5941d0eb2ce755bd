# SPDX-License-Identifier: MIT
# test: cost=10
"""tandem.sequences over a program that fails, waits and writes as it is told: its journal, progress, limits and
needs; and the steps of scripts/gpu/run, whose cells the program lists."""

import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import unittest

from tests.program import PROGRAM, SOURCE, ran

sys.path.insert(0, str(SOURCE / "python"))
from tandem.sequences.needs import Machine
from tandem.sequences.step import read_steps

# `say WORDS` prints, `fail` fails unless the file "mended" exists, `wait` writes "begun" and waits, and ignores
# SIGTERM if it is told to, `simulate -o FILE` writes the file and its checkpoint.
MADE_UP = """#!/bin/bash
case $1 in
  --version) echo "tandem 1 (commit $(cat "$(dirname "$0")/commit"))" ;;
  devices) echo '[{"reason": "cuda: no driver", "devices": []},
    {"reason": null, "devices": [{"id": "host", "default": false, "driver": "none", "double": true},
     {"id": "opencl:3", "default": true, "driver": "PoCL 5", "double": false}]}]' ;;
  run) [[ "$*" == *"--algorithm walk --device host"* ]] || { echo "tandem: no such algorithm" >&2; exit 2; } ;;
  say) echo "$*" | tee -a said ;;
  fail) [ -e mended ] || { echo trying; echo "no luck" >&2; exit 1; } ;;
  wait) [ "$2" != ignoring ] || trap '' TERM; touch begun; while [ ! -e go ]; do sleep 0.02; done ;;
  simulate) echo "$*" >>said; touch "$3" "$3.checkpoint" ;;
esac
"""
CALL = f"import sys; sys.path.insert(0, {str(SOURCE / 'python')!r}); from tandem.sequences import command; "
CALL += "from tandem.sequences import runner; runner.GRACE = 0.2; sys.exit(command.main(sys.argv[1:]))"


class Sequences(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.out, self.program = self.folder / "out", self.folder / "made_up"
        self.program.write_text(MADE_UP)
        self.program.chmod(0o755)
        (self.folder / "commit").write_text("abc")

    def words(self, *words):
        options = ("-o", self.out, "--program", self.program, "--set", "word=b c")
        words = [
            "/usr/bin/python3",
            "-S",
            "-I",
            "-B",
            "-c",
            CALL,
            self.folder / "list.json",
            *options,
            *words,
        ]
        return [*map(str, words)]

    def call(self, *words, code=0):
        """The lines of standard error."""
        done = ran(self.words(*words))
        self.assertEqual(done.returncode, code, (done.stdout, done.stderr))
        return done.stderr.splitlines()

    def steps(self, **entries):
        """Writes the list: entries, or only their commands, by name."""
        entries = {
            name: {"commands": [one]} if isinstance(one, str) else one for name, one in entries.items()
        }
        steps = [{"name": name, "says": f"says {name}"} | entry for name, entry in entries.items()]
        (self.folder / "list.json").write_text(json.dumps({"steps": steps}))

    def journal(self, *names):
        lines = [json.loads(line) for line in (self.out / "steps.jsonl").read_text().splitlines()]
        return [tuple(line.get(name) for name in names) for line in lines]

    def said(self):
        return (self.out / "said").read_text().splitlines()

    def test_runs_once_and_again_on_request_or_with_another_command_or_build(self):
        self.steps(one="tandem say 1 --out made", two="tandem say 2")
        self.call("one", "two")
        lines = self.journal("step", "exit", "command", "commit", "dirty", "reason")
        self.assertEqual(lines[0], ("one", 0, "tandem say 1 --out made", "abc", False, None))
        self.assertEqual((self.out / "logs/two.txt").read_text(), "say 2\n")
        (self.out / "made").touch()
        self.assertIn("step one is done with this build; --again runs it again", self.call("one")[0])
        self.assertTrue((self.out / "made").exists())
        self.call("one", "--again")
        self.assertFalse((self.out / "made").exists())
        (self.folder / "commit").write_text("def")
        self.call("one", "two")
        self.steps(one="tandem say 3")
        self.call("one")
        self.assertEqual([words[4] for words in self.said()], [*"121123"])

    def test_a_failure_stops_no_other_and_runs_again(self):
        self.steps(one="tandem fail", two="tandem say 2", three="/no/such/program")
        errors = self.call("one", "two", code=1)
        self.assertIn(
            f"run: step one ended with 1: no luck; its output is in {self.out.resolve()}/logs", errors
        )
        self.assertEqual(self.journal("step", "exit"), [("one", 1), ("two", 0)])
        (self.out / "mended").touch()
        self.call("one", "two")
        self.assertEqual(self.journal("step", "exit")[2:], [("one", 0)])
        self.assertIn("/no/such/program: No such file or directory", self.call("three", code=127)[-1])
        self.assertEqual(self.call("none", code=2), ["run: no step none; without arguments they are listed"])
        self.assertIn(
            "run: unknown option --agai; did you mean --again?", self.call("one", "--agai", code=2)[0]
        )

    def test_progress(self):
        """Steps of known duration tell the pace, and others their mean."""
        self.steps(
            one={"seconds": 100, "commands": ["tandem say 1"]},
            two={"seconds": 400, "commands": ["tandem say 2"]},
            three={"each": {"what": ["3", "4"]}, "commands": ["tandem say {what}"]},
        )
        told = self.call("one", "two", "three")
        for line, says in zip(
            told,
            (
                r"1/4 one: says one \(about 2 min; all about 8 min and 2 steps of unknown duration\)",
                r"2/4 two: says two \(about \d+ s; all about \d+ s and 2 steps of unknown duration\)",
                r"3/4 three-1: says three \(duration unknown; all 2 steps of unknown duration\)",
                r"4/4 three-2: says three \(about \d+ s; all about \d+ s\)",
            ),
            strict=True,
        ):
            self.assertRegex(line, f"^{says}$")
        listed = ran(self.words()[:7]).stdout
        self.assertRegex(listed, r"^ +1 +one +100 s +says one\n.*\n +3 +three +unknown +says three\n$")

    def test_an_interrupt_ends_the_step_and_the_next_call_continues(self):
        self.steps(one="tandem wait", two="tandem say 2")
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            default = lambda: signal.signal(signal.SIGHUP, signal.SIG_DFL)
            running = subprocess.Popen(
                self.words("one", "two"), stderr=subprocess.PIPE, text=True, preexec_fn=default
            )
            while not (self.out / "begun").exists() and running.poll() is None:
                os.sched_yield()
            running.send_signal(number)
            self.assertIn("run: interrupted; the same command continues", running.communicate()[1])
            self.assertEqual(running.returncode, 128 + number)
            self.assertEqual(self.journal("step", "exit")[-1], ("one", 143))
            (self.out / "begun").unlink()
        (self.out / "go").touch()
        self.call("one", "two")
        self.assertEqual(self.journal("step", "exit")[3:], [("one", 0), ("two", 0)])

    def test_a_limit_ends_the_step_and_the_next_call_continues(self):
        """Also a step that ignores SIGTERM, and the processes that it started."""
        wait, reason = (
            f"bash -c '{self.program} wait ignoring; true'",
            "it ran longer than its limit of 0.3 s",
        )
        self.steps(one={"commands": [wait], "limit": 0.3}, two="tandem say 2")
        self.assertIn(f"step one ended with 124: {reason}", self.call("one", "two", code=124)[1])
        self.assertEqual(self.journal("exit", "reason"), [(124, reason), (0, None)])
        self.assertEqual(ran(["pgrep", "-f", self.program]).stdout, "")
        self.steps(one=wait)
        self.call("one", "--limit", "0.2", code=124)
        (self.out / "go").touch()
        self.call("one", "--limit", "60")

    def test_what_is_missing_is_said_and_kept(self):
        self.steps(
            gpu={"needs": ["device cuda:0"], "commands": ["tandem say 1"]},
            frames="tandem say a.frames",
            maker="tandem simulate -o a.frames",
            arrays={"needs": ["module no_such"], "optional": True, "commands": ["tandem say 2"]},
        )
        reason = "no device cuda:0; there are: host, opencl:3; cuda: no driver"
        self.assertEqual(f"run: step gpu did not run: {reason}", self.call("gpu", code=3)[1])
        self.assertEqual(self.journal("step", "exit", "reason"), [("gpu", 3, reason)])
        self.assertIn("did not run: a.frames is missing; step maker makes it", self.call("frames", code=3)[1])
        self.assertIn("Python's no_such is not installed", self.call("arrays")[1])
        self.assertFalse((self.out / "said").exists())
        self.call("maker", "frames")
        self.assertEqual(self.said(), ["simulate -o a.frames", "say a.frames"])
        machine = Machine(str(self.program), self.out)
        self.assertEqual(machine.default, "opencl:3")
        for need, reason in {
            "device host": "",
            "double host": "",
            "double cuda:0": reason,
            "double opencl:3": "the device has no double precision",
            "driver PoCL": "",
            "driver Oclgrind": "no device of Oclgrind; there are: host, opencl:3; cuda: no driver",
            "algorithm walk host": "",
            "algorithm other host": "tandem: no such algorithm",
            "program bash": "",
            "program no_such": "program no_such is missing",
            "module json": "",
            "file *.frames": "",
            "file *.no": "*.no is missing",
        }.items():
            self.assertEqual(machine.missing(need), reason)

    def test_commands(self):
        """Alternatives, names, the device of a driver, plans, and simulations that continue from a checkpoint."""
        self.steps(
            one={
                "each": {"a": ["1 2", "3"], "b": ["x", "y"]},
                "commands": ["tandem say {a} {b} {word} {none}"],
            },
            two={"group": "one", "needs": ["driver PoCL"], "commands": ["tandem say {PoCL}"]},
            three={"plan": {"plan": "{word}"}, "commands": ["tandem say 3"]},
            four="tandem simulate -o b.frames",
            five={"each": {"time": ["1", "2"]}, "commands": ["tandem say 5"]},
        )
        self.call("one", "three", "four", "five")
        said = [f"say {one} b c {{none}}" for one in ("1 2 x", "1 2 y", "3 x", "3 y")]
        said += ["say opencl:3", "say 3", "simulate -o b.frames", "say 5", "say 5"]
        self.assertEqual(self.said(), said)
        self.assertEqual(json.loads((self.out / "plans/three.json").read_text()), {"plan": "b c"})
        (self.folder / "commit").write_text("def")
        self.call("four", "one-2")
        self.call("four", "--again")
        self.assertEqual(self.said()[9:], ["simulate -o b.frames --resume", said[1], "simulate -o b.frames"])

    def test_a_journal_keeps_whole_lines(self):
        self.steps(one="tandem say 1")
        self.call("one")
        journal, whole = self.out / "steps.jsonl", (self.out / "steps.jsonl").read_text()
        journal.write_text(whole + '{"step": "half')
        self.call("one")
        self.assertEqual(
            (journal.read_text(), (self.out / "steps.jsonl.torn").read_text()), (whole, '{"step": "half\n')
        )
        journal.write_text(f"{whole}no JSON\n")
        self.assertIn("steps.jsonl:2: is not a line of a journal of steps", self.call("one", code=2)[0])


class GpuSteps(unittest.TestCase):
    def test_they_are_listed_and_the_program_knows_their_cells(self):
        """The program lists the cells with its own device in place of GPUs. Needs are of known kinds."""
        done = ran([SOURCE / "scripts/gpu/run"])
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stdout, r"(?m)^ +\d+ +tests +510 s +unit, hard and conformance tests")
        steps, machine = read_steps(SOURCE / "scripts/gpu/steps.json", {}), Machine(PROGRAM, SOURCE)
        release = [step for step in steps if step.group == "release"]
        self.assertLess(sum(step.seconds for step in release), 22 * 60)
        self.assertLess(max(step.seconds for step in release), 540)
        self.assertEqual(len({step.name for step in steps}), len(steps))
        for need in {need for step in steps for need in step.needs}:
            machine.missing(need)
        runs = [step for step in steps if step.command[:2] == ("tandem", "run")]
        runs = [step for step in runs if not step.command[2].endswith(".json")]  # a plan names its devices
        self.assertGreater(len(runs), 40)
        for step in runs:
            words = re.sub(r" --(out|memory) \S+| --resume|,cubql", "", " ".join(step.command[1:]))
            words = re.sub(r"\b(cuda|opencl):\d\S*", "host", re.sub(r"\S+\.frames", "plates", words))
            done = ran([PROGRAM, *words.split(), "--dry-run"])
            self.assertEqual(done.returncode, 0, (step.name, done.stderr))
