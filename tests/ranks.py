#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""ranks.py PROGRAM SOURCE: plans over the ranks of a job of MPI, and what the other commands do in one."""
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import time
import unittest

from program import PROGRAM, SMALL, Case, tandem

SCENES = ["plates:count=2", "pile:bodies=2,frames=3"]
ROOMS = {name: room for name, room in SMALL.items() if name in ("pair_capacity", "contact_capacity")}
PLAN = {"plan": "two walks", "scenes": SCENES, "frames": 0, "algorithms": ["chunked", "tiled"], "devices": ["host"],
        "settings": {"k": [8, 18], **ROOMS}, "measure": {"repeat": 2, "truth": "none", "no-count": True}}
CORES = sorted(os.sched_getaffinity(0))
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "POCL_EXTRA_BUILD_FLAGS": "-cl-opt-disable"}
NO_OPENCL = ("env", "OCL_ICD_VENDORS=/nonexistent/")


def on_core(number):
    """Ranks with a core of their own measure on their processor side by side."""
    return ("taskset", "-c", str(CORES[number % len(CORES)]))


def job(*ranks):
    """The words of a job of one rank for each of these beginnings of a line, all of which go on with the words of `run`."""
    def words(*arguments):
        line = ["mpirun", "--oversubscribe", "--bind-to", "none"]
        for number, beginning in enumerate(ranks):
            line += [":"] * (number > 0) + ["-n", "1", *beginning] + ([] if str(PROGRAM) in beginning[-1:] else [str(PROGRAM)]) + list(map(str, arguments))
        return line
    return words


def of(count):
    return job(*(on_core(number) for number in range(count)))


def said(text):
    """The program's own lines of standard error."""
    return [line for line in text.splitlines() if line.startswith("tandem: ")]


def launch(words, timeout=100):
    """A job that ends by itself: mpirun waits for nobody where the exit code is not 0."""
    environment = {**ENVIRONMENT, "OMPI_MCA_odls_base_sigkill_timeout": "0"}
    done = subprocess.run(words, capture_output=True, text=True, timeout=timeout, env=environment)
    return done.returncode, done.stdout, said(done.stderr)


def processes(launcher):
    """(rank processes, processes for cells) of the job of that mpirun."""
    parents = {}
    for path in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            stat = (path / "stat").read_text().rsplit(")", 1)[1].split()
            words = (path / "cmdline").read_bytes().split(b"\0")
        except (FileNotFoundError, ProcessLookupError):
            continue
        if stat[0] not in "ZX":
            parents[int(path.name)] = (int(stat[1]), words)
    ranks = [process for process, (parent, words) in parents.items() if parent == launcher and words[0] == str(PROGRAM).encode()]
    return sorted(ranks), [process for process, (parent, words) in parents.items() if parent in ranks and b"isolated" in words]


def wait_for(what, seconds=30):
    end = time.monotonic() + seconds
    while not (result := what()):
        assert time.monotonic() < end, "nothing happened"
        time.sleep(0.002)
    return result


class RanksCase(Case):
    def plan(self, **fields):
        path = self.work / "plan.json"
        path.write_text(json.dumps({name: value for name, value in {**PLAN, **fields}.items() if value is not None}))
        return path

    def start(self, words):
        process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT)
        self.addCleanup(lambda: process.poll() is None and process.kill())
        return process

    def end(self, process, timeout=100):
        out, errors = process.communicate(timeout=timeout)
        return process.returncode, out, errors

    def by_key(self, path):
        records = self.records(path)
        keys = {record["key"]: record for record in records}
        self.assertEqual(len(keys), len(records))
        return keys


class Sweeps(RanksCase):
    def test_records_are_those_of_one_process(self):
        alone = self.work / "alone.jsonl"
        done = subprocess.run([*on_core(0), str(PROGRAM), "run", str(self.plan()), "--isolate", "--out", str(alone)], capture_output=True, text=True, timeout=100)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        expected = self.by_key(alone)
        for count in (1, 2, 4):
            out = self.work / f"{count}.jsonl"
            status, text, errors = launch(of(count)("run", self.plan(), "--out", out))
            surplus = max(0, count - len(CORES))
            self.assertEqual((status, len(errors)), (0, surplus), (text, errors))
            self.assertTrue(all("has no device of its own and measures nothing" in line for line in errors), errors)
            self.assertEqual(text.count("8 records appended"), 1)
            self.assertEqual(text.count(": right: "), 8)
            self.compare(expected, self.by_key(out), count)

    def compare(self, expected, found, count):
        self.assertEqual(set(found), set(expected))
        measured_by = set()
        for key, record in found.items():
            other = expected[key]
            rank = record.pop("rank", None)
            self.assertEqual(list(record), list(other))
            for part in ("status", "failure", "settings", "scene", "frames", "devices", "agreement", "error"):
                self.assertEqual(record[part], other[part], part)
            for part in ("body_pairs", "candidate_pairs", "contacts", "digest", "submissions"):
                self.assertEqual(record["work"][part], other["work"][part], part)
            self.rounds_of_two_samples(record)
            self.assertEqual({name: value for name, value in record["environment"].items() if name != "date"},
                             {name: value for name, value in other["environment"].items() if name != "date"})
            if count == 1:
                self.assertIsNone(rank)
            else:
                self.assertEqual(rank["of"], count)
                measured_by.add(rank["number"])
        self.assertEqual(len({record["session"] for record in found.values()}), 1)
        if count > 1:
            self.assertEqual(measured_by, set(range(min(count, len(CORES)))))

    def test_what_is_compared_takes_turns_on_one_rank(self):
        out = self.work / "turns.jsonl"
        for deal, cells, more in (("compared", 2, ()), ("cells", 1, ("--deal", "cells"))):
            out.unlink(missing_ok=True)
            self.assertEqual(launch(of(2)("run", self.plan(), *more, "--out", out))[0], 0)
            ranks = {}
            for record in self.records(out):
                self.assertEqual(record["sampling"]["cells"], cells, deal)
                ranks.setdefault((record["scene"]["key"], record["settings"]["k"]), set()).add(record["rank"]["number"])
            if deal == "compared":
                self.assertEqual({len(each) for each in ranks.values()}, {1})

    def test_auto_is_chosen_where_it_is_measured(self):
        out = self.work / "auto.jsonl"
        status, text, errors = launch(of(2)("run", self.plan(algorithms="auto", scenes=SCENES[0], settings={"k": 8}), "--choose-seconds", 0.2, "--choose-afresh", "--out", out))
        self.assertEqual(status, 0, (text, errors))
        record, = self.records(out)
        self.assertEqual(record["chosen"]["by"], "auto")

    def test_a_rank_has_one_process_that_measures(self):
        """With --isolate one for each check and each round."""
        for more, least, most in ((), 1, 2), (("--isolate",), 6, 100):
            out, seen = self.work / f"processes_{most}.jsonl", set()
            process = self.start(of(2)("run", self.plan(), *more, "--out", out))
            wait_for(out.exists)  # it has looked for devices
            while process.poll() is None:
                seen |= set(processes(process.pid)[1])
                time.sleep(0.001)
            status, text, errors = self.end(process)
            self.assertEqual((status, said(errors)), (0, []), text)
            self.assertEqual(len(self.records(out)), 8)
            self.assertTrue(least <= len(seen) <= most, seen)

    def test_a_process_that_crashes_costs_its_cell(self):
        out = self.work / "crash.jsonl"
        process = self.start(of(2)("run", self.plan(), "--out", out))
        wait_for(out.exists)  # it has looked for devices
        victim = wait_for(lambda: processes(process.pid)[1])[0]
        os.kill(victim, signal.SIGSEGV)
        status, text, errors = self.end(process)
        errors = said(errors)
        self.assertEqual((status, len(errors)), (3, 1), (text, errors))
        self.assertRegex(errors[0], r"\(rank [01]\): its process ended by signal 11")
        self.assertEqual(sorted(record["status"] for record in self.records(out)), ["failed"] + ["ok"] * 7)

    def test_a_process_that_hangs_costs_its_cell(self):
        out = self.work / "hang.jsonl"
        process = self.start(of(2)("run", self.plan(scenes=SCENES[0]), "--timeout", 3, "--out", out))
        wait_for(out.exists)
        victim = wait_for(lambda: processes(process.pid)[1])[0]
        os.kill(victim, signal.SIGSTOP)
        status, text, errors = self.end(process)
        self.assertEqual((status, len(said(errors))), (3, 1), (text, errors))
        self.assertIn("its process took longer than 3 s and was ended", errors)
        self.assertEqual(sorted(record["status"] for record in self.records(out)), ["failed"] + ["ok"] * 3)

    def stopped(self, out, stop, repeat=12, is_time=lambda out: out.exists() and out.read_text().count("\n") >= 2):
        """A job of many rounds that `stop` ended once it was time, two cells recorded: its exit code, seconds to its end, errors."""
        plan = self.plan(measure={"repeat": repeat, "truth": "none", "no-count": True})
        process = self.start(of(2)("run", plan, "--deal", "cells", "--out", out))
        wait_for(lambda: is_time(out))
        ranks, _ = processes(process.pid)
        begin = time.monotonic()
        stop(process, ranks)
        status, _, errors = self.end(process, 20)
        seconds = time.monotonic() - begin
        wait_for(lambda: not any(pathlib.Path(f"/proc/{rank}").exists() for rank in ranks), 10)
        return status, seconds, errors

    def resumed(self, out):
        """What --resume makes of it."""
        before = out.read_text()
        self.assertTrue(before.endswith("\n"))
        finished = [r for r in self.records(out) if not r["sampling"]["interrupted"] and r["status"] == "ok"]
        self.assertLess(len(finished), 8)
        plan = self.plan(measure={"repeat": 3, "truth": "none", "no-count": True})
        status, text, errors = launch(of(2)("run", plan, "--resume", "--out", out))
        self.assertEqual((status, errors), (0, []), text)
        if finished:
            self.assertIn(f"{len(finished)} cells are in {out} already", text)
        self.assertTrue(out.read_text().startswith(before))
        done = {r["key"] for r in self.records(out) if not r["sampling"]["interrupted"] and r["status"] == "ok"}
        self.assertEqual(len(done), 8)
        self.assertFalse(pathlib.Path(f"{out}.unfinished").exists())

    def test_a_rank_that_is_killed_ends_the_job(self):
        out = self.work / "killed.jsonl"
        status, seconds, errors = self.stopped(out, lambda process, ranks: os.kill(ranks[-1], signal.SIGKILL))
        self.assertNotEqual(status, 0)
        self.assertLess(seconds, 10)
        self.assertIn("signal 9", errors)
        self.resumed(out)

    def test_a_signal_to_the_launcher(self):
        out = self.work / "signal.jsonl"
        status, seconds, errors = self.stopped(out, lambda process, ranks: process.send_signal(signal.SIGTERM))
        self.assertNotEqual(status, 0)
        self.assertLess(seconds, 10)
        self.resumed(out)

    def test_a_signal_to_all_ranks(self):
        """As Slurm does, two when time is up, in cells that would take minutes: what was measured is recorded, and the job ends by itself."""
        out, left = self.work / "signals.jsonl", self.work / "signals.jsonl.unfinished"
        two_begun = lambda _: left.exists() and len({json.loads(line)["key"] for line in left.read_text().splitlines()[1:-1]}) >= min(2, len(CORES))
        stop = lambda process, ranks: [os.kill(rank, signal.SIGTERM) for _ in range(2) for rank in ranks]
        status, seconds, errors = self.stopped(out, stop, 1000, two_begun)
        self.assertEqual(status, 3)
        self.assertLess(seconds, 6)
        interrupted = self.records(out)
        self.assertEqual([r["sampling"]["interrupted"] for r in interrupted], [True] * min(2, len(CORES)))
        self.assertRegex("\n".join(said(errors)), r"interrupted; \d cells are measured; to go on, under the launcher: tandem run .* --resume")
        self.resumed(out)
        # Rounds of before count.
        continued = {r["key"] for r in self.records(out) if r["sampling"].get("continued")}
        self.assertLessEqual({r["key"] for r in interrupted}, continued)


class Models(RanksCase):
    def test_cells_go_to_who_has_the_model(self):
        """Rank 1 has no OpenCL; each model is measured where there is one."""
        out = self.work / "models.jsonl"
        both = job((*on_core(0),), (*on_core(1), *NO_OPENCL))
        plan = self.plan(devices=["host:each", "opencl:PTHREAD"], settings={"k": 8, **ROOMS}, scenes=SCENES[0])
        status, text, errors = launch(both("run", plan, "--dry-run"))
        self.assertEqual(status, 0, errors)
        listed = re.findall(r"(?m)^ +\d+  (?:tiled|chunked) .* on (\S+); ranks? ([\d, ]+)$", text)
        host = ("host", "0, 1" if len(CORES) > 1 else "0")
        self.assertEqual(listed, [host] * 2 + [("opencl:0", "0")] * 2)
        status, text, errors = launch(both("run", plan, "--out", out))
        self.assertEqual((status, errors), (0, [] if len(CORES) > 1 else errors), text)
        records = self.records(out)
        self.assertEqual(len(records), 4)
        # The paper's Table 4: a column for each model.
        by_model = text.split("times as long, by model")[1]
        self.assertRegex(by_model, r"^\n +\S.*  pthread-.*\ntiled / chunked +(≈ )?[\d.]+ \[[^]]+\] +(≈ )?[\d.]+ \[")
        self.assertEqual({r["rank"]["number"] for r in records if r["devices"][0]["id"] == "opencl:0"}, {0})

    def test_absent_models(self):
        for asked in ("cuda:H100", "opencl:7", "host+cuda:0"):
            status, text, errors = launch(of(2)("run", self.plan(devices=asked)))
            self.assertEqual((status, text), (2, ""), errors)
            line = [line for line in errors if "rank 1 has no device" not in line]
            self.assertEqual(len(line), 1, errors)
            self.assertIn(f"no rank has a device {asked}; rank 0: ", line[0])
        status, text, errors = launch(of(2)("run", self.plan(devices=["host", "cuda:H100"], impossible="skip", scenes=SCENES[0], settings={"k": 8}), "--dry-run"))
        self.assertEqual(status, 0, errors)
        self.assertIn("2 cells, about", text)
        self.assertTrue(any("skipped 1 impossible combination: no rank has a device cuda:H100" in line for line in errors), errors)

    def test_without_a_launcher(self):
        plan = self.plan(devices=["host:each", "each"], algorithms="tiled", settings={"k": 8}, scenes=SCENES[0])
        status, text, _ = tandem("run", plan, "--dry-run", environment={"OCL_ICD_VENDORS": "/nonexistent/"})
        self.assertEqual((status, text.count(" on host\n")), (0, 1), text)
        self.bad(["no device host:no such", "there are: host ("], "run", self.plan(devices="host:no such"), "--dry-run")
        self.bad("cuda:each: there is no device of that back end", "run", self.plan(devices="cuda:each"), "--dry-run")
        status, text, errors = tandem("run", self.plan(devices=["host", "cuda:H100"], impossible="skip"), "--dry-run")
        self.assertEqual(status, 0, errors)
        self.assertTrue(any("skipped 1 impossible combination: no device cuda:H100" in line for line in errors), errors)


class Refusals(RanksCase):
    def one_line(self, words, expected, code=2):
        status, text, errors = launch(words)
        self.assertEqual((status, len(errors)), (code, 1), (text, errors))
        self.assertIn(expected, errors[0])
        return text

    def test_other_lines_and_other_programs(self):
        line = of(2)("run", self.plan(), "--dry-run")
        line[-1] = "--quiet"
        self.one_line(line, "rank 1 was given another line than rank 0: run ")
        other = self.work / "other"
        alone = self.work / "sources.jsonl"
        tandem("run", SCENES[0], "--device", "host", "--frames", 0, "--truth", "none", "--algorithm", "tiled", "--out", alone)
        digest = self.records(alone)[0]["environment"]["sources"].encode()
        text = PROGRAM.read_bytes()
        self.assertTrue(digest[:8] in text)  # a compiler may keep it in halves
        other.write_bytes(text.replace(digest[:8], b"01234567"))
        other.chmod(0o755)
        words = ["mpirun", "--oversubscribe", "-n", "1", str(PROGRAM), "algorithms", ":", "-n", "1", str(other), "algorithms"]
        self.one_line(words, "rank 1 is a program of other sources than rank 0")

    def test_what_is_of_one_process(self):
        self.one_line(of(2)("run", self.plan(), "--dump-pairs", self.work / "of-one"), "--dump-pairs is of one process")
        self.one_line(of(2)("run", self.plan(scenes="plate")), "unknown scene 'plate'")

    def test_other_commands(self):
        status, text, errors = launch(of(2)("--version"))
        self.assertEqual((status, text.count("with MPI"), errors), (0, 1, []))
        self.assertEqual(launch(of(2)("run", "--help"))[1].count("--deal"), 1)
        text = self.one_line(of(2)("algorithms"), "algorithms runs on one rank; the other waits", 0)
        self.assertEqual(len(re.findall("(?m)^chunked", text)), 1, text)
        status, text, errors = launch(of(4)("check", SCENES[0], "--device", "host", "--algorithm", "tiled", "--frames", 0, "--set", "k=8,99"))
        self.assertEqual(status, 2, errors)
        self.assertEqual((len(errors), errors[0]), (2, "tandem: check runs on one rank; the other 3 wait"))

    def test_tasks_of_slurm_that_are_no_ranks(self):
        """srun without --mpi tells its tasks nothing: the first says what that means, and each measures."""
        of_one = [SCENES[0], "--device", "host", "--frames", 0, "--truth", "none", "--algorithm", "tiled", "--no-check"]
        for number, said_by in (("0", 1), ("1", 0)):
            status, _, errors = tandem("run", *of_one, environment={"SLURM_STEP_NUM_TASKS": "2", "SLURM_PROCID": number})
            self.assertEqual((status, len(errors)), (0, said_by), errors)
            self.assertTrue(all("srun started 2 tasks that know nothing of each other" in line for line in errors), errors)
        self.assertEqual(tandem("run", *of_one, environment={"SLURM_STEP_NUM_TASKS": "1", "SLURM_PROCID": "0"})[2], [])
        self.assertEqual(tandem("algorithms", environment={"SLURM_STEP_NUM_TASKS": "2", "SLURM_PROCID": "0"})[2], [])

    def test_a_scene_that_one_rank_has_not(self):
        far = self.work / "elsewhere"
        far.mkdir()
        (self.work / "boxes.json").write_text(json.dumps({"meshes": {"box": {"box": [1, 1, 1]}}, "bodies": [{"mesh": "box"}, {"mesh": "box"}]}))
        self.plan(scenes="boxes.json", frames=None, settings={"k": [8, 18]})
        here = (*on_core(0), "sh", "-c", f"cd '{self.work}' && exec \"$0\" \"$@\"", str(PROGRAM))
        there = (*on_core(1), "sh", "-c", f"cd '{far}' && exec \"$0\" \"$@\"", str(PROGRAM))
        status, text, errors = launch(job(here, there)("run", "plan.json", "--out", self.work / "boxes.jsonl"))
        self.assertEqual(len(self.records(self.work / "boxes.jsonl")), 4)
        if len(CORES) > 1:
            self.assertEqual((status, len(errors)), (2, 1), errors)
            self.assertIn("rank 1 cannot measure boxes.json: boxes.json", errors[0])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
