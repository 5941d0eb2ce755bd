# SPDX-License-Identifier: MIT
# test: cost=40 full=20 needs=TANDEM_BUILDS_PYTHON
"""The cells of python/example.ipynb run, and the committed outputs are those of
scripts/notebook: of every cell the same kinds, and the same texts where no time is measured. They name no
path or host of the machine."""

import json
import os
import re
import shutil
import socket
import sys

from tests.collider.case import FOLDER
from tests.program import PROGRAM, SOURCE, Case, ran

MEASURED = "measured"  # the name of times of this machine


def cells(notebook):
    return [cell for cell in json.loads(notebook.read_text())["cells"] if cell["cell_type"] == "code"]


def outputs(cell):
    """The kind, the representations and the text of each output."""
    return [
        (
            one["output_type"],
            sorted(one.get("data", {})),
            "".join(one.get("text", one.get("data", {}).get("text/plain", ""))),
        )
        for one in cell["outputs"]
    ]


class Notebook(Case):
    def run_cells(self):
        """Runs a copy of the notebook, beside copies of what it reads."""
        root = self.work / "checkout"
        for name in ("python/example.ipynb", "scripts/notebook"):
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(SOURCE / name, root / name)
        (root / "results").symlink_to(SOURCE / "results")
        (root / "tests").symlink_to(SOURCE / "tests")
        (root / "build").mkdir()
        (root / "build/tandem").symlink_to(PROGRAM)
        out = self.work / "out.ipynb"
        done = ran(
            [sys.executable, root / "scripts/notebook", "--out", out],
            env={**os.environ, "PYTHONPATH": FOLDER.name},
        )
        self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
        return out

    def test_committed_outputs_are_those_of_its_cells(self):
        committed, made = cells(SOURCE / "python/example.ipynb"), cells(self.run_cells())
        self.assertEqual(len(committed), len(made))
        self.assertGreater(len(committed), 10)
        for count, (old, new) in enumerate(zip(committed, made), start=1):
            source = "".join(old["source"])
            with self.subTest(source):
                self.assertEqual(old["execution_count"], count)
                mine, expected = outputs(old), outputs(new)
                if MEASURED in source:
                    mine, expected = ([row[:2] for row in rows] for rows in (mine, expected))
                self.assertEqual(mine, expected)
                self.assertTrue(old["outputs"], "the output is committed")

    def test_uses_the_collider(self):
        sources = "".join("".join(cell["source"]) for cell in cells(SOURCE / "python/example.ipynb"))
        for call in (
            "tandem.Collider(",
            ".pairs()",
            ".meeting()",
            ".contacts()",
            ".update(",
            "worlds=",
            '"run"',
        ):
            self.assertIn(call, sources)

    def test_shows_pictures(self):
        """Of the scene, its contacts, the times of cells and frames, stages and a sweep."""
        for call in (
            "draw(axes, table, ",
            ".scatter(*contacts.points",
            "pyplot.plot(heights",
            "plot_cells(measured",
            "plot_cells(plates",
            "plot_stages(",
            "plot_frames(",
            "plot_sweep(",
        ):
            (pictures,) = (
                [one["data"]["image/png"] for one in cell["outputs"] if "image/png" in one.get("data", {})]
                for cell in cells(SOURCE / "python/example.ipynb")
                if call in "".join(cell["source"])
            )
            self.assertEqual(len(pictures), 1, call)
            self.assertGreater(len(pictures[0]), 10000, call)
        self.assertLess((SOURCE / "python/example.ipynb").stat().st_size, 500_000)

    def test_names_no_machine(self):
        text = json.dumps([outputs(cell) for cell in cells(SOURCE / "python/example.ipynb")])
        text += json.dumps(
            [
                one.get("data", {}).get("text/html", "")
                for cell in cells(SOURCE / "python/example.ipynb")
                for one in cell["outputs"]
            ]
        )
        self.assertIsNone(re.search(r"(/work|/tmp|/home|/root|/usr|/var|/Users)/", text))
        self.assertNotIn(socket.gethostname(), text)
