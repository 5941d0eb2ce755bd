# SPDX-License-Identifier: MIT
# test: cost=20 full=50
"""Errors against the exact truth: tandem accuracy, --truth, figures."""

import csv
import json
import shutil
import xml.etree.ElementTree

from tests.program import LONG, PROGRAM, Case, bar, gmsh, ran, tandem

SVG = "{http://www.w3.org/2000/svg}"


class Accuracy(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.shifted = gmsh(cls.work / "shifted.msh", *bar(4, (0.75, 0, 0)))
        cls.two = ("--mesh", cls.good, "--mesh", cls.shifted)

    def run_two(self, name, *arguments, command="run"):
        out = self.work / f"{name}.jsonl"
        text = self.output(command, *self.two, "--device", "host", "--quiet", "--out", out, *arguments)
        return self.records(out), text

    def test_every_pair_is_compared_by_default(self):
        records, text = self.run_two("pairs", "--algorithm", "chunked")
        truth = records[0]["error"]["truth"]
        # Equal meshes of three cubes on each other: each of 18 tetrahedra coincides with one of the other
        # mesh.
        self.assertGreaterEqual(truth["overlapping"], 18)
        self.assertEqual(truth["missed_touching"] + truth["missed_overlapping"], 0)
        self.assertEqual(truth["false"] + truth["touching"] + truth["overlapping"], truth["candidates"])
        self.assertEqual(sum(map(sum, truth["decisions"])), truth["candidates"])
        meeting = truth["touching"] + truth["overlapping"]
        self.assertAlmostEqual(truth["missed_upper95"], 3 / meeting)
        self.assertAlmostEqual(truth["candidate_ratio"], truth["candidates"] / meeting)
        self.assertIsNone(truth["contacts"])
        self.assertIn(
            f"truth: 0 of {meeting} meeting pairs missed, {truth['false']} candidates do not meet",
            " ".join(text.split()),
        )
        records, text = self.run_two("none", "--algorithm", "chunked", "--truth", "none")
        self.assertIsNone(records[0]["error"]["truth"])
        self.assertNotIn("truth", text)

    def test_contacts_are_compared_on_request_and_samples_are_marked(self):
        records, _ = self.run_two("contacts", "--algorithm", "chunked", "--truth", "contacts")
        contacts = records[0]["error"]["truth"]["contacts"]
        self.assertTrue(contacts["complete"])
        self.assertEqual(contacts["overlapping"], records[0]["error"]["truth"]["overlapping"])
        self.assertLess(contacts["point"]["max"], 1e-6)
        self.assertEqual(records[0]["error"]["truth"]["drift"]["max"], 0)  # identity poses
        for rule in ("sat", "clip"):  # these rules find all vertices of every intersection
            records, _ = self.run_two(
                rule, "--algorithm", "chunked", "--truth", "contacts", "--set", f"contact_rule={rule}"
            )
            own = records[0]["error"]["truth"]["contacts"]
            self.assertEqual((own["no_volume"], own["unanswered"]), (0, 0))
            self.assertLess(own["volume_relative"]["max"], 1e-4)
        self.assertEqual(
            contacts["volume_relative"]["max"], 1
        )  # opposing drops some contacts because of their depth
        records, _ = self.run_two(
            "sample", "--algorithm", "chunked", "--truth", "contacts", "--truth-contacts", 5
        )
        contacts = records[0]["error"]["truth"]["contacts"]
        self.assertEqual((contacts["complete"], contacts["overlapping"]), (False, 5))

    def test_contacts_without_interior_tetrahedra(self):
        out = self.work / "interior.jsonl"
        common = (f"run plates --frames 20 --device host --algorithm tiled --repeat 1 --quiet --out {out}",)
        for output, truth in (("pairs", "contacts"), ("contacts", "contacts"), ("contacts", "")):
            self.output(
                *common,
                f"--set output={output}",
                *(["--truth", truth, "--truth-contacts", 50] if truth else []),
            )
        pairs, contacts, default = self.records(out)
        self.assertEqual(pairs["work"]["contact_digest"], contacts["work"]["contact_digest"])
        self.assertLess(contacts["work"]["candidate_pairs"][0], pairs["work"]["candidate_pairs"][0])
        self.assertEqual(pairs["work"]["walked_tetrahedra"], pairs["scene"]["tetrahedra"])
        self.assertLess(contacts["work"]["walked_tetrahedra"], pairs["work"]["walked_tetrahedra"])
        self.assertEqual(contacts["work"]["without_boundary"], 0)
        self.assertNotEqual(pairs["key"], contacts["key"])
        for record in (pairs, contacts, default):
            self.assertEqual(
                (record["status"], record["agreement"]["missing"], record["agreement"]["extra"]), ("ok", 0, 0)
            )
        truth = contacts["error"]["truth"]
        self.assertEqual(truth["missed_touching"] + truth["missed_overlapping"], 0)
        self.assertEqual(truth["candidates"], contacts["work"]["candidate_pairs"][0])
        self.assertEqual(truth["contacts"]["overlapping"], 50)
        self.assertLess(truth["overlapping"], pairs["error"]["truth"]["overlapping"])
        self.assertIsNone(default["error"]["truth"])  # the default truth is of all pairs
        self.assertGreater(pairs["preparation"]["device_bytes"], contacts["preparation"]["device_bytes"])

    def test_what_rounding_changed_is_counted(self):
        """Bodies far from the world's origin by their poses, in float."""
        first, second = (
            f"{6.4e6 + 0.1} {-1.9e6} 0.3 0.9 0.1 0.3 0.2",
            f"{6.4e6 + 0.7} {-1.9e6} 0.4 0.7 0.4 0.6 0.2",
        )
        far = ("--pose", first, "--pose", second)
        words = "truth: 0 of {} meeting pairs missed, {} candidates do not meet; rounding of vertices lost {} of {} pairs that meet by the input, and added {}"
        found = {}
        for name, poses, *settings in (
            ("near", ()),
            ("far", far),
            ("world", far, "origin=world"),
            ("exact", far, "origin=world", "placement=exact"),
            ("double", far, "origin=world", "precision=double"),
        ):
            records, text = self.run_two(
                f"rounding-{name}",
                "--algorithm tiled --truth contacts",
                *poses,
                *(word for one in settings for word in ("--set", one)),
            )
            truth, rounding = records[0]["error"]["truth"], records[0]["error"]["rounding"]
            meeting = truth["touching"] + truth["overlapping"]
            self.assertEqual(truth["missed_touching"] + truth["missed_overlapping"], 0)
            numbers = truth["false"], rounding["lost"], rounding["meeting"], rounding["extra"]
            self.assertIn(words.format(meeting, *numbers), " ".join(text.split()))
            self.assertEqual(meeting - rounding["extra"], rounding["meeting"] - rounding["lost"])
            found[name] = rounding
        near, world, exact = (found[name] for name in ("near", "world", "exact"))
        self.assertEqual((near["lost"], near["extra"], near["missed"], near["depth_change"]), (0, 0, 0, 0))
        self.assertGreater(min(world["lost"], world["extra"], world["depth_change"]), 0)
        self.assertLessEqual(world["missed"], world["lost"])
        self.assertEqual((exact["lost"], exact["extra"], exact["missed"]), (0, 0, 0))
        self.assertEqual(exact["meeting"], world["meeting"])
        self.assertGreater(exact["depth_change"], 0)
        for name in ("far", "double"):
            limit = 1e-6 if name == "double" else 1e-4
            self.assertLess(found[name]["depth_change"], limit * world["depth_change"])
        _, text = self.run_two(
            "rounding-check", *far, "--set origin=world --preset resident --algorithm tiled", command="check"
        )
        self.assertIn(
            f"1 cell: rounding of vertices lost {world['lost']} of {world['meeting']} pairs that meet by the input, and added {world['extra']}",
            text,
        )
        out = self.work / "rounding-motion.jsonl"
        status, text, _ = tandem(
            "run pile:bodies=2,mesh=grain1,frames=2 --frames 0 --device host --algorithm tiled "
            f"--set motion=linear --set contact_rule=none --repeat 1 --quiet --out {out}"
        )
        self.assertEqual(status, 0, text)
        self.assertIsNone(self.records(out)[0]["error"]["rounding"])
        self.assertNotIn("rounding of vertices", text)

    def test_check_shows_missed_and_false(self):
        _, text = self.run_two("check", "--algorithm", "chunked", "--preset", "grouped", command="check")
        head, row = text.splitlines()[-4:-2]
        self.assertEqual(head.split()[-3:], ["missed", "false", "lost"])
        self.assertEqual((row.split()[-3], row.split()[-1]), ("0", "0"))

    def test_accuracy_sweeps_bounds_and_contacts_over_scenes(self):
        out = self.work / "sweep.jsonl"
        scenes = (
            ("pile:bodies=2,frames=1", "plates") if LONG else ("pile:bodies=8,frames=1,mesh=grain1", "arch")
        )
        self.output(
            "accuracy", *scenes, f"--frames 0 --device host --repeat 1 --truth-contacts 3 --quiet --out {out}"
        )
        records = self.records(out)
        self.assertEqual({r["scene"]["name"] for r in records}, {scene.split(":")[0] for scene in scenes})
        settings = [json.dumps([r["scene"]["name"], r["settings"]]) for r in records]
        self.assertEqual(len(settings), len(set(settings)))
        for name, values in (("k", {"6", "8", "14", "18", "26"}), ("precision", {"float", "double"})):
            self.assertEqual({r["settings"][name] for r in records}, values)
        self.assertLessEqual({"safe", "nearest"}, {r["settings"]["rounding"] for r in records})
        for record in records:
            truth = record["error"]["truth"]
            if record["settings"]["rounding"] == "safe":
                self.assertEqual(truth["missed_touching"] + truth["missed_overlapping"], 0)
        ratio = {
            r["settings"]["k"]: r["error"]["truth"]["candidate_ratio"]
            for r in records
            if r["scene"]["name"] == "pile"
            and r["settings"]["rounding"] == "safe"
            and r["settings"]["precision"] == "float"
        }
        self.assertGreater(ratio["6"], ratio["18"])
        self.assertGreater(ratio["18"], ratio["26"])

    def test_hard_families_are_spread_over_their_difficulties(self):
        out = self.work / "hard.jsonl"
        status, text, errors = tandem(
            "accuracy hard:all:pairs=4,together=2 --device host --set k=8 --set rounding=published "
            f"--repeat 1 --truth-contacts 1 --quiet --out {out}"
        )
        self.assertEqual(status, 0, text)
        records, difficulties = self.records(out), {}
        self.assertEqual(
            [
                line.split(": nothing can meet: there is one body, which setting self=off")[0]
                for line in errors
            ],
            [
                f"tandem: scene {record['scene']['name']}"
                for record in records
                if record["scene"]["bodies"] == 1
            ],
        )
        for record in records:
            family, rest = record["scene"]["key"].removeprefix("hard:").split(":")
            difficulties.setdefault(family, []).append(float(rest.split("difficulty=")[1].split(",")[0]))
        self.assertGreater(len(difficulties), 38)
        self.assertNotIn("not-finite", difficulties)
        self.assertEqual(len(difficulties["slab-touch"]), 5)
        self.assertEqual((difficulties["slab-touch"][0], difficulties["slab-touch"][-1]), (1, 1e6))
        self.assertEqual(len(difficulties["all-overlap"]), 1)
        self.assertTrue(all(values == sorted(set(values)) for values in difficulties.values()), difficulties)

    def test_given_settings_are_the_only_cells(self):
        records, text = self.run_two("given", "--set", "k=8,18", "--repeat", 1, command="accuracy")
        self.assertEqual([r["settings"]["k"] for r in records], ["8", "18"])
        self.assertEqual(text.count("on host"), 2)
        header, row = (
            next(line for line in text.splitlines() if mark in line) for mark in ("  cell", "k=8 on host")
        )
        shown = row.split()[header.split().index("volume") - 1]  # "no answer" is two words
        self.assertEqual(
            float(shown), float(f"{records[0]['error']['truth']['contacts']['volume_relative']['p99']:.3g}")
        )
        self.assertEqual(text.count("MISSES"), 1)  # in the legend

    def test_the_truth_works_without_the_reference(self):
        for arguments, checked in ((), True), (("--no-check",), False):
            records, _ = self.run_two(
                f"checked{checked}", "--set", "k=8", "--repeat", 1, *arguments, command="accuracy"
            )
            self.assertEqual([r["agreement"] is not None for r in records], [checked])
            self.assertGreater(records[0]["error"]["truth"]["candidates"], 0)

    def recorded(self, name):
        """A file with the records of two values of k."""
        self.run_two(name, "--set", "k=8,18", "--repeat", 1, command="accuracy")
        return self.work / f"{name}.jsonl"

    def test_figures_draw_records(self):
        path = self.recorded("figures")
        records, folder = self.records(path), self.work / "figures"
        done = ran(["/usr/bin/python3", PROGRAM.parent / "libexec/tandem/figures", path, folder])
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in ("pareto", "bars"):
            drawing = xml.etree.ElementTree.parse(folder / f"{name}.svg")
            self.assertGreater(len(list(drawing.iter(f"{SVG}path"))), 10)
            rows = list(csv.DictReader((folder / f"{name}.csv").read_text().splitlines()))
            self.assertEqual([row["k"] for row in rows], ["8", "18"])
            self.assertEqual(
                [int(row["candidates"]) for row in rows], [r["error"]["truth"]["candidates"] for r in records]
            )
            self.assertEqual(
                [float(row["volume_p99_relative"]) for row in rows],
                [r["error"]["truth"]["contacts"]["volume_relative"]["p99"] for r in records],
            )
        empty = self.work / "no.jsonl"
        empty.write_text("")
        done = ran(["/usr/bin/python3", PROGRAM.parent / "libexec/tandem/figures", empty, folder])
        self.assertEqual(
            (done.returncode, done.stderr), (2, f"tandem: {empty}: is empty; name a file of records\n")
        )

    def test_accuracy_draws(self):
        """With --out it draws the records of that file; otherwise those beside the figures, including old ones."""
        folder = self.work / "drawn figures" / "figures"
        rows = lambda: [row["k"] for row in csv.DictReader((folder / "pareto.csv").read_text().splitlines())]
        draw = lambda *more: tandem(
            "accuracy", *self.two, "--device", "host", "--quiet", "--repeat", 1, "--figures", folder, *more
        )
        folder.mkdir(parents=True)
        shutil.copy(self.recorded("drawn"), folder / "accuracy.jsonl")
        status, text, errors = draw("--set", "k=14")
        self.assertEqual((status, errors), (0, []), text)
        self.assertRegex(text.splitlines()[-1], r"^3 records drawn: bars\.svg, pareto\.svg in ")
        self.assertEqual(rows(), ["8", "18", "14"])
        self.assertEqual(len(self.records(folder / "accuracy.jsonl")), 3)
        self.assertEqual(draw("--set", "k=26", "--out", self.work / "beside.jsonl")[0], 0)
        self.assertEqual(rows(), ["26"])
        (self.work / "beside.jsonl").write_text('{"no": "record"}\n')
        status, _, errors = draw("--set", "k=26", "--out", self.work / "beside.jsonl")
        self.assertEqual((status, len(errors)), (2, 2), errors)
        self.assertIn("beside.jsonl:1: is no record", errors[0])
        self.assertIn("nothing drawn; the records are in", errors[1])
        (self.work / "broken").mkdir()
        (self.work / "broken/matplotlib.py").write_text("raise ImportError\n")
        self.bad(
            "--figures needs python3 with matplotlib; install python3-matplotlib",
            "accuracy",
            *self.two,
            f"--device host --figures {folder}",
            environment={"PYTHONPATH": str(self.work / "broken")},
        )
        self.bad(
            "--figures: cannot make /dev/null/figures",
            "accuracy",
            *self.two,
            "--device host --figures /dev/null/figures",
        )

    def test_bad_use(self):
        self.bad("no scene", "accuracy", "--device", "host")
        self.bad("--truth some: give none, pairs or contacts", "run", "plates", "--truth", "some")
        self.bad("--truth-contacts", "accuracy", "plates", "--truth-contacts", 0)
        self.bad("the nearest is 'plates'", "accuracy", "plats", "--device", "host")
        self.bad(
            "frames 3:900", "accuracy", "plates", "--frames", "3:900", "--device", "host", "--set", "k=8"
        )
