# SPDX-License-Identifier: MIT
# test: cost=15 full=50
"""tandem paper: steps are listed, run once, resumed and repeated; a failing
step is reported and does not stop the others. The committed tables and verdicts equal those of the committed
records; in the long form, every committed file is drawn again. Bad use gives one line."""

import csv
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

os.environ.setdefault("MPLCONFIGDIR", tempfile.gettempdir())
from tests.program import LONG, PROGRAM, SOURCE
from tests.validate_records import problems_of_record

from tandem.commands import paper as command
from tandem.paper import claims, page
from tandem.paper.folder import Folder
from tandem.paper.measuring import chosen, steps_of
from tandem.sequences.needs import Machine

COMMITTED = SOURCE / "results/h200/paper"
FILES = [
    "index.html",
    "claims.csv",
    *(f"table{i}.csv" for i in range(1, 8)),
    *(f"figure{i}.{kind}" for i in range(1, 15) for kind in ("svg", "csv")),
]


def paper(*words, code=0):
    done = subprocess.run([PROGRAM, "paper", *map(str, words)], capture_output=True, text=True)
    assert done.returncode == code, (done.returncode, done.stdout, done.stderr)
    return done


class Paper(unittest.TestCase):
    def setUp(self):
        self.work = tempfile.TemporaryDirectory(prefix="tandem-paper")
        self.addCleanup(self.work.cleanup)
        self.folder = pathlib.Path(self.work.name) / "out"
        self.host = ("--device", "host", "-o", self.folder)

    def steps(self):
        return [json.loads(line) for line in (self.folder / "steps.jsonl").read_text().splitlines()]

    def number(self, name, size="small"):
        lines = paper("--dry-run", "--size", size, *self.host).stdout.splitlines()
        return next(line.split()[0] for line in lines if line.split()[1] == name)

    def test_every_table_and_figure_has_a_step(self):
        for size in ("small", "full"):
            listed = paper("--dry-run", "--size", size, "--device", "host", "-o", self.folder / size).stdout
            for scene in ("funnel", "glasses", "colosseum", "plates", "tower"):
                self.assertIn(f"cells-{scene}", listed)
            self.assertIn("left", listed.splitlines()[-1])
            self.assertFalse((self.folder / size).exists())
            self.assertLessEqual(max(step.seconds for step in steps_of(size, "host")), 480)

    def test_simulations_with_a_preset_run(self):
        """Steps of full that no test runs as a whole: one time step of each."""
        found = [step for step in steps_of("full", "host") if "--preset" in step.command]
        found = [step for step in found if step.command[1] == "simulate"]
        self.assertEqual(len(found), 2)
        (self.folder / "records").mkdir(parents=True)
        for step in found:
            words = [PROGRAM, *step.command[1:]]
            words[words.index("--steps") + 1] = "1"
            done = subprocess.run(words, cwd=self.folder, capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""), step.name)

    def test_steps_by_what_they_show(self):
        """Tables, figures and names bring the steps that make their recordings; numbers do not."""
        steps = steps_of("small", "host")
        names = lambda text: [steps[number].name for number in chosen(text, steps)]
        self.assertEqual(names("figure13"), ["solver-glasses", "thresholds"])
        self.assertEqual(names("precision,table2"), ["ceilings", "solver-glasses", "precision"])
        self.assertEqual(names(self.number("thresholds")), ["thresholds"])
        self.assertEqual(names("1:2,1"), ["ceilings", "solver-funnel"])
        self.assertEqual(len(names("")), len(steps))
        for number in (
            *(f"table{i}" for i in range(1, 8)),
            *(f"figure{i}" for i in (1, 2, 3, 4, 5, 6, 9, 10, 11, 12, 13)),
        ):
            self.assertTrue(names(number), number)

    def test_bad_use_is_one_line(self):
        other = pathlib.Path(self.work.name)
        (other / "steps.jsonl").write_text("no JSON\n")
        for words, says in (
            ((), "--output"),
            (("-o", self.folder, "--size", "huge"), "--size huge: give small or full"),
            (("-o", self.folder, "--device", "cuda:99"), "cuda:99"),
            ((*self.host, "--steps", "0:3"), "--steps 0:3"),
            ((*self.host, "--steps", "3:1"), "--steps 3:1"),
            ((*self.host, "--steps", "x"), "--steps x"),
            ((*self.host, "--steps", "1:999"), "give N or FIRST:LAST"),
            ((*self.host, "--steps", "1,figure99"), "figure99 is no step"),
            (("-o", self.folder, "--draw-only", "--again"), "--again"),
            (("-o", self.folder / "none", "--draw-only"), "steps.jsonl"),
            (
                ("-o", other, "--device", "host", "--dry-run"),
                "steps.jsonl:1: is not a line of 'tandem paper'",
            ),
        ):
            error = paper(*words, code=2).stderr
            self.assertEqual(error.count("\n"), 1, error)
            self.assertIn(says, error)

    def test_steps_run_once_and_again_on_request(self):
        step = self.number("chunks-morton")
        paper(*self.host, "--steps", step, "--measure-only")
        first = self.steps()
        self.assertEqual([(s["step"], s["exit"]) for s in first], [("chunks-morton", 0)])
        with open(self.folder / "chunks-morton.csv", newline="") as file:
            self.assertGreater(len(list(csv.DictReader(file))), 1000)
        paper(*self.host, "--steps", step, "--measure-only")
        self.assertEqual(self.steps(), first)
        paper(*self.host, "--steps", step, "--measure-only", "--again")
        self.assertEqual(len(self.steps()), 2)
        self.assertIn(
            "has results of size small on host",
            paper(*self.host, "--size", "full", "--dry-run", code=2).stderr,
        )
        # Without --device it measures on the program's default.
        is_host = Machine(str(PROGRAM), self.folder).default == "host"
        paper("-o", self.folder, "--dry-run", code=0 if is_host else 2)

    def test_measuring_needs_the_standard_library_only(self):
        step = self.number("chunks-morton")
        done = subprocess.run(
            [
                "/usr/bin/python3",
                "-S",
                "-I",
                PROGRAM.parent / "libexec/tandem/paper",
                "-o",
                self.folder,
                "--device",
                "host",
                "--steps",
                step,
                "--measure-only",
            ],
            capture_output=True,
            text=True,
            env={"TANDEM_PROGRAM": str(PROGRAM)},
        )
        self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
        self.assertEqual([s["exit"] for s in self.steps()], [0])

    def test_a_failing_step_is_reported_and_stops_no_other(self):
        first = self.number("glb-tower")  # needs a recording that does not exist
        last = int(first) + 1
        error = paper(*self.host, "--steps", f"{first}:{last}", code=3).stderr
        self.assertIn(
            "step glb-tower did not run: tower.frames is missing; step solver-tower makes it", error
        )
        self.assertEqual([s["exit"] for s in self.steps()], [3, 0])
        self.assertEqual([error for step in self.steps() for error in problems_of_record(step, "paper")], [])
        for name in FILES:
            self.assertTrue((self.folder / name).stat().st_size > 0, name)
        page = (self.folder / "index.html").read_text()
        self.assertIn("Step glb-tower ended with 3: Figure 6: tower. tower.frames is missing", page)
        self.assertIn("plates", (self.folder / "figure6.csv").read_text())
        self.assertIn("missing", (self.folder / "figure7.csv").read_text())

    def equal_files(self, names):
        for name in names:
            self.assertEqual((self.folder / name).read_text(), (COMMITTED / name).read_text(), name)

    def test_committed_tables_and_verdicts_equal_the_records(self):
        self.folder.mkdir()
        for table in command.all_tables(Folder(COMMITTED)):
            table.write(self.folder)
        command.write_claims(self.folder, claims.all_claims(Folder(COMMITTED)))
        self.equal_files([*(f"table{i}.csv" for i in range(1, 8)), "claims.csv"])

    def test_markup_is_escaped(self):
        shutil.copytree(COMMITTED, self.folder, ignore=shutil.ignore_patterns("records", "*.svg", "*.png"))
        steps = self.steps()
        steps[0]["says"], steps[0]["command"], steps[0]["exit"] = (
            "<img src=x onerror=alert(1)>",
            "tandem </code><script>",
            3,
        )
        (self.folder / "steps.jsonl").write_text("".join(json.dumps(step) + "\n" for step in steps))
        folder = Folder(self.folder)
        page.write(folder, [], [], claims.all_claims(folder))
        text = (self.folder / "index.html").read_text()
        self.assertNotIn("<img src=x", text)
        self.assertEqual(text.count("<script"), 1, "its own")
        self.assertIn("&lt;img src=x", text)

    @unittest.skipUnless(LONG, "draws every figure")
    def test_committed_files_are_drawn_again_byte_for_byte(self):
        shutil.copytree(COMMITTED, self.folder)
        for name in FILES:
            (self.folder / name).unlink()
        self.assertIn("7 tables", paper("-o", self.folder, "--draw-only").stdout)
        self.equal_files(name for name in FILES if not name.endswith(".svg"))
