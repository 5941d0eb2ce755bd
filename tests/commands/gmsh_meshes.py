# SPDX-License-Identifier: MIT
# test: full=15 needs=TANDEM_BUILDS_PYTHON
"""Meshes that Gmsh itself writes (tests/commands/gmsh_made.py): of orders 1 to 3, with
elements in two groups, in parts with ghost cells, beside prisms, with large numbers, in each of its formats.
tandem reads each with the counts that Gmsh has, or refuses it in one line that names the way out. Installs
Gmsh from PyPI into a folder of its own."""

import json
import re
import subprocess
import sys

from tests.program import SOURCE, Case, tandem

GMSH = "gmsh==4.15.2"
READ = {".msh", ".vtk", ".mesh"}  # by tandem itself
CONVERTED = {
    ".inp",
    ".su2",
}  # by tandem convert; meshio does not read what Gmsh writes as .cgns, .med and .bdf, nor elements of high order
OPTIONS = {"order2": ["--corners"], "order3": ["--corners"], "mixed": ["--only-tetrahedra"]}
COUNTS = ("duplicates", "reduced", "other_cells")


class GmshMeshes(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        subprocess.run([sys.executable, "-m", "venv", cls.work / "tools"], check=True)
        subprocess.run(
            [cls.work / "tools/bin/pip", "install", "--quiet", "--disable-pip-version-check", GMSH],
            check=True,
        )
        cls.made = cls.work / "made"
        cls.made.mkdir()
        subprocess.run(
            [cls.work / "tools/bin/python", SOURCE / "tests/commands/gmsh_made.py", cls.made], check=True
        )
        cls.expected = json.loads((cls.made / "expected.json").read_text())["files"]

    def run_on(self, path, *options):
        """The counts that tandem reads, or its refusal."""
        out = self.work / "made.jsonl"
        out.unlink(missing_ok=True)
        status, text, errors = tandem(
            f"run --mesh {path} --device host --algorithm tiled --no-check --no-count --truth none "
            f"--repeat 1 --quiet --out {out}",
            *options,
        )
        if status != 0:
            self.assertEqual((status, len(errors)), (2, 1), (text, errors))
            self.assertEqual(re.findall(r"[^\x20-\x7e]", errors[0].replace(str(path), "")), [], errors)
            return errors[0]
        (record,) = self.records(out)
        return {
            "tetrahedra": record["scene"]["tetrahedra"],
            **{name: record["scene"]["reading"][name] for name in COUNTS},
        }

    def expect_read(self, path, content, counts):
        options = OPTIONS.get(content, [])
        if options and counts["reduced"] + counts["other_cells"] > 0:
            self.assertIn(options[0], self.run_on(path))
        self.assertEqual(self.run_on(path, *options), counts)

    def expect_conversion(self, path, content, counts):
        """Returns whether meshio reads the file."""
        output = path.with_name(path.name + ".vtu")
        status, text, errors = tandem("convert", path, "-o", output)
        if status != 0:
            self.assertEqual((status, len(errors)), (2, 1), (text, errors))
            return False
        self.expect_read(output, content, counts)
        return True

    def test_made_meshes(self):
        read = converted = refused = 0
        for name, entry in self.expected.items():
            path, content = self.made / name, entry["content"]
            counts = {key: entry[key] for key in ("tetrahedra", *COUNTS)}
            with self.subTest(name):
                if path.suffix in READ:
                    self.expect_read(path, content, counts)
                    read += 1
                    continue
                self.assertIn("tandem convert", self.run_on(path))
                if path.suffix in CONVERTED and self.expect_conversion(path, content, counts):
                    converted += 1
                else:
                    refused += 1
        print(f"{read} meshes of Gmsh read, {converted} refused and converted, {refused} refused")
        self.assertGreaterEqual(read, 60)
        self.assertGreaterEqual(converted, 9)
