# SPDX-License-Identifier: MIT
# test: cost=7 full=50
"""'tandem report' and 'tandem view': errors and signals of the export of the scene, options, missing packages."""

import contextlib
import json
import os
import pathlib
import signal
import subprocess
import tempfile
import unittest
import unittest.mock

from tests.program import PROGRAM, SOURCE, Case, ran, tandem
from tests.report.case import Shown

from tandem import files
from tandem.report import scene
from tandem.report.data import data_of
from tandem.report.reading import read_records

H200 = SOURCE / "results/h200"


class Commands(Case):
    """The part of both commands that concerns the scene, which another process of the program exports."""

    def test_errors_of_the_export_are_the_only_line(self):
        ceilings, out = H200 / "paper/records/ceilings.jsonl", self.work / "none.html"
        for error, words in (
            ("the nearest is 'plates'", "view plats"),
            ("no scene; name one", "view"),
            ("frames 3:900", f"report {ceilings} --scene plates --frames 3:900"),
            ("--device all: contacts need one device", "view plates --contacts --device all"),
            (
                "more --pose than --mesh",
                f"view --mesh {self.good} --pose '1 0 0 1 0 0 0' --pose '0 0 0 1 0 0 0'",
            ),
            ("--every", "view plates --every 0"),
            ("--frames requires --scene", f"report {ceilings} --frames 0"),
        ):
            self.bad(error, words, "-o", out)
            self.assertFalse(out.exists())

    def test_sentences_of_the_page(self):
        """Those on each group and on all together, before the line that names the page. Its first charts say the same."""
        page = self.work / "words.html"
        status, out, errors = tandem("report", H200 / "plan.jsonl", "-o", page, "--sentences")
        self.assertEqual((status, errors), (0, []))
        *sentences, last = out.splitlines()
        self.assertEqual(sentences, data_of(read_records([H200 / "plan.jsonl"]), 7_000_000).sentences)
        self.assertGreater(len(sentences), 4)
        data = Shown(page.read_text()).json()
        titles = [data["overview"]["title"], *(group["stages"] for group in data["groups"])]
        self.assertEqual([title for title in titles if f"{title}." not in " ".join(sentences)], [])
        self.assertEqual(len(set(titles)), len(sentences))
        self.assertTrue(last.startswith(f"{page}: "))

    def without_packages(self, *words):
        """tandem report in a Python that has only NumPy, which scripts/setup installs for scripts/run."""
        text = (
            "import importlib.util, sys\nfind = importlib.util.find_spec\nwithout = ('pandas', 'scipy', 'matplotlib')\n"
            "sys.modules.update(dict.fromkeys(without))\nimportlib.util.find_spec = lambda name: None if name in without else find(name)\n"
            f"sys.path.insert(0, {str(SOURCE / 'python')!r})\nfrom tandem.commands import report\nsys.exit(report.main(sys.argv[2:], sys.argv[1]))"
        )
        environment = os.environ | {"TANDEM_PYTHON_TRIED": "1"}
        return ran(["/usr/bin/python3", "-c", text, PROGRAM, *words], env=environment)

    def test_one_session_needs_no_scipy(self):
        """Its verdict is recorded. Another verdict, and the verdict on a part of its cells, need scipy."""
        records, page = self.work / "session.jsonl", self.work / "numpy.html"
        chosen = ["--algorithm", "tiled,chunked", "--set", "seed_threshold=0,10,100", "--repeat", 5]
        status, text, errors = tandem("run", "plates", "--frames", "60:60", *chosen, "--out", records)
        self.assertEqual((status, errors), (0, []), text)
        done = self.without_packages(records, f"--output={page}", "--sentences")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertRegex(done.stdout, "^plates, .*: .* (is fastest|cannot be told apart): ")
        self.assertRegex(
            page.read_text(),
            r"grouped schedule: [\d.]+ ms per frame with seed_threshold = 0, [\d.]+ with 100",
        )
        more = [json.loads(line) for line in records.read_text().splitlines()]
        cells = [record | {"session": "another"} for record in more if "kind" not in record]
        records.write_text("".join(json.dumps(cell) + "\n" for cell in cells))
        done = self.without_packages(records, f"--output={page}")
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("tandem report needs python3 with scipy; install python3-scipy", done.stderr)

    def test_options_reach_the_export(self):
        page = self.work / "meshes.html"
        meshes = f"view --mesh {self.good} --mesh {self.good} --pose '-1 0 0 1 0 0 0' --contacts"
        status, out, errors = tandem(meshes, "-o", page)
        self.assertEqual((status, errors), (0, []))
        self.assertRegex(out, r"^.*meshes\.html: 1 frame of .*, 0\.9 MB\n$")
        scene = Shown(page.read_text()).json("scene")
        self.assertEqual((scene["bodies"], scene["frames"], len(scene["contacts"])), (2, [0], 1))
        status, out, _ = tandem("view", "plates", "--frames", "2:9", "--every", 3, "-o", page)
        self.assertRegex(out, r": 3 frames of plates")
        done = ran([PROGRAM, "view", "plates", "--frames", "0"], cwd=self.work)
        self.assertEqual((done.returncode, done.stderr, (self.work / "plates.html").exists()), (0, "", True))

    def end_group(self, group):
        """Cleans up after a failed test."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(group, signal.SIGKILL)

    def test_a_signal_ends_the_export_and_leaves_nothing(self):
        folder = self.work / "temporary"
        folder.mkdir()
        minutes = ("pile:bodies=2000,frames=300", "--contacts")
        process = subprocess.Popen(
            [PROGRAM, "view", *minutes, "-o", self.work / "ended.html"],
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "TMPDIR": str(folder)},
            start_new_session=True,
        )
        self.addCleanup(self.end_group, process.pid)
        while not any(folder.iterdir()) and process.poll() is None:
            pass
        process.terminate()
        _, errors = process.communicate()
        self.assertEqual((process.returncode, errors), (143, ""))
        self.assertEqual(list(folder.iterdir()), [])
        self.assertFalse((self.work / "ended.html").exists())

    def test_a_signal_before_the_export_starts(self):
        for number in (signal.SIGTERM, signal.SIGINT):
            late, made = [], []
            self.addCleanup(
                signal.signal,
                number,
                signal.signal(number, lambda *_, late=late: late.append("a handler of the test")),
            )

            def signalled(made=made, number=number, **options):
                made.append(tempfile.TemporaryDirectory(**options))
                os.kill(os.getpid(), number)
                return made[-1]

            with (
                unittest.mock.patch.object(
                    files, "tempfile", unittest.mock.Mock(TemporaryDirectory=signalled)
                ),
                self.assertRaises(scene.ExportEnded) as ended,
            ):
                scene.shown_scene(PROGRAM, ["plates", "--frames=0"])
            self.assertEqual(
                (ended.exception.code, late, pathlib.Path(made[0].name).exists()), (128 + number, [], False)
            )
