# SPDX-License-Identifier: MIT
# test: cost=4
"""What `tandem devices` reports of registered OpenCL drivers: those that work, and
made-up ones that fail, each with the reason."""

import json
import pathlib
import subprocess

from tests.program import Case

POCL = pathlib.Path("/etc/OpenCL/vendors/pocl.icd").read_text().splitlines()[0]
NEW_TBB = "_ZN3tbb6detail2r19from_laterEv"  # a symbol that no oneTBB has


class Drivers(Case):
    def setUp(self):
        self.vendors = self.work / self._testMethodName
        self.vendors.mkdir()

    def register(self, name, library):
        (self.vendors / f"{name}.icd").write_text(f"{library}\n")
        return str(self.vendors / f"{name}.icd")

    def listed(self, vendors=None, **environment):
        """The entry of OpenCL in `devices --json`, whose reason the text also has."""
        environment = {"OCL_ICD_VENDORS": str(vendors or self.vendors), **environment}
        out = self.output("devices", "--json", environment=environment)
        (entry,) = [entry for entry in json.loads(out) if entry["backend"] == "opencl"]
        text = self.output("devices", environment=environment)
        if entry["reason"]:
            self.assertIn(entry["reason"], text.splitlines())
        for driver in entry["drivers"]:
            if not driver["problem"]:
                self.assertIn(
                    f"({driver['library']}): platform '{driver['platforms'][0]['name']}' with {driver['platforms'][0]['devices']} device",
                    text,
                )
        return entry

    def problem(self, library, expected, **environment):
        """A driver that fails alone, and beside PoCL, whose device stays."""
        file = self.register("failing", library)
        entry = self.listed(**environment)
        (driver,) = entry["drivers"]
        self.assertEqual(
            (driver["file"], driver["library"], driver["platforms"]), (file, str(library) or None, [])
        )
        self.assertRegex(driver["problem"], expected)
        self.assertIn("opencl: no platform", entry["reason"])
        self.assertIn(f"{file}{f' ({library})' if library else ''}: {driver['problem']}", entry["reason"])
        self.bad(
            driver["problem"],
            "run plates --device opencl:0",
            environment={"OCL_ICD_VENDORS": str(self.vendors), **environment},
        )
        self.register("pocl", POCL)
        entry = self.listed(**environment)
        self.assertEqual([device["id"] for device in entry["devices"]], ["opencl:0"])
        self.assertEqual([driver["problem"] for driver in entry["drivers"]], [driver["problem"], None])
        self.assertEqual(
            entry["drivers"][1]["platforms"], [{"name": "Portable Computing Language", "devices": 1}]
        )
        self.assertEqual(
            entry["reason"], f"opencl: {file}{f' ({library})' if library else ''}: {driver['problem']}"
        )

    def library(self, text):
        """A library made of C text."""
        out = self.vendors / "libmade.so"
        subprocess.run(
            ["cc", "-shared", "-fPIC", "-Wl,-z,now", "-x", "c", "-o", out, "-"],
            input=text,
            text=True,
            check=True,
        )
        return out

    def test_missing_library(self):
        self.problem(
            "/nonexistent/libnone.so",
            "^the library does not load: .*libnone.so: cannot open shared object file",
        )

    def test_broken_library(self):
        broken = self.vendors / "libbroken.so"
        broken.write_text("no machine code\n" * 10)
        self.problem(broken, "^the library does not load: .*invalid ELF header$")

    def test_library_that_is_no_driver(self):
        self.problem(
            "libz.so.1", "^the library is no OpenCL driver: it has no clGetExtensionFunctionAddress$"
        )

    def test_driver_without_platforms(self):
        text = (
            "int none(unsigned n, void* all, unsigned* count) { if (count) *count = 0; return -1001; }\n"
            "void* clGetExtensionFunctionAddress(const char* name) { return name[2] == 'I' ? (void*)none : 0; }\n"
        )
        self.problem(self.library(text), r"^it lists no platform \(code -1001\)$")

    def test_library_that_needs_a_newer_one_tbb(self):
        library = self.library(f"void {NEW_TBB}(void); void f(void) {{ {NEW_TBB}(); }}\n")
        self.problem(
            library,
            f"undefined symbol: {NEW_TBB}; it needs a newer oneTBB .*: set LD_PRELOAD=FOLDER/libtbb.so.12$",
        )
        own = self.vendors / "libtbb.so.12"
        own.write_bytes(b"")
        (self.vendors / "pocl.icd").unlink()
        self.assertTrue(self.listed()["drivers"][0]["problem"].endswith(f"set LD_PRELOAD={own}"))

    def test_file_without_a_library(self):
        self.problem("", "^the first line of the file names no library$")

    def test_words_of_files_are_safe(self):
        self.register("odd", "/nonexistent/\x1b[31m")
        self.assertIn(r"/nonexistent/\x1b[31m", self.listed()["reason"])

    def test_registration_by_variables(self):
        """One file, a library, a folder of the loader, none."""
        file = self.register("pocl", POCL)
        for vendors, expected in (
            (file, [(file, POCL)]),
            (POCL, [(None, POCL)]),
            (self.vendors, [(file, POCL)]),
        ):
            entry = self.listed(vendors)
            self.assertEqual([(driver["file"], driver["library"]) for driver in entry["drivers"]], expected)
            self.assertEqual((entry["reason"], len(entry["devices"])), (None, 1))
        self.assertEqual(
            self.listed("pocl.icd", OPENCL_VENDOR_PATH=str(self.vendors))["drivers"][0]["file"], file
        )
        self.assertEqual(self.listed("/nonexistent/")["drivers"], [])

    def test_unwritable_cache(self):
        self.register("pocl", POCL)
        entry = self.listed(POCL_CACHE_DIR="/proc/x")
        (driver,) = entry["drivers"]
        self.assertEqual((entry["devices"], driver["platforms"][0]["devices"]), ([], 0))
        self.assertRegex(
            driver["problem"],
            r"^platform 'Portable Computing Language' has no device: its kernel cache /proc/x cannot be written \(.+\); set POCL_CACHE_DIR",
        )
        self.bad(
            "kernel cache /proc/x cannot be written",
            "run plates --device opencl:0",
            environment={"OCL_ICD_VENDORS": str(self.vendors), "POCL_CACHE_DIR": "/proc/x"},
        )
        self.output(f"run {self.twice} --device host", environment={"POCL_CACHE_DIR": "/proc/x"})
