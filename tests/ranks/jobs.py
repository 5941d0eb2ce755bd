# SPDX-License-Identifier: MIT
# test: cost=10 processors=2 needs=TANDEM_HAS_MPI
"""Plans under an MPI launcher, whose ranks measure each cell together, and other
commands under it."""

import json
import os
import re

from tests.program import PROGRAM, SMALL, Case, ran, right_cells, tandem, words_of

SCENES = ["plates:count=2", "pile:bodies=2,frames=3"]
CAPACITIES = {
    name: capacity for name, capacity in SMALL.items() if name in ("pair_capacity", "contact_capacity")
}
PLAN = {
    "plan": "two walks",
    "scenes": SCENES,
    "frames": 0,
    "algorithms": ["chunked", "tiled"],
    "devices": ["host"],
    "settings": {"k": [8, 18], **CAPACITIES},
    "measure": {"repeat": 2, "truth": "none", "no-count": True},
}
CORES = sorted(os.sched_getaffinity(0))
ENVIRONMENT = {
    **os.environ,
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "POCL_EXTRA_BUILD_FLAGS": "-cl-opt-disable",
}


def on_core(number):
    """Each rank measures on its own core."""
    return ("taskset", "-c", str(CORES[number % len(CORES)]))


def job(*ranks):
    """The words of a job with one rank for each of these command beginnings, each followed by the words of
    `run`."""

    def words(*arguments):
        line = ["mpirun", "--oversubscribe", "--bind-to", "none"]
        for number, beginning in enumerate(ranks):
            line += (
                [":"] * (number > 0)
                + ["-n", "1", *beginning]
                + ([] if str(PROGRAM) in beginning[-1:] else [str(PROGRAM)])
                + words_of(arguments)
            )
        return line

    return words


def of(count):
    return job(*(on_core(number) for number in range(count)))


def own_lines(text):
    """The program's own lines of standard error."""
    return [line for line in text.splitlines() if line.startswith("tandem: ")]


def launch(words):
    """A job that ends by itself; mpirun does not wait for other ranks when an exit code is not 0."""
    environment = {**ENVIRONMENT, "OMPI_MCA_odls_base_sigkill_timeout": "0"}
    done = ran(words, env=environment)
    return done.returncode, done.stdout, own_lines(done.stderr)


class RanksCase(Case):
    def plan(self, **fields):
        path = self.work / "plan.json"
        path.write_text(
            json.dumps({name: value for name, value in {**PLAN, **fields}.items() if value is not None})
        )
        return path


class Plans(RanksCase):
    def test_each_cell_is_measured_by_all_ranks(self):
        alone, shared = self.work / "alone.jsonl", self.work / "shared.jsonl"
        self.assertEqual(tandem("run", self.plan(), "--out", alone)[0], 0)
        status, text, errors = launch(of(2)("run", self.plan(), "--out", shared))
        self.assertEqual((status, errors), (0, []), text)
        self.assertEqual((text.count("8 records appended"), right_cells(text)), (1, 8))
        cell = lambda record: (record["scene"]["key"], record["algorithm"], record["settings"]["k"])
        expected = {cell(record): record for record in self.records(alone)}
        found = {cell(record): record for record in self.records(shared)}
        self.assertEqual((set(found), len(found)), (set(expected), 8))
        for which, record in found.items():
            self.assertEqual(record["ranks"], 2)
            for part in ("candidate_pairs", "contacts", "digest", "contact_digest"):
                self.assertEqual(record["work"][part], expected[which]["work"][part], part)
        status, text, errors = launch(of(2)("run", self.plan(), "--out", shared, "--resume"))
        self.assertEqual((status, errors), (0, []), text)
        self.assertIn(f"8 cells are already in {shared}", text)

    def test_ranks_bound_paths(self):
        """With motion=linear ghosts are bodies that could be met on the path to the next frame."""
        alone, shared = self.work / "paths-alone.jsonl", self.work / "paths.jsonl"
        words = (
            "run",
            SCENES[0],
            "--frames 0:1 --device host --algorithm tiled,gproximity --set motion=linear "
            "--set decision=exact --repeat 2 --out",
        )
        self.assertEqual(tandem(*words, alone)[0], 0)
        status, text, errors = launch(of(2)(*words, shared))
        self.assertEqual((status, errors, right_cells(text)), (0, [], 2), text)
        answers = lambda path: {
            r["algorithm"]: [
                r["work"][part] for part in ("candidate_pairs", "contacts", "digest", "contact_digest")
            ]
            for r in self.records(path)
        }
        self.assertEqual(answers(shared), answers(alone))
        self.assertGreater(answers(alone)["tiled"][0][0], 0)

    def test_ranks_measure_one_shard_together(self):
        out = self.work / "shard.jsonl"
        self.assertEqual(launch(of(2)("run", self.plan(), "--shard", "1/2", "--out", out))[0], 0)
        self.assertEqual({record["scene"]["name"] for record in self.records(out)}, {"pile"})


class Refusals(RanksCase):
    def one_line(self, words, expected, code=2):
        status, text, errors = launch(words)
        self.assertEqual((status, len(errors)), (code, 1), (text, errors))
        self.assertIn(expected, errors[0])
        return text

    def test_different_command_lines_and_programs(self):
        line = of(2)("run", self.plan(), "--dry-run")
        line[-1] = "--quiet"
        self.one_line(line, "rank 1 has another command line than rank 0: run ")
        other = self.work / "other"
        alone = self.work / "sources.jsonl"
        tandem("run", SCENES[0], f"--device host --frames 0 --truth none --algorithm tiled --out {alone}")
        digest = self.records(alone)[0]["environment"]["sources"].encode()
        text = PROGRAM.read_bytes()
        self.assertTrue(digest[:8] in text)  # a compiler may store it in two halves
        other.write_bytes(text.replace(digest[:8], b"01234567"))
        other.chmod(0o755)
        ranks = f"-n 1 {PROGRAM} algorithms : -n 1 {other} algorithms"
        words = ["mpirun", "--oversubscribe", *ranks.split()]
        self.one_line(words, "rank 1 runs a program built from other sources than rank 0")

    def test_what_ranks_cannot_do_together(self):
        self.one_line(
            of(2)("run", self.plan(devices=["host", "opencl:0"])),
            "host, opencl:0 are devices of several cells",
        )
        self.one_line(
            of(2)("run", self.plan(), "--isolate"), "--isolate runs each cell in a process of its own"
        )
        self.one_line(of(2)("run", self.plan(scenes="plate")), "unknown scene 'plate'")

    def test_other_commands(self):
        status, text, errors = launch(of(2)("--version"))
        self.assertEqual((status, text.count("with MPI"), errors), (0, 1, []))
        self.assertEqual(launch(of(2)("run", "--help"))[1].count("--shard"), 1)
        text = self.one_line(of(2)("algorithms"), "algorithms runs on one rank; the other waits", 0)
        self.assertEqual(len(re.findall("(?m)^chunked", text)), 1, text)
        words = of(4)(f"check {SCENES[0]} --device host --algorithm tiled --frames 0 --set k=8,99")
        status, text, errors = launch(words)
        self.assertEqual(status, 2, errors)
        self.assertEqual((len(errors), errors[0]), (2, "tandem: check runs on one rank; the other 3 wait"))

    def test_tasks_of_slurm_that_are_no_ranks(self):
        """srun without --mpi passes no rank information to its tasks: the first task explains this, and each one
        measures."""
        of_one = [SCENES[0], "--device host --frames 0 --truth none --algorithm tiled --no-check"]
        for number, line_count in (("0", 1), ("1", 0)):
            status, _, errors = tandem(
                "run", *of_one, environment={"SLURM_STEP_NUM_TASKS": "2", "SLURM_PROCID": number}
            )
            self.assertEqual((status, len(errors)), (0, line_count), errors)
            self.assertTrue(all("srun started 2 independent tasks" in line for line in errors), errors)
        self.assertEqual(
            tandem("run", *of_one, environment={"SLURM_STEP_NUM_TASKS": "1", "SLURM_PROCID": "0"})[2], []
        )
        self.assertEqual(
            tandem("algorithms", environment={"SLURM_STEP_NUM_TASKS": "2", "SLURM_PROCID": "0"})[2], []
        )
        self.assertEqual(
            tandem(
                "run", *of_one, "--shard 0/2", environment={"SLURM_STEP_NUM_TASKS": "2", "SLURM_PROCID": "0"}
            )[2],
            [],
        )
