# SPDX-License-Identifier: MIT
# test: cost=13 full=20 needs=TANDEM_BUILDS_PYTHON
"""The package around tandem.Collider: its examples, its stubs, what an
import loads. Prints the cost of a call next to the program's frame."""

import ast
import json
import operator
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import textwrap
import time

from tests.collider.case import DEVICES, FOLDER, ColliderCase, tandem
from tests.program import LONG, SOURCE, Case, ran


class Map(ColliderCase):
    """The text of help(tandem)."""

    def test_names_everything_that_is_public_and_nothing_else(self):
        rows = re.findall(r"(?m)^    tandem\.([\w.]+)  +\S", tandem.__doc__)
        self.assertEqual(sorted(row for row in rows if "." not in row), tandem.__all__)
        for row in rows:
            self.assertTrue(operator.attrgetter(row)(tandem).__doc__, row)

    def test_its_example_runs(self):
        for file, name in zip(self.files, "ab"):
            shutil.copy(file, self.work / f"{name}.msh")
        example = textwrap.dedent(re.search(r"(?m)(^    .*\n)+", tandem.__doc__)[0])
        self.assertEqual(len(example.splitlines()), 3)
        done = ran(
            [sys.executable, "-c", f"import tandem\n{example}"],
            cwd=self.work,
            env={**os.environ, "PYTHONPATH": FOLDER.name},
        )
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertRegex(done.stdout, r"^\[\[ *0 ")


class Example(ColliderCase):
    def example(self, *arguments, code=0, script="collide.py"):
        done = ran(
            [sys.executable, SOURCE / "scripts/examples" / script, *map(str, arguments)],
            cwd=self.work,
            env={**os.environ, "PYTHONPATH": FOLDER.name},
        )
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1 if code else 0, done.stderr)
        return done.stdout + done.stderr

    def test_draws_contacts(self):
        self.assertRegex(self.example(), r"\d{2,} contacts")
        self.assertGreater((self.work / "collide.png").stat().st_size, 10000)
        self.example(*self.files, "--shift", "0.125,0,0.0625", "-o", "other.png")
        self.assertTrue((self.work / "other.png").exists())
        self.assertIn("no contacts to draw", self.example(*self.files, "--shift", "99,0,0"))
        for arguments in (
            (self.files[0],),
            (self.files[0], "nowhere.msh"),
            ("--shift", "1,x"),
            ("--device", "hst"),
        ):
            self.assertTrue(self.example(*arguments, code=2).startswith("collide.py: "))

    def test_worlds_of_boxes(self):
        for device in DEVICES:
            text = self.example(20, 4, device, script="worlds.py")
            self.assertRegex(text, r"\d{2,} candidate pairs and \d{2,} contacts in 20 worlds of 4 boxes")
            self.assertRegex(text, rf"ms per call, [\d.]+ us per world, on {device}")

    def test_worlds_of_grippers(self):
        """With PyTorch's tensors where it is installed."""
        text = self.example(20, "host", script="grippers.py")
        self.assertIn("step 1: 0 of 40 fingers touch, no force", text)
        self.assertRegex(text, r"step 10: 40 of 40 fingers touch, mean force [1-9][\d.]*, [\d.]+ ms")
        self.assertTrue(self.example(0, code=1, script="grippers.py").startswith("grippers.py: "))

    def test_the_cost_of_a_call_is_printed(self):
        text = self.example(
            "plates:count=2", "--frames", "60:61", "--rounds", 1, "--arrays", "all", script="call_cost.py"
        )
        self.assertRegex(
            text,
            r"arrays of numpy, 2 frames, 1 rounds: call [\d.]+ us, library's frame [\d.]+ us, overhead [\d.]+ us; conversion of pairs",
        )
        self.assertRegex(
            text,
            r"3 arrays, called from Python: __dlpack_device__ [\d.]+ us, __dlpack__ [\d.]+ us; without DLPack's table",
        )
        self.assertTrue(
            self.example("plates", "--frames", "60", code=2, script="call_cost.py").startswith(
                "call_cost.py: "
            )
        )


class Package(Case):
    def test_without_the_compiled_part(self):
        """Records are readable without it; missing names explain how to get them."""
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(
                SOURCE / "python/tandem",
                pathlib.Path(folder) / "tandem",
                ignore=shutil.ignore_patterns("__pycache__"),
            )
            code = (
                "import tandem\nfrom tandem import *\nassert read and 'Collider' not in tandem.__all__\n"
                "for name in ('Collider', 'devices'):\n    try: getattr(tandem, name)\n    except ImportError as error: print(error)\n"
            )
            done = ran([sys.executable, "-c", code], cwd=folder, env={**os.environ, "PYTHONPATH": folder})
        self.assertEqual(done.stderr, "")
        self.assertEqual(
            [line.partition(" needs the compiled part")[0] for line in done.stdout.splitlines()],
            ["tandem.Collider", "tandem.devices"],
        )
        self.assertIn("pip install .", done.stdout)

    def test_importing_loads_only_what_is_needed(self):
        code = "import sys, tandem; tandem.Collider; assert 'pandas' not in sys.modules and 'matplotlib' not in sys.modules"
        subprocess.run(
            [sys.executable, "-c", code], check=True, env={**os.environ, "PYTHONPATH": FOLDER.name}
        )

    def test_stubs_name_everything(self):
        from tandem import _core

        stub = ast.parse((SOURCE / "python/tandem/_core.pyi").read_text())
        named = {}
        for node in stub.body:
            if isinstance(node, ast.ClassDef):
                named[node.name] = {
                    inner.name
                    for inner in node.body
                    if isinstance(inner, ast.FunctionDef) and not inner.name.startswith("_")
                }
            elif isinstance(node, ast.FunctionDef):
                named[node.name] = set()
        exported = {
            name: {inner for inner in vars(value) if not inner.startswith("_")}
            if isinstance(value, type)
            else set()
            for name, value in vars(_core).items()
            if not name.startswith("_")
        }
        self.assertEqual(named, exported)
        self.assertTrue((SOURCE / "python/tandem/py.typed").exists())
        for name in tandem.__all__:
            self.assertTrue(getattr(tandem, name).__doc__, name)

    def test_the_cost_of_a_call(self):
        """Printed, not checked: times on a busy machine mean nothing."""
        name, last, rounds = ("plates", 69, 5) if LONG else ("plates:count=2", 62, 2)
        scene = tandem.make_scene(name)
        for device in DEVICES:
            collider = tandem.Collider(scene.meshes, device=device, bodies=scene.bodies, deformable=True)
            frames = [scene.vertices(i) for i in range(60, last + 1)]
            whole, within = min(self.replay(collider, frames) for _ in range(rounds))
            out = pathlib.Path(FOLDER.name) / f"cost-{device}.jsonl"
            self.output(
                f"run {name} --frames 60:{last} --algorithm tiled --device {device} --repeat {rounds} "
                f"--no-check --no-count --out {out}"
            )
            program = min(json.loads(out.read_text().splitlines()[0])["total_ns"]["samples"]) / len(frames)
            print(
                f"\n  {name} on {device}, us per frame: {1e6 * whole:.0f} by Collider.run, of which {1e6 * (whole - within):.1f} are the call's; "
                f"{program * 1e-3:.0f} by tandem run",
                end="",
                file=sys.stderr,
            )

    @staticmethod
    def replay(collider, frames):
        """Seconds per frame, of the calls and within the library."""
        begin, within = time.perf_counter(), 0.0
        for frame in frames:
            within += collider.run(vertices=frame).seconds
        return (time.perf_counter() - begin) / len(frames), within / len(frames)
