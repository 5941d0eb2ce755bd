# SPDX-License-Identifier: MIT
# test: cost=20 full=50 processors=2 needs=TANDEM_HAS_MPI
"""Scenes whose frames are distributed over the ranks of an MPI job."""

import json
import os
import pathlib
import re
import signal
import subprocess
import time

from tests.program import BUILT, LONG, PROGRAM, SMALL, STUBS, Case, ran, sets, tandem
from tests.ranks.jobs import ENVIRONMENT, job, launch, of, own_lines

PILE = "pile:bodies=27,mesh=grain1,frames=2"
CAPACITIES = sets({name: SMALL[name] for name in ("pair_capacity", "contact_capacity", "tile_pair_capacity")})
WORK = (
    "body_pairs candidate_pairs contacts digest contact_digest without_boundary rejected".split()
)  # of a frame, equal on any number of ranks
SKEWED_CLOCKS = BUILT / "libskewed_clocks.so"
CELL = ["--device", "host", "--algorithm", "tiled", *CAPACITIES]


def ranks_of(launcher):
    """Processes of the ranks of that mpirun."""
    found = []
    for path in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            stat = (path / "stat").read_text().rsplit(")", 1)[1].split()
            words = (path / "cmdline").read_bytes().split(b"\0")
        except (FileNotFoundError, ProcessLookupError):
            continue
        if stat[0] not in "ZX" and int(stat[1]) == launcher and words[0] == str(PROGRAM).encode():
            found.append(int(path.name))
    return sorted(found)


def wait_for(what):
    """Waits without a limit of its own: that of the whole test ends it."""
    while not (result := what()):
        time.sleep(0.002)
    return result


class RankScenes(Case):
    def one_line(self, expected, *arguments, ranks=2, code=2):
        status, text, errors = launch(of(ranks)("run", *arguments))
        self.assertEqual((status, len(errors)), (code, 1), (text, errors))
        self.assertIn(expected, errors[0])
        self.assertNotIn("ms/frame", text)

    def test_answers_and_records_equal_one_process(self):
        common = ["--repeat", 1, "--truth", "pairs", PILE, *CELL]
        self.output(
            "run",
            *common,
            f"--out {self.work}/one.jsonl --dump-pairs {self.work}/one.csv "
            f"--dump-contacts {self.work}/one-contacts.csv",
        )
        (one,) = self.records(self.work / "one.jsonl")
        for ranks in (2, 4):
            name = f"{ranks}.jsonl"
            files = f"--dump-pairs {self.work}/all.csv --dump-contacts {self.work}/all-contacts.csv"
            status, text, errors = launch(of(ranks)("run", *common, f"--out {self.work}/{name} {files}"))
            self.assertEqual((status, errors), (0, []), text)
            (record,) = self.records(self.work / name)
            for field in ("status", "agreement", "error", "scene", "frames", "algorithm"):
                self.assertEqual(record[field], one[field], field)
            for field in WORK:
                self.assertEqual(record["work"][field], one["work"][field], field)
            self.assertEqual((record["ranks"], len(record["devices"])), (ranks, ranks))
            device_work = record["partition"]["devices"]
            self.assertEqual(len(device_work), ranks)
            self.assertEqual(
                [sum(pairs) for pairs in zip(*(work["candidate_pairs"] for work in device_work))],
                one["work"]["candidate_pairs"],
            )
            self.assertGreater(sum(work["exchange"]["bytes"] for work in device_work), 0)
            self.assertIn("exchange", record["stages"])
            self.assertNotEqual(record["key"], one["key"])
            for kind in ("", "-contacts"):
                self.assertEqual(
                    (self.work / f"all{kind}.csv").read_text(), (self.work / f"one{kind}.csv").read_text()
                )
            self.assertRegex(text, rf"rank {ranks - 1}, host")

    def test_contacts_without_interior_tetrahedra_equal_one_process(self):
        out = self.work / "interior.jsonl"
        common = (
            f"run plates --frames 0:1 --repeat 1 --device host --algorithm tiled --truth none --out {out}",
        )
        self.assertEqual(tandem(*common)[0], 0)
        status, text, errors = launch(of(2)(*common, "--set", "output=contacts"))
        self.assertEqual((status, errors), (0, []), text)
        one, two = (record["work"] for record in self.records(out))
        self.assertEqual((one["contacts"], one["contact_digest"]), (two["contacts"], two["contact_digest"]))
        self.assertLess(two["walked_tetrahedra"], one["walked_tetrahedra"])
        self.assertLess(sum(two["candidate_pairs"]), sum(one["candidate_pairs"]))

    def test_contact_surfaces_and_wrenches_equal_one_process(self):
        common = [f"run {PILE},refine=1 --pressure 1e6", *CELL, "--truth none --set order=canonical"]
        for settings in (
            "--set contact_rule=pressure --dump-surfaces",
            "--set output=wrenches --dump-contacts",
        ):
            one, two = self.work / "one", self.work / "two"
            self.output(*common, f"{settings} {one}")
            status, text, errors = launch(of(2)(*common, f"--repeat 1 {settings} {two}"))
            self.assertEqual((status, errors), (0, []), text)
            self.assertIn("rank 1, host", text)
            self.assertGreater(len(one.read_bytes()), 1000)
            self.assertEqual(two.read_bytes(), one.read_bytes())

    def test_a_scene_of_twice_the_memory_of_a_rank(self):
        scene = ["pile:bodies=160,density=0.001,frames=1", "--repeat", 1, "--truth", "none", *CELL]
        status, _, errors = tandem("run", *scene, "--memory", 1 << 20)
        self.assertEqual(status, 3, errors)
        needed = int(re.search(r"need (\d+) bytes", errors[0])[1])
        self.assertEqual(tandem("run", *scene, "--memory", needed // 2)[0], 3)
        status, text, errors = launch(
            of(4)("run", *scene, "--memory", needed // 2, "--out", self.work / "four.jsonl")
        )
        self.assertEqual((status, errors), (0, []), text)
        self.assertIn("right: ", text)
        status, _, errors = launch(of(4)("run", *scene, "--memory", 1 << 20))
        self.assertEqual((status, len(errors)), (3, 1), errors)
        self.assertRegex(errors[0], r"rank \d: .*raise --memory")

    def test_errors_are_one_line(self):
        self.one_line("names 3 devices for 2 ranks", PILE, "--device", "host+opencl:0+opencl:1")
        self.one_line("--device all makes several cells", PILE, "--device", "all")
        self.one_line(
            "--isolate runs each cell in a process of its own", PILE, "--device", "host", "--isolate"
        )
        self.one_line(
            "choose broad=device",
            PILE,
            "--device host --algorithm tiled --set broad=tight --truth none --no-check",
        )
        self.one_line("unknown scene 'pil'", "pil", "--device", "host")
        self.one_line("frames", PILE, "--device", "host", "--frames", "5:9")

    def test_every_rank_has_a_gpu(self):
        """All visibilities that launchers set: all GPUs to every rank, one to each (srun --gpus-per-task=1), one to
        both."""
        stubs = {
            "LD_LIBRARY_PATH": str(STUBS / "driver"),
            "TANDEM_NVRTC": str(STUBS / "nvrtc/libnvrtc.so"),
            "TANDEM_CUPTI": "",
            "STUB_DEVICES": "2",
        }
        stubs = ["env", *(f"{name}={value}" for name, value in stubs.items())]
        common = [f"run {PILE} --repeat 1 --truth none --no-check --algorithm tiled --device"]
        for shown, asked, expected in (
            (("0,1", "0,1"), "cuda:0+cuda:1", "cuda:1"),
            (("0,1", "0,1"), "cuda:each", "cuda:1"),
            (("0", "1"), "cuda:0", "cuda:0"),
            (("1", "0"), "cuda:0", "cuda:0"),
        ):
            status, text, errors = launch(
                job(*([*stubs, f"CUDA_VISIBLE_DEVICES={which}"] for which in shown))(*common, asked)
            )
            self.assertEqual((status, errors), (0, []), text)
            self.assertIn(f"rank 1, {expected}", text)
        for shown, asked, expected in (
            (("0,1", "0,1"), "cuda:0", "ranks 0 and 1 share one GPU, GPU-"),
            (("1", "1"), "cuda:0", "ranks 0 and 1 share one GPU, GPU-"),
            (("0", "1"), "cuda:0+cuda:1", "rank 1: unknown device 'cuda:1'"),
        ):
            status, text, errors = launch(
                job(*([*stubs, f"CUDA_VISIBLE_DEVICES={which}"] for which in shown))(*common, asked)
            )
            self.assertEqual((status, len(errors)), (2, 1), (text, errors))
            self.assertIn(expected, errors[0])

    def test_ranks_decide_together_with_different_clocks(self):
        """Each rank's clock has its own pace and sleeps at random; rank 0 decides everything that depends on
        clocks."""
        common = [
            f"run {PILE} --algorithm chunked,tiled --device host",
            *CAPACITIES,
            "--truth none --seconds 0.8 --noise 1e-09",
        ]
        digests = set()
        for seed in range(20 if LONG else 3):
            ranks, out = (2, 4)[seed % 2], self.work / f"skewed{seed}.jsonl"
            skew = ["env", f"LD_PRELOAD={SKEWED_CLOCKS}", f"SKEW_SEED={seed}"]
            status, text, errors = launch(job(*([skew] * ranks))(*common, "--out", out))
            self.assertEqual((status, errors), (0, []), text)
            records = self.records(out)
            self.assertEqual(sorted(record["algorithm"] for record in records), ["chunked", "tiled"])
            digests |= {json.dumps(record["work"]["digest"]) for record in records}
            for record in records:
                self.assertGreaterEqual(len(set(record["total_ns"]["rounds"])), 10)
        self.assertEqual(len(digests), 1)

    def test_auto_chooses_together(self):
        cell = [
            f"run {PILE} --device host --algorithm auto",
            *CAPACITIES,
            "--repeat 1 --truth none --choose-seconds 0.5",
        ]
        (self.work / "choices").mkdir(mode=0o700)
        for ranks, expected in (
            (2, r" of replays \(at most 0\.5\)"),
            (4, r" of replays \(at most 0\.5\)"),
            (2, r", stored in .*choices"),
        ):
            with self.subTest(ranks=ranks, expected=expected):
                out = self.work / f"auto{ranks}.jsonl"
                skew = [f"LD_PRELOAD={SKEWED_CLOCKS}", f"SKEW_SEED={ranks}"]
                words = ["env", f"XDG_CACHE_HOME={self.work / 'choices'}", *skew]
                done = ran(job(*([words] * ranks))(*cell, "--out", out), env=ENVIRONMENT)
                choices = [line for line in done.stderr.splitlines() if line.startswith("auto: ")]
                self.assertEqual(
                    (done.returncode, own_lines(done.stderr), len(choices)), (0, [], 1), done.stderr
                )
                self.assertRegex(choices[0], expected)
                record = self.records(out)[-1]
                self.assertEqual(
                    (record["status"], record["chosen"]["by"], record["ranks"]), ("ok", "auto", ranks)
                )
                self.assertEqual(record["chosen"]["from_cache"], "stored" in expected)
                self.assertGreater(
                    sum(one["median_ns"] is not None for one in record["chosen"]["candidates"]), 2
                )

    def test_a_killed_rank_ends_the_job_and_keeps_records_whole(self):
        out = self.work / "killed.jsonl"
        words = of(2)(f"run {PILE} plates", *CELL, f"--seconds 100000 --noise 1e-9 --truth none --out {out}")
        pipes = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
        process = subprocess.Popen(words, **pipes, text=True, env=ENVIRONMENT)
        wait_for(lambda: len(ranks_of(process.pid)) == 2)
        wait_for(
            pathlib.Path(f"{out}.unfinished").exists
        )  # measuring has begun: mpirun knows all of its processes
        os.kill(ranks_of(process.pid)[1], signal.SIGKILL)
        text = process.communicate()[1]  # long before the cell has its samples
        self.assertNotEqual(process.returncode, 0)
        self.assertRegex(text, r"rank 1\b.*\bsignal 9")
        if out.exists():
            self.records(out)  # all existing records are complete and valid
