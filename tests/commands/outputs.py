# SPDX-License-Identifier: MIT
# test: cost=60
"""No output of a command overwrites an input or a file of records, and places that
cannot be written are found first."""

import json
import os
import shutil

from tests.program import SOURCE, Case, tandem, write_json

RECORDS = SOURCE / "results/h200/paper/records/convert.jsonl"
ONE = ("--device", "host", "--algorithm", "tiled", "--repeat", "1", "--quiet")


class Outputs(Case):
    def setUp(self):
        self.folder = self.work / self.id().rpartition(".")[2]
        self.folder.mkdir()
        self.mesh = self.folder / "mesh.msh"
        shutil.copy(self.good, self.mesh)
        self.records = self.folder / "records.jsonl"
        shutil.copy(RECORDS, self.records)

    def names(self, path):
        """The file under its own name, by a symbolic link, by a hard link and by a link to a link."""
        links = [self.folder / f"{kind}-{path.name}" for kind in ("symbolic", "hard", "twice")]
        links[0].symlink_to(path)
        os.link(path, links[1])
        links[2].symlink_to(links[0])
        return [path, *links]

    def kept(self, path, expected, *arguments, shown=None):
        """Runs a command that must refuse `path`, its input or a file of records, under every name.
        `arguments` are texts, or functions of the name. `shown`: the path in the message, if it is not the
        name."""
        before = path.read_bytes()
        for name in self.names(path):
            words = [argument(name) if callable(argument) else argument for argument in arguments]
            self.bad([str(shown or name), expected], *words)
            self.assertEqual(path.read_bytes(), before)
        for link in self.folder.glob(f"*-{path.name}"):
            link.unlink()
        self.assertEqual(list(self.folder.glob("*.partial")), [])

    def test_outputs_of_run(self):
        mesh = ("run", "--mesh", self.mesh, *ONE)
        needs = {
            "--dump-distances": ("--set", "contact_rule=distance"),
            "--dump-surfaces": ("--set", "contact_rule=pressure", "--pressure", 1),
        }
        for option in ("--dump-pairs", "--dump-contacts", *needs, "--trace", "--out"):
            given = (*mesh, *needs.get(option, ()))
            self.kept(self.mesh, "is an input", *given, option, lambda name: name)
            if option != "--out":
                self.kept(self.records, "is a file of records", *given, option, lambda name: name)
        scene = self.folder / "scene.json"
        scene.write_text(
            json.dumps({"frames": 1, "meshes": {"a": {"file": "mesh.msh"}}, "bodies": [{"mesh": "a"}]}) + "\n"
        )
        for path in (scene, self.mesh):
            self.kept(path, "an input", "run", scene, *ONE, "--dump-pairs", lambda name: name)
        self.kept(scene, "an input", "run", scene, *ONE, "--out", lambda name: name)
        plan = self.folder / "plan.json"
        plan.write_text('{"plan": "one cell", "scenes": ["plates"], "frames": "20"}\n')
        self.kept(plan, "an input", "run", plan, *ONE, "--out", lambda name: name)

    def test_outputs_of_export(self):
        recording = self.folder / "fall.frames"
        self.assertEqual(
            tandem("simulate", "glasses:bodies=2,size=2", "--steps", "2", "-o", recording, "--quiet")[0], 0
        )
        self.kept(recording, "is an input", "export", recording, "--glb", lambda name: name)
        self.kept(recording, "is an input", "view", recording, "-o", lambda name: name)
        for option in ("--glb", "--geometry", "--chunks"):
            self.kept(self.mesh, "is an input", "export", "--mesh", self.mesh, option, lambda name: name)
            self.kept(
                self.records, "is a file of records", "export", "--mesh", self.mesh, option, lambda name: name
            )
        self.assertEqual(tandem("export", "--mesh", self.mesh, "--vtu", self.folder / "vtu")[0], 0)
        own = self.folder / "vtu/bodies_000000.vtu"
        self.kept(own, "is an input", "export", "--mesh", lambda name: name, "--vtu", own.parent, shown=own)
        self.kept(self.records, "is an input", "export", self.records, "--csv", lambda name: name)
        other = self.folder / "other.jsonl"
        shutil.copy(self.records, other)
        self.kept(other, "is a file of records", "export", self.records, "--csv", lambda name: name)

    def test_outputs_of_simulate(self):
        scene = self.folder / "scene.json"
        scene.write_text(
            json.dumps(
                {
                    "frames": 1,
                    "meshes": {"a": {"builtin": "jack"}},
                    "bodies": [{"mesh": "a"}],
                    "dynamics": {
                        "materials": {"stone": 1000},
                        "surfaces": [{"a": "stone", "b": "stone", "friction": 0.5, "restitution": 0}],
                    },
                }
            )
            + "\n"
        )
        self.kept(
            scene, "an input", "simulate", scene, "--steps", "1", "--quiet", "--record", lambda name: name
        )
        self.kept(
            self.records, "exists", "simulate glasses:bodies=2,size=2 --steps 1 --quiet -o", lambda name: name
        )

    def test_pages(self):
        plan = RECORDS
        self.kept(self.records, "is an input", "report", self.records, "-o", lambda name: name)
        self.kept(self.records, "is a file of records", "report", plan, "-o", lambda name: name)
        self.kept(
            self.records, "is an input", "report", plan, "--against", self.records, "-o", lambda name: name
        )
        self.kept(self.mesh, "is an input", "view", "--mesh", self.mesh, "-o", lambda name: name)
        self.kept(
            self.records, "is a file of records", "view", "plates", "--frames", "20", "-o", lambda name: name
        )
        scene = self.folder / "scene.json"
        write_json(scene, frames=1, meshes={"a": {"file": "mesh.msh"}}, bodies=[{"mesh": "a"}])
        self.kept(self.mesh, "is no HTML page", "view", scene, "-o", lambda name: name)
        self.kept(self.mesh, "is no HTML page", "report", plan, "--scene", scene, "-o", lambda name: name)

    def test_pages_replace_pages_only(self):
        note = self.folder / "note.html"
        note.write_text("<p>mine</p>")
        for command in (("view", "plates", "--frames", "20"), ("report", RECORDS)):
            self.kept(note, "exists and is no HTML page", *command, "-o", lambda name: name)
        for text in ("", "<!DOCTYPE html>"):
            note.write_text(text)
            self.output("view plates --frames 20 -o", note)
            self.assertGreater(note.stat().st_size, 10_000)

    def test_folders_of_pages_and_figures(self):
        for name, command in (
            ("index.html", ("paper", "--device", "host", "--steps", "1", "-o")),
            ("bars.svg", ("accuracy", "plates", "--frames", "20", *ONE, "--figures")),
        ):
            folder = self.folder / name.partition(".")[0]
            folder.mkdir()
            self.assertTrue(self.records.exists())
            os.link(self.records, folder / name)
            before = self.records.read_bytes()
            self.bad([name, "is a file of records"], *command, folder)
            self.assertEqual(self.records.read_bytes(), before)
            self.assertEqual([path.name for path in folder.iterdir()], [name])

    def test_two_outputs_are_two_files(self):
        empty, link = self.folder / "empty.csv", self.folder / "link.csv"
        empty.touch()
        os.link(empty, link)
        self.bad(
            "is another output",
            f"run --mesh {self.mesh}",
            *ONE,
            f"--dump-pairs {empty} --dump-contacts {link}",
        )

    def test_records_are_appended(self):
        for _ in range(2):
            self.assertEqual(tandem("run", "--mesh", self.mesh, *ONE, "--out", self.records)[0], 0)
        whole = self.records.read_bytes()
        self.assertTrue(whole.startswith((RECORDS).read_bytes()))

    def test_places_that_cannot_be_written(self):
        long, missing = self.folder / ("n" * 250), self.folder / "missing/output"
        plan = RECORDS
        commands = [
            ("run", "--mesh", self.mesh, *ONE, option) for option in ("--out", "--dump-pairs", "--trace")
        ]
        commands += [
            ("export", "--mesh", self.mesh, option) for option in ("--glb", "--geometry", "--chunks")
        ]
        commands += [
            ("simulate", "glasses:bodies=2,size=2", "--steps", "1", "--quiet", option)
            for option in ("-o", "--record")
        ]
        commands += [
            ("report", plan, "-o"),
            ("view", "plates", "--frames", "20", "-o"),
            ("export", plan, "--csv"),
        ]
        for command in commands:
            for path, reason in (
                (missing, "No such file or directory"),
                (self.folder / ("n" * 256), "File name too long"),
            ):
                self.bad([str(path), "cannot be written", reason], *command, path)
        for command in [commands[0], *commands[6:10]]:  # a file beside the output has a longer name
            self.bad([str(long), "File name too long"], *command, long)
            self.assertFalse(long.exists())
        for command in (
            ("report", plan, "-o"),
            ("view", "plates", "--frames", "20", "-o"),
            ("export", plan, "--csv"),
        ):
            self.bad("is a folder", *command, self.folder)
