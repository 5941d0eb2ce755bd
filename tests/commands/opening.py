# SPDX-License-Identifier: MIT
# test: cost=5
"""The backends that a command opens, with drivers that abort any process that
loads them: TRAP replaces an OpenCL driver, CUDA's and NVML. STUBS has a working driver of CUDA."""

import os
import pathlib
import tempfile
import unittest

from tests.program import BUILT, PROGRAM, STUBS, ran

TRAP = BUILT / "libtrap.so"
SCENE = "pile:bodies=2,frames=1"
RUN = ("run", SCENE, "--algorithm", "chunked", "--repeat", "1", "--truth", "none")


class Opening(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = pathlib.Path(folder.name)
        for name in ("cuda", "icd"):
            (self.work / name).mkdir()
        for name in ("libcuda.so.1", "libnvidia-ml.so.1"):
            (self.work / "cuda" / name).symlink_to(TRAP)
        (self.work / "icd/trap.icd").write_text(f"{TRAP}\n")

    def tandem(self, *arguments, opencl=True, cuda=True):
        """Runs the program with traps for the arguments that are true: exit code (negative for a signal), standard
        output and error."""
        environment = {**os.environ, "LD_LIBRARY_PATH": str(self.work / "cuda" if cuda else STUBS / "driver")}
        for name in ("TANDEM_CUPTI", "TANDEM_NVML", "TANDEM_NVRTC"):
            environment.pop(name, None)
        if not cuda:
            environment.update(
                TANDEM_NVRTC=str(STUBS / "nvrtc/libnvrtc.so"), TANDEM_CUPTI="", TANDEM_NVML="/nonexistent"
            )
        if opencl:
            environment["OCL_ICD_VENDORS"] = f"{self.work}/icd/"
        done = ran([PROGRAM, *arguments], env=environment)
        return done.returncode, done.stdout, done.stderr

    def test_the_traps_work(self):
        self.assertLess(self.tandem("devices", cuda=False)[0], 0)
        self.assertLess(self.tandem("devices", opencl=False)[0], 0)
        for device in ("opencl:0", "cuda:0", "all", "host,opencl:0", "host+opencl:0"):
            self.assertLess(self.tandem(*RUN, "--device", device)[0], 0, device)

    def test_host_alone(self):
        frames = self.work / "arch.frames"
        for arguments in (
            (*RUN, "--device", "host"),
            (*RUN, "--device", "host", "--require", "host"),
            ("check", SCENE, "--device", "host", "--algorithm", "tiled"),
            ("accuracy", SCENE, "--device", "host", "--set", "k=6", "--repeat", 1, "--truth-contacts", 1),
            ("simulate", "block", "--steps", 1, "--device", "host", "-o", frames),
            ("export", SCENE, "--vtu", self.work / "vtu", "--contacts", "--device", "host"),
            ("devices", "--measure", "--device", "host"),
            ("algorithms",),
            ("scenes",),
            ("completion", "--words", "run", "--set", ""),
        ):
            status, out, errors = self.tandem(*arguments)
            self.assertEqual(status, 0, (arguments, out, errors))

    def test_cuda_alone(self):
        """The stub runs no kernels: the test checks that only the stub was loaded."""
        status, out, errors = self.tandem(*RUN, "--device", "cuda:0", "--dry-run", cuda=False)
        self.assertEqual((status, errors), (0, ""), out)
        self.assertIn("on cuda:0", out)
        self.assertEqual(
            self.tandem(*RUN, "--device", "host", "--require", "cuda", "--dry-run", cuda=False)[0], 0
        )

    def test_the_default_device_is_the_first_gpu(self):
        """CUDA is opened first, and OpenCL only where CUDA has no GPU."""
        first = "device cuda:0: .*, the first GPU \\(--device chooses another\\)\\n"
        status, out, errors = self.tandem(*RUN, "--dry-run", cuda=False)
        self.assertEqual((status, errors), (0, ""), out)
        self.assertRegex(out, rf"\A{first}(.|\n)* on cuda:0\n")
        self.assertLess(self.tandem(*RUN, "--dry-run", opencl=False)[0], 0)
        (self.work / "cuda/libcuda.so.1").unlink()
        self.assertLess(self.tandem(*RUN, "--dry-run")[0], 0)

    def test_without_a_gpu_the_default_device_is_the_host(self):
        (self.work / "cuda/libcuda.so.1").unlink()
        (self.work / "icd/trap.icd").unlink()
        for arguments in (
            (*RUN, "--dry-run"),
            ("accuracy", SCENE, "--set", "k=6", "--repeat", 1, "--truth-contacts", 1),
            ("profile", SCENE, "--algorithm", "tiled", "--repeat", 1),
            ("simulate", "block", "--steps", 1, "-o", self.work / "block.frames"),
            ("export", SCENE, "--vtu", self.work / "vtu", "--contacts", "--surfaces", "--pressure", 1),
        ):
            status, out, errors = self.tandem(*arguments)
            self.assertEqual(status, 0, (arguments, errors))
            self.assertRegex(out, r"\Adevice host: .*, because there is no GPU \('tandem devices' says why; ")
            self.assertEqual(out.count("--device chooses another"), 1, out)
        self.assertNotIn("because", self.tandem("check", SCENE, "--algorithm", "tiled")[1])

    def test_required_devices_are_opened(self):
        for required in ("opencl", "opencl:0", "cuda"):
            self.assertLess(self.tandem(*RUN, "--device", "host", "--require", required)[0], 0, required)

    def test_unknown_devices_are_searched_in_every_backend(self):
        for arguments in (
            ("--device", "nix"),
            ("--device", "host:1"),
            ("--device", "host", "--require", "nix"),
        ):
            self.assertLess(self.tandem(*RUN, *arguments)[0], 0, arguments)
        status, _, errors = self.tandem(*RUN, "--device", "cuda:7", cuda=False, opencl=False)
        self.assertEqual(status, 2)
        self.assertRegex(
            errors,
            r"unknown device 'cuda:7'; the nearest is 'cuda:0' \(there are: host, (opencl:0, )?cuda:0\)",
        )
