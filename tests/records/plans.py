# SPDX-License-Identifier: MIT
# test: cost=10
"""Plan files: the cells that they make, precedence of options, and errors."""

import json
import re

import jsonschema

from tests.program import SOURCE, Case, tandem

SMALL, LARGE = "plates:count=2", "pile:bodies=2,frames=3"
PLAN = {
    "plan": "two walks",
    "scenes": [SMALL, LARGE],
    "frames": 0,
    "algorithms": ["chunked", "tiled"],
    "devices": ["host"],
    "settings": {"k": [8, 18]},
    "measure": {"repeat": 1, "truth": "none"},
}


class PlanCase(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.schema = jsonschema.Draft7Validator(json.loads((SOURCE / "results/plan.schema.json").read_text()))

    def plan(self, **fields):
        """A file of PLAN with other fields; fields that are None are omitted."""
        path = self.work / "plan.json"
        path.write_text(
            json.dumps({name: value for name, value in {**PLAN, **fields}.items() if value is not None})
        )
        return path

    def is_valid(self, path):
        return not list(self.schema.iter_errors(json.loads(path.read_text())))

    def listed(self, path, *arguments):
        """(scene, frames, algorithm, k) of every cell that --dry-run lists; checks the plan against the schema."""
        self.assertTrue(self.is_valid(path), path.read_text())
        status, out, self.errors = tandem("run", path, *arguments, "--dry-run", "--keys")
        self.assertEqual(status, 0, (out, self.errors))
        return re.findall(r"(?m)^ +(\w+)\|[^|]+\|(\w+):[^|]*\|([\d:]+)\|.*,k=(\d+),", out)

    def refused(self, message, schema_agrees=True, **fields):
        path = self.plan(**fields)
        self.assertEqual(self.is_valid(path), not schema_agrees, path.read_text())
        self.bad(
            ["plan.json", *([message] if isinstance(message, str) else message)], "run", path, "--dry-run"
        )


class Plans(PlanCase):
    def test_a_product(self):
        cells = self.listed(self.plan())
        expected = [
            (a, s, "0:0", k) for s in ("plates", "pile") for a in ("chunked", "tiled") for k in ("8", "18")
        ]
        self.assertEqual(cells, expected)
        self.assertEqual(
            self.listed(self.plan(settings={"k": "8..18*1.5"}, scenes=SMALL, algorithms="tiled")),
            [("tiled", "plates", "0:0", k) for k in ("8", "12", "18")],
        )
        self.assertEqual(len(self.listed(self.plan(frames=["0", "1:2"], scenes=SMALL))), 8)

    def test_include_and_exclude(self):
        walk = {"algorithms": "gproximity"}
        path = self.plan(
            include=[{"scenes": SMALL, "frames": "3", **walk, "settings": {"k": None, "refill": "no"}}],
            exclude=[
                {"algorithms": "tiled", "settings": {"k": 8}},
                {"scenes": LARGE, "algorithms": ["chunked"]},
            ],
        )
        cells = "chunked plates 0:0 8,chunked plates 0:0 18,tiled plates 0:0 18,tiled pile 0:0 18"
        cells = [tuple(cell.split()) for cell in f"{cells},gproximity plates 3:3 18".split(",")]
        self.assertEqual(self.listed(path), cells)
        repeated = self.listed(self.plan(include=[{"scenes": SMALL, "settings": {"k": 18}}]))
        self.assertEqual(len(repeated), 8)
        self.assertIn("2 cells are named more than once", self.errors[0])
        self.assertEqual(len(self.listed(self.plan(scenes=SMALL, frames=["0", "0:0"]))), 4)
        everything = self.plan(exclude=[{"algorithms": ["tiled", "chunked"]}])
        self.bad("leaves out all 8 cells; none is left", "run", everything, "--dry-run")

    def test_the_command_line_takes_precedence(self):
        path = self.plan(exclude=[{"settings": {"k": 8}}])
        cells = self.listed(path, "--set k=24 --algorithm tiled --frames 2 --preset resident --device host")
        self.assertEqual(cells, [("tiled", scene, "2:2", "24") for scene in ("plates", "pile")])

    def test_it_is_measured_and_continued(self):
        out = self.work / "plan.jsonl"
        path = self.plan(measure={"repeat": 2, "truth": "none", "no-count": True})
        status, text, errors = tandem("run", path, "--repeat", 1, "--out", out)
        self.assertEqual(status, 0, errors)
        records = self.records(out)
        self.assertEqual([len(r["total_ns"]["samples"]) for r in records], [1] * 8)
        self.assertTrue(
            all(
                sum(r["work"]["candidate_pairs"]) > 0 and r["work"]["counters"]["bvtt_nodes"] is None
                for r in records
            ),
            records[0]["work"],
        )
        out.write_text("".join(out.read_text().splitlines(keepends=True)[:3]))
        status, text, _ = tandem("run", path, "--noise", "50%", "--out", out, "--resume")
        self.assertEqual(status, 0, text)
        records = self.records(out)
        self.assertEqual((len(records), len({r["key"] for r in records})), (8, 8))
        # a stopping criterion on the command line replaces all of the plan's
        self.assertIsNone(records[-1]["sampling"]["repeat"])

    def test_impossible_combinations(self):
        fields = {"scenes": SMALL, "algorithms": ["gproximity", "tiled"], "settings": {"batch": [0, 1]}}
        self.bad("goes with sizes=own, batch=0", "run", self.plan(**fields), "--dry-run")
        cells = self.listed(self.plan(**fields, impossible="skip"))
        self.assertEqual([cell[0] for cell in cells], ["gproximity", "tiled"])
        none = self.plan(scenes=SMALL, algorithms="tiled", settings={"k": 5}, impossible="skip")
        self.bad("no cell is possible: setting k=5 is impossible", "run", none, "--dry-run")
        self.assertIn("skipped 1 impossible combination: ", self.errors[0])
        far = {"meshes": {"box": {"box": [1e37, 1e37, 1e37]}}, "bodies": [{"mesh": "box"}, {"mesh": "box"}]}
        (self.work / "far.json").write_text(json.dumps(far))
        fields = {
            "scenes": [SMALL, "far.json"],
            "algorithms": "tiled",
            "settings": {"k": 18, "precision": ["float", "double"]},
        }
        self.bad("use precision=double", "run", self.plan(**fields), "--dry-run")
        self.assertEqual(
            [cell[1] for cell in self.listed(self.plan(**fields, impossible="skip"))],
            ["plates", "plates", "far"],
        )
        self.assertEqual(len(self.errors), 1)
        self.assertIn("skipped a cell: body 0", self.errors[0])

    def test_cells_that_differ_only_in_what_has_no_effect(self):
        """They are one cell: records with equal keys would contradict each other."""
        records = self.work / "equal.jsonl"
        given = "plates --frames 20 --algorithm tiled --no-check --no-count"
        for device, setting, kept in (
            ("host", "group_size=32,64", "group_size=32"),
            ("host", "slabs=touched,usual", "slabs=touched"),
            ("opencl:0", "threads=1,2", "threads=1"),
        ):
            with self.subTest(setting):
                words = (
                    "--device",
                    device,
                    "--set",
                    setting,
                    "--repeat",
                    1,
                    "--truth",
                    "none",
                    "--out",
                    records,
                )
                status, out, errors = tandem(f"run {given}", *words)
                self.assertEqual(status, 0, errors)
                self.assertEqual(len(errors), 1, errors)
                self.assertRegex(
                    errors[0], f"^tandem: skipped a cell: .+ on {device} has the settings of tiled {kept}"
                )
                self.assertEqual(len(records.read_text().splitlines()), 1)
                records.unlink()

    def test_devices_of_one_model_are_several_cells(self):
        """Keys have models, but each device is measured."""
        words = ("run plates --frames 20 --algorithm tiled --device opencl:0,opencl:1", "--dry-run")
        status, out, errors = tandem(*words, environment={"POCL_DEVICES": "pthread pthread"})
        self.assertEqual((status, errors), (0, []))
        self.assertEqual(re.findall(r"tiled on (\S+)", out), ["opencl:0", "opencl:1"])

    def test_scenes_that_do_not_exist_yet(self):
        path = self.plan(scenes=["to-be-made.frames", SMALL])
        status, text, errors = tandem("run", path, "--dry-run")
        self.assertEqual((status, len(errors)), (2, 1), errors)
        self.assertIn("4 cells cannot be listed: ", errors[0])
        self.assertIn("4 cells of unknown duration", text)
        self.bad("to-be-made.frames", "run", path)

    def test_options_and_the_plan(self):
        """The plan can provide what an option requires, and the command line overrides what it excludes."""
        path = self.plan(
            algorithms="auto",
            settings=None,
            scenes=SMALL,
            measure={"repeat": 1, "truth": "none", "isolate": True},
        )
        self.assertEqual(tandem("run", path, "--threads", 1, "--choose-seconds", 1, "--dry-run")[0], 0)
        self.bad("--threads requires --device host", "run", path, "--threads", 1, "--device", "opencl:0")
        self.bad(
            "--choose-seconds requires --algorithm auto", f"run {path} --choose-seconds 1 --algorithm tiled"
        )
        path = self.plan(
            algorithms="tiled",
            settings=None,
            scenes=SMALL,
            measure={"repeat": 1, "truth": "pairs", "isolate": True},
        )
        text = self.output("run", path, "--profile", 1)
        self.assertIn("replayed frames", text)
        self.refused(
            ["/measure", "--repeat cannot be combined with --noise"],
            measure={"repeat": 1, "noise": "1%"},
            schema_agrees=False,
        )
        for option, message in (
            ("--dump-pairs", "dumps need one scene"),
            ("--dump-contacts", "dumps need one scene"),
            ("--trace", "--trace needs one scene"),
        ):
            self.bad(message, "run", self.plan(settings=None), option, self.work / "of-both")
            self.bad(
                message,
                "run",
                self.plan(settings=None, scenes=SMALL, frames=["0", "1"]),
                option,
                self.work / "of-both",
            )

    def test_bad_plans(self):
        self.refused("unknown name 'algoritms'; the nearest is 'algorithms'", algoritms=["tiled"])
        self.refused(
            ["/include/0", "unknown name 'scene'; the nearest is 'scenes'"], include=[{"scene": SMALL}]
        )
        self.refused(["/settings/k", "is an empty list"], settings={"k": []})
        self.refused(["/scenes", "is an empty list"], scenes=[])
        self.refused("has no scenes", scenes=None, schema_agrees=False)
        self.refused(
            ["/exclude/0", "matches no cell"], exclude=[{"settings": {"k": 24}}], schema_agrees=False
        )
        self.refused(["/exclude/0", "matches every cell"], exclude=[{}])
        self.refused(["/settings/k", "never ends"], settings={"k": "18..8"}, schema_agrees=False)
        self.refused(["/settings/k/1", "must be a string or a number"], settings={"k": [8, True]})
        self.refused(["/settings/k", "no such setting to remove"], settings={"k": None}, schema_agrees=False)
        self.refused(["/impossible", "'refuse'"], impossible="refuses")
        self.refused(["/plan", "must be a string"], plan=3)
        self.refused(["/measure", "--noise"], measure={"noise": "much"}, schema_agrees=False)
        self.refused(["/measure", "unknown name 'repeats'; the nearest is 'repeat'"], measure={"repeats": 3})
        self.refused(["/measure/no-check", "must be true or false"], measure={"no-check": 1})
        self.bad("give no other scene or mesh with it", "run", self.plan(), SMALL)
        self.bad("is a plan, not a scene", "check", self.plan())
        self.bad("unknown scene 'plate'", "run", self.plan(scenes="plate"))
        self.bad("unknown setting 'kk'", "run", self.plan(settings={"kk": 8}))
        torn = self.work / "torn.json"
        torn.write_text('{"plan": "x",\n "scenes": [')
        self.bad(["torn.json:2", "not JSON"], "run", torn)

    def test_committed_plans_are_valid(self):
        plans = [path for path in SOURCE.glob("results/**/*.json") if "plan" in json.loads(path.read_text())]
        for path in plans:
            self.assertTrue(self.is_valid(path), path)


class Shards(PlanCase):
    """Groups are scenes with their frames, numbered in the plan's order."""

    GROUPS = {"scenes": [SMALL, LARGE], "frames": ["0", "1"]}

    def groups(self, path, *arguments, environment=None):
        """Scenes and frames of the cells that a dry run lists, each once and in order; and the cells."""
        status, out, self.errors = tandem(
            "run", path, *arguments, "--dry-run", "--keys", environment=environment
        )
        self.assertEqual(status, 0, (out, self.errors))
        cells = re.findall(r"(?m)^ +(\w+)\|([^|]+)\|(\w+):[^|]*\|([\d:]+)\|(.*)$", out)
        return list(dict.fromkeys((scene, frames) for _, _, scene, frames, _ in cells)), cells

    def test_shards_partition_the_plan(self):
        path = self.plan(**self.GROUPS)
        whole, cells = self.groups(path)
        self.assertEqual((len(whole), len(cells)), (4, 16))
        for count in (1, 2, 3, 4, 5, 9):
            shards = [self.groups(path, "--shard", f"{i}/{count}") for i in range(count)]
            for i, (groups, _) in enumerate(shards):
                self.assertEqual(groups, whole[i::count], (i, count))
            self.assertCountEqual([cell for _, own in shards for cell in own], cells)

    def test_numbers_do_not_depend_on_devices(self):
        """A device that a machine lacks, an impossible setting, and a group that is excluded on all devices."""
        path = self.plan(
            **self.GROUPS,
            devices=["host", "opencl:0"],
            impossible="skip",
            include=[{"scenes": "plates:count=3", "devices": "opencl:0"}],
        )
        lacks = {"OCL_ICD_VENDORS": "/nonexistent/"}
        for i in range(2):
            all_devices, _ = self.groups(path, "--shard", f"{i}/2")
            host_only, _ = self.groups(path, "--shard", f"{i}/2", environment=lacks)
            self.assertEqual([group for group in all_devices if group in host_only], host_only)
            self.assertTrue(any("skipped" in line for line in self.errors), self.errors)
        everywhere = [
            self.groups(path, "--shard", f"{i}/2", environment=lacks if i else None)[0] for i in range(2)
        ]
        self.assertFalse(set(everywhere[0]) & set(everywhere[1]))
        excluded = self.plan(**self.GROUPS, exclude=[{"scenes": SMALL, "frames": "0"}])
        self.assertEqual(self.groups(excluded, "--shard", "0/2")[0], [("pile", "0:0")])

    def test_numbers_do_not_depend_on_what_is_finished(self):
        path, out = (
            self.plan(
                **self.GROUPS, measure={"repeat": 1, "truth": "none", "no-check": True, "no-count": True}
            ),
            self.work / "shard.jsonl",
        )
        text = self.output("run", path, "--shard", "1/2", "--out", out)
        self.assertIn("shard 1/2: 2 of 4 groups", text)
        self.assertEqual(len(self.records(out)), 8)
        self.assertEqual(self.groups(path, "--shard", "1/2", "--resume", "--out", out)[0], [])
        self.assertEqual(len(self.groups(path, "--shard", "0/2", "--resume", "--out", out)[0]), 2)
        self.assertEqual(len(self.groups(path, "--resume", "--out", out)[0]), 2)

    def test_more_shards_than_groups(self):
        text = self.output("run", self.plan(scenes=SMALL), "--shard", "7/8")
        self.assertEqual(text, "shard 7/8: 0 of 1 groups\n")

    def test_a_task_of_slurm(self):
        path = self.plan(**self.GROUPS)
        task = {
            "SLURM_ARRAY_TASK_ID": "9",
            "SLURM_ARRAY_TASK_MIN": "5",
            "SLURM_ARRAY_TASK_MAX": "11",
            "SLURM_ARRAY_TASK_STEP": "2",
            "SLURM_ARRAY_TASK_COUNT": "4",
        }
        self.assertEqual(
            self.groups(path, "--shard", "slurm", environment=task)[0], self.groups(path, "--shard", "2/4")[0]
        )
        for change in (
            {"SLURM_ARRAY_TASK_ID": "8"},
            {"SLURM_ARRAY_TASK_ID": "13"},
            {"SLURM_ARRAY_TASK_COUNT": "no"},
        ):
            status, _, errors = tandem(
                "run", path, "--shard", "slurm", "--dry-run", environment={**task, **change}
            )
            self.assertEqual((status, len(errors)), (2, 1), errors)
        self.bad(
            "--shard slurm: this process is not a task of a job array", f"run {path} --shard slurm --dry-run"
        )

    def test_bad_shards(self):
        for text in ("2/2", "a/2", "1", "-1/2", "1/0", "1/2/3", "/", "0/", "1/-2", "18446744073709551616/2"):
            self.bad(f"--shard {text}: give I/N", "run", self.plan(), f"--shard={text}", "--dry-run")

    def test_devices_by_model(self):
        plan = self.plan(devices=["host:each", "each"], algorithms="tiled", settings={"k": 8}, scenes=SMALL)
        status, text, _ = tandem("run", plan, "--dry-run", environment={"OCL_ICD_VENDORS": "/nonexistent/"})
        self.assertEqual((status, text.count(" on host\n")), (0, 1), text)
        self.bad(
            ["no device host:no such", "there are: host ("],
            "run",
            self.plan(devices="host:no such"),
            "--dry-run",
        )
        self.bad(
            "cuda:each: there is no device of that backend",
            "run",
            self.plan(devices="cuda:each"),
            "--dry-run",
        )
        status, text, errors = tandem(
            "run", self.plan(devices=["host", "cuda:H100"], impossible="skip"), "--dry-run"
        )
        self.assertEqual(status, 0, errors)
        self.assertTrue(
            any("skipped 1 impossible combination: no device cuda:H100" in line for line in errors), errors
        )
