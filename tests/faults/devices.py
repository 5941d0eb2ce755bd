# SPDX-License-Identifier: MIT
# test: cost=20 full=1000
"""Every call to OpenCL, or to the CUDA driver and NVRTC, fails in turn, one per
run: once, or with all later calls, as on a lost device. The program must end with a documented code and one
line that gives the reason. Earlier records stay complete, and if it continues its answers are right. Shims
stand before OpenCL's loader, where they keep enqueued commands in flight, and before the stubs of CUDA."""

import collections
import concurrent.futures
import json
import os
import shutil
import subprocess
import unittest

from tests import pace
from tests.program import BUILT, LONG, PROGRAM, STUBS, Case, messages, sets, tandem, tried, words_of

SHORT = {"opencl": 4, "cuda": 5}  # runs per command and kind of failure in the short form
FIRST = {
    "opencl": 1,
    "cuda": 7,
}  # first call of the short form: one that opens a device, which must not be tried twice
MOST = 700  # maximum number of calls: later calls repeat those of a short frame
LAST = 30  # the last calls close a device and cannot report errors
HANGS = 300  # seconds of its own processor time until a run counts as hung
SMALL = {name: 4096 for name in ("pair_capacity", "contact_capacity")}
SCENE = "pile:bodies=2,frames=1"
# CUDA calls whose failure the program may ignore: they free or restore something, or query optional values.
# Out-of-memory errors are always allowed because frames are then run in batches. A missing time or version is
# null in a record.
CAN_DO_WITHOUT = r"Destroy|Free|Unload|Release|Occupancy|GetAttribute|MemGetInfo|GetUuid|CtxGetCurrent|CtxSetCurrent|cuInit|MemHostAlloc|GetError|ElapsedTime|DriverGetVersion"
LIBRARYS_WORDS = r"std::|::at\b|basic_string|bad_alloc|json\.exception|vector::"
Kind = collections.namedtuple("Kind", "name code keeps_failing")
NO_MEMORY = 2  # CUDA_ERROR_OUT_OF_MEMORY
KINDS = {
    "opencl": (Kind("once", -5, False),),
    "cuda": (Kind("once", 999, False), Kind("without memory", NO_MEMORY, False), Kind("for good", 700, True)),
}
Outcome = collections.namedtuple("Outcome", "code errors hung")
Fault = collections.namedtuple(
    "Fault", "command kind call is_last"
)  # is_last: the call is among those that close the device


def stubs():
    """Environment that selects the stubs, and disables NVML and CUPTI, which are not under test."""
    found = {"LD_LIBRARY_PATH": f"{STUBS}/driver", "TANDEM_NVRTC": f"{STUBS}/nvrtc/libnvrtc.so"}
    return {**found, "TANDEM_NVML": "/nonexistent", "TANDEM_CUPTI": "/nonexistent"}


class Sweep(Case):
    backend, device, shim = "", "", ""
    environment = {}
    checks = ()  # arguments that disable comparisons: kernels of a stub do nothing
    counts, went_on, clear = collections.Counter(), collections.Counter(), set()

    @classmethod
    def setUpClass(cls):
        if not cls.shim:
            raise unittest.SkipTest("no library to fail calls")
        super().setUpClass()
        cls.counts, cls.went_on, cls.clear = collections.Counter(), collections.Counter(), set()
        cls.old = cls.work / "old.jsonl"
        assert (
            tandem(f"run {cls.twice} --device host --set k=8 --repeat 1 --truth none --out {cls.old}")[0] == 0
        )

    @classmethod
    def tearDownClass(cls):
        print(
            f"{cls.backend}: {dict(cls.counts)} calls failed; the program went on after {dict(cls.went_on)}"
        )
        if cls.clear == set(cls.commands(cls, cls.work)):
            where = (
                cls.device
                if cls.backend == "cuda" and not cls.checks
                else {"opencl": "PoCL", "cuda": "stubs"}[cls.backend]
            )
            tried(
                f"calls that fail: {'OpenCL, with work in flight' if cls.backend == 'opencl' else 'CUDA driver and NVRTC'}",
                sum(cls.counts.values()),
                "runs",
                where,
            )
        super().tearDownClass()

    def commands(self, folder):
        """Words by name of the command. Everything is written to the folder; records are appended to old.jsonl."""
        cell = (f"--device {self.device} --set k=8 --out {folder}/old.jsonl", *sets(SMALL))
        files = f"--dump-pairs {folder}/pairs.csv --quiet"
        contacts = "--set contact_rule=sat --set decision=recheck --set precision=float --set rounding=safe"
        run = f"run {SCENE} --algorithm chunked,tiled --repeat 1 --truth none {files}"
        simulate = (
            f"simulate arch:segments=2 --steps 2 --dynamics absolute_tolerance=1 --device {self.device} "
            f"-o {folder}/a.frames --record {folder}/old.jsonl --quiet"
        )
        return {
            "run": (run, *cell, *self.checks),
            "check": (f"check {SCENE} --algorithm gproximity --preset fair", *cell),
            "accuracy": (f"accuracy {SCENE} --algorithm tiled {contacts} --repeat 1", *cell),
            "simulate": (simulate,),
            "export": (f"export {SCENE} --frames 0 --vtu {folder} --contacts --device {self.device}",),
        }

    def fault(self, command, kind, call):
        """One run in a separate folder in which call `call` fails; 0: no call fails, and calls are counted."""
        folder = self.work / f"{self.backend}-{command}-{kind.name}-{call}".replace(" ", "_")
        folder.mkdir()
        shutil.copy(self.old, folder)
        environment = {
            **os.environ,
            **self.environment,
            "LD_PRELOAD": self.shim,
            "SHIM_CALL": str(call),
            "SHIM_CODE": str(kind.code),
            "SHIM_FAILED": str(folder / "failed"),
            "TANDEM_KERNEL_CACHE": str(folder / "cache"),
            "POCL_EXTRA_BUILD_FLAGS": "-cl-opt-disable",
        }
        environment |= {"SHIM_STAYS": "1"} if kind.keeps_failing else {}
        environment |= {"SHIM_COUNT": str(folder / "count")} if call == 0 else {}
        running = subprocess.Popen(
            [str(PROGRAM), *words_of(self.commands(folder)[command])],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            env=environment,
        )
        try:
            errors = messages(pace.communicate(running, HANGS)[1])
        except pace.Hung:
            return folder, Outcome(0, [], True)
        return folder, Outcome(running.returncode, errors, False)

    def files(self, folder):
        """The files of a run without a failure that do not depend on time."""
        return {
            path.name: path.read_bytes()
            for path in sorted(folder.rglob("*"))
            if path.suffix in (".csv", ".frames", ".vtu", ".pvd", ".vtp")
        }

    def judge(self, fault, folder, outcome, well):
        """Checks a run with a fault. `well`: code and files of the run without one."""
        command, kind, call, is_last = fault
        where = f"{self.backend}, {command}, call {call} {kind.name}: {outcome.code}: {outcome.errors}"
        self.assertFalse(outcome.hung, where)
        self.assertGreaterEqual(outcome.code, 0, where)
        old, kept = self.old.read_bytes(), (folder / "old.jsonl").read_bytes()
        self.assertTrue(kept.startswith(old), f"{where}: a record is gone")
        for line in kept.decode().split("\n")[:-1]:
            json.loads(line)
        if outcome.code == well[0]:
            self.went_on[command] += 1
            self.assertEqual((outcome.errors, self.files(folder)), ([], well[1]), where)
            if self.backend == "cuda" and kind.code != NO_MEMORY:
                self.assertRegex(
                    (folder / "failed").read_text(),
                    CAN_DO_WITHOUT + ("|StreamSynchronize" if kind.keeps_failing or is_last else ""),
                    where,
                )
            return
        self.assertIn(outcome.code, (2, 3), where)
        self.assertIn(len(outcome.errors), (1, 2) if command in ("run", "check", "accuracy") else (1,), where)
        self.assertEqual(len(set(outcome.errors)), len(outcome.errors), where)
        for line in outcome.errors:
            self.assertRegex(line, "^tandem: .{15}", where)
            self.assertRegex(
                line, r"fail|does not compile|out of|no device|unknown device|cannot|takes|needs", where
            )
            self.assertNotRegex(line, LIBRARYS_WORDS, where)

    def sweep(self, command):
        for kind in KINDS[self.backend]:
            folder, outcome = self.fault(command, kind, 0)
            self.assertEqual((outcome.hung, outcome.errors), (False, []), command)
            self.assertIn(outcome.code, (0, 1) if self.checks else (0,))
            well = outcome.code, self.files(folder)
            total = int((folder / "count").read_text())
            swept = min(total, MOST)
            self.assertGreater(swept, 30, f"calls of {command}")
            calls = (
                range(1, swept + 1)
                if LONG
                else range(FIRST[self.backend], swept + 1, -(-swept // SHORT[self.backend]))
            )
            with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as several:
                for call, (folder, outcome) in zip(
                    calls, several.map(lambda call: self.fault(command, kind, call), calls)
                ):
                    with self.subTest(kind=kind.name, call=call):
                        self.judge(Fault(command, kind, call, call > total - LAST), folder, outcome, well)
                    shutil.rmtree(folder)
            self.counts[command] += len(calls)
        self.assertLess(self.went_on[command], self.counts[command])
        if self._outcome.success:
            self.clear.add(command)

    def test_run(self):
        self.sweep("run")

    def test_check(self):
        self.sweep("check")

    def test_accuracy(self):
        self.sweep("accuracy")

    def test_simulate(self):
        self.sweep("simulate")

    def test_export(self):
        self.sweep("export")


class Opencl(Sweep):
    backend, device, shim = "opencl", "opencl:0", str(BUILT / "libopencl_shim.so")


class Cuda(Sweep):
    backend, device, shim = "cuda", "cuda:0", str(BUILT / "libcuda_shim.so")
    environment = stubs()
    checks = ("--no-check",)


del Sweep  # the base class has no backend
