# SPDX-License-Identifier: MIT
# test: cost=1
"""Errors of the program when CUDA is absent, old, broken or failing,
with the stubs of the driver and NVRTC in FOLDER and those of NVML and CUPTI (two files)."""

import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

from tests.program import BUILT, PROGRAM, STUBS as FOLDER, ran

NVML, CUPTI = BUILT / "libstub_nvml.so", BUILT / "libstub_cupti.so"
RUN = ("run", "pile:bodies=4,frames=1", "--repeat", "1", "--algorithm", "chunked")


def tandem(*arguments, driver="driver", nvrtc=FOLDER / "nvrtc/libnvrtc.so", **variables):
    environment = {
        **os.environ,
        "LD_LIBRARY_PATH": str(FOLDER / driver),
        **{k: str(v) for k, v in variables.items()},
    }
    environment.pop("TANDEM_NVRTC", None)
    for name in ("TANDEM_NVML", "TANDEM_CUPTI"):
        if name not in variables:
            environment[name] = "/nonexistent"
    if nvrtc:
        environment["TANDEM_NVRTC"] = str(nvrtc)
    done = ran([PROGRAM, *arguments], stdin=subprocess.DEVNULL, env=environment)
    return done.returncode, done.stdout, done.stderr.splitlines()


def reason(**options):
    """The reason for the missing CUDA device; checks that there is no other error."""
    status, out, errors = tandem("devices", "--json", **options)
    assert status == 0 and not errors, (status, errors)
    entries = {entry["backend"]: entry for entry in json.loads(out)}
    assert entries["host"]["devices"] and not entries["cuda"]["devices"], entries
    return entries["cuda"]["reason"]


class Faults(unittest.TestCase):
    def test_the_stub_is_a_device(self):
        status, out, errors = tandem("devices", "--require", "cuda:0")
        self.assertEqual((status, errors), (0, []))
        self.assertRegex(out, r"cuda:0 +Stub GPU \(CUDA 13\.0")

    def test_conditions_of_the_device(self):
        def now(**options):
            status, out, errors = tandem("devices", "--json", **options)
            self.assertEqual((status, errors), (0, []))
            return [
                d["now"]
                for entry in json.loads(out)
                for d in entry["devices"]
                if d["id"] in ("host", "cuda:0")
            ]

        line = "now: 345 MHz SM, 3201 MHz memory, 34 C, 76 of 700 W, throttled: power cap\n"
        options = {"TANDEM_NVML": NVML, "STUB_SM": 345, "STUB_THROTTLE": 4, "STUB_PROCESSES": 3}
        self.assertIn(line, tandem("devices", **options)[1])
        host, cuda = now(**options)
        self.assertIsNone(host)
        self.assertEqual(
            (cuda["sm_mhz"], cuda["throttled"], cuda["other_processes"]), (345, ["power cap"], 2)
        )
        self.assertIsNone(now(STUB_REFUSES="nvmlDeviceGetPowerUsage", **options)[1]["power_w"])
        for without in ({"TANDEM_NVML": "/nonexistent"}, {**options, "STUB_NVML_INIT": 9}):
            self.assertNotIn("now:", tandem("devices", **without)[1])
            self.assertEqual(now(**without), [None, None])

    def test_the_other_build_of_a_comparison_is_no_disturbance(self):
        """It has a context on the GPU, but does not compute while this one does."""
        for turns, processes in (({}, 2), ({"TANDEM_TURNS": "0,1,7"}, 1)):
            with tempfile.TemporaryDirectory() as folder:
                out = pathlib.Path(folder) / "out.jsonl"
                words = (
                    *RUN,
                    "--device",
                    "cuda:0",
                    "--no-check",
                    "--truth",
                    "none",
                    "--no-count",
                    "--out",
                    str(out),
                )
                tandem(*words, TANDEM_NVML=NVML, STUB_PROCESSES=3, **turns)
                record = json.loads(out.read_text().splitlines()[0])
            self.assertEqual(record["conditions"]["after"]["gpus"][0]["other_processes"], processes)
            self.assertEqual(
                record["conditions"]["disturbed"][0]["why"].partition("; throttled")[0],
                f"other processes on the GPU: {processes}",
            )

    def test_the_source_of_times(self):
        def clocks(**options):
            """In 'tandem devices', in its --json output, and in a record."""
            listed = [
                d["clock"]
                for e in json.loads(tandem("devices", "--json", **options)[1])
                for d in e["devices"]
                if d["id"] == "cuda:0"
            ]
            self.assertIn(f"; times by {listed[0]}", tandem("devices", **options)[1])
            with tempfile.TemporaryDirectory() as folder:
                out = pathlib.Path(folder) / "out.jsonl"
                self.assertEqual(tandem(*RUN, "--device", "host,cuda:0", "--out", str(out), **options)[0], 1)
                records = [json.loads(line) for line in out.read_text().splitlines()]
            self.assertEqual(records[0]["devices"][0]["clock"], "steady clock")
            kernels = (
                [d for k in records[1]["kernel_times"].values() for d in k["device_ns"]["samples"]]
                if "clock" in records[1]["devices"][0]
                else []
            )
            self.assertTrue(kernels)
            self.assertNotIn("CUPTI", records[1]["key"])
            return listed[0], records[1]["devices"][0]["clock"]

        self.assertEqual(clocks(TANDEM_CUPTI=CUPTI), 2 * ("CUPTI 13.0 activity records",))
        self.assertEqual(clocks(), 2 * ("CUDA events",))
        self.assertEqual(
            clocks(TANDEM_CUPTI=CUPTI, STUB_CUPTI_FAILS="cuptiActivityEnable"),
            2 * ("CUDA events (CUPTI: cuptiActivityEnable failed with 35)",),
        )

    def test_no_driver(self):
        if subprocess.run("ldconfig -p | grep -q libcuda.so.1", shell=True).returncode == 0:
            self.skipTest("this machine has a driver")
        self.assertEqual(reason(driver="none"), "cuda: no driver (looked for libcuda.so.1); install NVIDIA's")
        status, _, errors = tandem(*RUN, "--device", "cuda:0", driver="none")
        self.assertEqual((status, len(errors)), (2, 1))
        self.assertIn("unknown device 'cuda:0' (there are: ", errors[0])
        self.assertIn("cuda: no driver", errors[0])

    def test_no_device(self):
        self.assertIn("cuInit failed with CUDA_ERROR_NO_DEVICE", reason(STUB_INIT=100))

    def test_driver_without_an_entry_point(self):
        self.assertIn("has no cuLaunchKernel", reason(driver="old"))

    def test_no_compiler(self):
        text = reason(nvrtc="/nonexistent/libnvrtc.so")
        self.assertIn("1 device(s): Stub GPU", text)
        self.assertIn("/nonexistent/libnvrtc.so", text)

    def test_driver_older_than_the_compiler(self):
        self.assertIn(
            "NVRTC 13.0 is newer than the driver, which is for CUDA 12.4", reason(STUB_VERSION=12040)
        )
        self.assertIn(
            "no known NVRTC works with a driver for CUDA 10.2", reason(nvrtc=None, STUB_VERSION=10020)
        )

    def failed(self, **options):
        """The single line on standard error, and the record of a failing cell on the stub, after a cell that
        succeeds."""
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "out.jsonl"
            status, _, errors = tandem(*RUN, "--device", "host,cuda:0", "--out", str(out), **options)
            records = [json.loads(line) for line in out.read_text().splitlines()]
        self.assertEqual(status, 3)
        self.assertEqual(len(errors), 1, errors)
        self.assertEqual([r["status"] for r in records], ["ok", "failed"])
        # The digest of the UUID, whose bytes are all 5a, and not the UUID.
        self.assertEqual(records[1]["devices"][0]["hardware"], "debc1d4a800261d4")
        self.assertIn(records[1]["failure"], errors[0])
        self.assertIn("Stub GPU", errors[0])
        return errors[0]

    def test_out_of_memory(self):
        self.assertRegex(
            self.failed(STUB_MEMORY=1000000), r"needs \d+ bytes, and one allocation holds at most 1000000"
        )
        self.assertRegex(
            self.failed(STUB_MEMORY=40000000),
            r"CUDA_ERROR_OUT_OF_MEMORY .* allocating \d+ bytes with \d+ free of 40000000",
        )

    def test_a_kernel_that_faults(self):
        text = self.failed(STUB_FAULT=1)
        self.assertIn("cuStreamSynchronize failed with CUDA_ERROR_ILLEGAL_ADDRESS", text)
        self.assertIn("driver for CUDA 13.0, NVRTC 13.0", text)

    def test_a_kernel_that_does_not_compile(self):
        self.assertRegex(
            self.failed(STUB_BROKEN=1), r"\.cl does not compile with NVRTC 13\.0 for sm_90 cubin"
        )

    def test_cached_images_are_not_compiled_again(self):
        with tempfile.TemporaryDirectory() as folder:
            cache = pathlib.Path(folder) / "made" / "here"
            run = lambda **options: tandem(*RUN, "--device", "cuda:0", TANDEM_KERNEL_CACHE=cache, **options)[
                0
            ]
            self.assertEqual(run(STUB_BROKEN=1), 3)
            self.assertEqual(list(cache.iterdir()), [])
            self.assertEqual(run(), 1)
            files = sorted(cache.iterdir())
            self.assertGreater(len(files), 5)
            self.assertEqual(run(STUB_BROKEN=1), 1)
            self.assertEqual(run(STUB_BROKEN=1, STUB_NVRTC=12, STUB_VERSION=12000), 3, "another compiler")
            for damage in (
                lambda b: b[:-1],
                lambda b: b[:100] + b"?" + b[101:],
                lambda b: b"",
                lambda b: b"other" + b,
            ):
                whole = files[0].read_bytes()
                files[0].write_bytes(damage(whole))
                self.assertEqual(run(STUB_BROKEN=1), 3)
                self.assertEqual(run(), 1)
                self.assertEqual(files[0].read_bytes(), whole)
            files[0].write_bytes(files[1].read_bytes())  # as if two programs had the same name
            self.assertEqual(run(STUB_BROKEN=1), 3)

    def test_images_are_not_read_from_folders_that_others_can_write(self):
        with tempfile.TemporaryDirectory() as folder:
            cache = pathlib.Path(folder) / "images"
            self.assertEqual(tandem(*RUN, "--device", "cuda:0", TANDEM_KERNEL_CACHE=cache)[0], 1)
            self.assertEqual(cache.stat().st_mode & 0o777, 0o700)
            for mode in (0o720, 0o702, 0o1777):
                cache.chmod(mode)
                self.assertIn(
                    f"TANDEM_KERNEL_CACHE: other users can write to {cache}; run 'chmod go-w' on it",
                    reason(TANDEM_KERNEL_CACHE=cache),
                )
            cache.chmod(0o755)
            self.assertEqual(tandem(*RUN, "--device", "cuda:0", TANDEM_KERNEL_CACHE=cache)[0], 1)

    def test_a_cache_folder_that_cannot_be_created(self):
        """Images are not stored: one line, and every run compiles."""
        for _ in range(2):
            status, _, errors = tandem(*RUN, "--device", "cuda:0", TANDEM_KERNEL_CACHE="/dev/null/images")
            self.assertEqual((status, len(errors)), (1, 1), errors)
            self.assertIn(
                "tandem: TANDEM_KERNEL_CACHE: /dev/null/images cannot be written (Not a directory)", errors[0]
            )

    def test_wrong_answers_are_detected(self):
        """The stub's kernels do nothing: every pair is missing."""
        status, out, errors = tandem(*RUN, "--device", "cuda:0")
        self.assertEqual((status, errors), (1, []))
        self.assertTrue(re.search(r"WRONG: [1-9]\d* missing, 0 extra", out), out)
