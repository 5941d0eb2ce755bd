# SPDX-License-Identifier: MIT
"""What a step may need of the machine: "device cuda:0", "double cuda:0" (a device with double precision),
"driver PoCL" (a device whose driver has this name), "algorithm cubql cuda:0" (one that the program has for this
device), "program mpirun", "module torch" (of this Python), "file *.frames"."""

import functools
import glob
import importlib.util
import json
import shutil
import subprocess

NO_DOUBLE = "the device has no double precision"


class Machine:
    """What is there, for a program and a folder of results."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    @functools.cached_property
    def _backends(self):
        done = subprocess.run(
            [self.program, "devices", "--json"], stdout=subprocess.PIPE, text=True, check=True
        )
        return json.loads(done.stdout)

    @functools.cached_property
    def devices(self):
        """Devices by id."""
        return {device["id"]: device for backend in self._backends for device in backend["devices"]}

    @property
    def default(self):
        """The device that the program takes when none is named."""
        return next(name for name, device in self.devices.items() if device["default"])

    @functools.cached_property
    def reasons(self):
        """Why other devices are missing."""
        return [backend["reason"] for backend in self._backends if backend["reason"]]

    def of_driver(self, name):
        """The first device whose driver has this name, or ""."""
        return next((one for one, device in self.devices.items() if name in device["driver"]), "")

    def missing(self, need):
        """Why a need is not met, in one line; "" if it is."""
        kind, _, what = need.partition(" ")
        return getattr(self, f"_{kind}")(what)

    def _device(self, what, what_it_is="device "):
        there = f"there are: {'; '.join([', '.join(self.devices), *self.reasons])}"
        return "" if what in self.devices else f"no {what_it_is}{what}; {there}"

    def _driver(self, what):
        return "" if self.of_driver(what) else self._device(what, "device of ")

    def _double(self, what):
        return self._device(what) or ("" if self.devices[what]["double"] else NO_DOUBLE)

    def _algorithm(self, what):
        name, device = what.split()
        words = ["run", "plates", "--frames", "0", "--algorithm", name, "--device", device, "--dry-run"]
        done = subprocess.run([self.program, *words], capture_output=True, text=True)
        return "" if done.returncode == 0 else done.stderr.strip().splitlines()[-1]

    def _program(self, what):
        return "" if shutil.which(what) else f"program {what} is missing"

    def _module(self, what):
        return "" if importlib.util.find_spec(what) else f"Python's {what} is not installed"

    def _file(self, what):
        return "" if glob.glob(str(self.folder / what)) else f"{what} is missing"
