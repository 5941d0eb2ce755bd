# SPDX-License-Identifier: MIT
# test: cost=8
"""Bad meshes, scenes, outputs and devices, and failures of devices: one line
names the error and what to do."""

import json
import re

from tests.program import PROGRAM, Case, bar, gmsh, ran, right_cells, tandem, words_of


class BadInput(Case):
    def test_bad_meshes(self):
        points, tets = bar(2, (0, 0, 0))
        whole = self.good.read_text()
        far = [[5000, *tets[0][1:]], *tets[1:]]
        texts = {
            "short.msh": whole[: len(whole) // 2],
            "nan.msh": whole.replace("\n1 0.0 0.0 0.0\n", "\n1 nan 0 0\n", 1),
            "count.msh": whole.replace("$Elements\n24", "$Elements\n999999999999"),
            "range.msh": gmsh(self.work / "range.msh", points, far).read_text(),
            "hexa.msh": gmsh(self.work / "hexa.msh", points, [(0, 1, 3, 2, 4, 5, 7, 6)], 5).read_text(),
        }
        reasons = {
            "short.msh": "",
            "nan.msh": "nan",
            "count.msh": "999999999999",
            "range.msh": "5001",
            "hexa.msh": "hexahedr",
        }
        for name, text in texts.items():
            self.assertNotEqual(text, whole)
            path = self.work / name
            path.write_text(text)
            for arguments in (("--mesh", path, "--mesh", self.good), ("--mesh", self.good, "--mesh", path)):
                self.bad(reasons[name], "run", *arguments)
            errors = tandem("run", "--mesh", path)[2]
            self.assertRegex(errors[0], re.escape(str(path)) + r":\d+: ")
        noise = self.work / "noise.msh"
        noise.write_text("this is no mesh\n")
        surface = gmsh(self.work / "surface.msh", points, [])
        for path, reason in (
            (noise, ""),
            (surface, "no tetrahedra"),
            (self.work / "missing.msh", ""),
            (self.work, "folder"),
        ):
            self.bad([str(path), reason], "run", "--mesh", path)

    def test_bad_scenes(self):
        empty = self.work / "empty.json"
        empty.write_text('{"meshes": {"j": {"builtin": "jack"}}, "bodies": []}')
        self.bad(["empty.json", "bodies"], "run", empty)
        empty.write_text('{"meshes": {"j": {"builtin": "jack"}}}')
        self.bad(["empty.json", "bodies"], "run", empty)
        empty.write_text('{"meshes": \n')
        self.bad("empty.json", "run", empty)
        self.bad("the nearest is 'plates'", "run", "plate")
        self.bad("the nearest is 'density'", "run", "pile:densty=1")
        for value in (
            "pile:density=-1",
            "pile:density=nan",
            "pile:bodies=0",
            "pile:bodies=2.5",
            "plates:count=99999999999999999",
        ):
            self.bad("impossible", "run", value)
        # More than any machine's memory: nothing is generated.
        for value in (
            "pile:bodies=10000000,refine=4",
            "plates:count=100000,refine=4",
            "funnel:bodies=1000000,refine=3",
            "glasses:bodies=1000000,refine=3",
        ):
            self.bad(["bodies of mesh", "take at least"], "run", value)
        self.bad("no value", "run", "pile:density")
        self.bad("the nearest is 'jack'", "run", "pile:mesh=jak")
        self.bad("absent.json", "run", self.work / "absent.json")

    def test_what_needs_all_pairs_refuses_output_contacts(self):
        common = ("plates", "--frames", 0, "--device", "host", "--set", "output=contacts")
        csv = self.work / "interior.csv"
        self.bad("--truth pairs needs all candidate pairs", "run", *common, "--truth", "pairs")
        self.bad("--dump-pairs needs all candidate pairs", "run", *common, "--dump-pairs", csv)
        self.bad("accuracy needs all candidate pairs", "accuracy", *common)
        self.bad("needs a contact rule", "run", *common, "--set", "contact_rule=none")
        self.assertFalse(csv.exists())

    def test_errors_that_quote_a_file_are_one_line(self):
        scene = self.work / "controls.json"
        scene.write_text('{"meshes": {"a\\n\\u001b[31mb": {"builtin": "jac"}}, "bodies": []}')
        self.bad(r"/meshes/a\n\x1b[31mb/builtin: unknown mesh 'jac'", "run", scene, "--device", "host")
        self.bad(r"no\nsuch.json: cannot be read", "run", "no\nsuch.json", "--device", "host")

    def test_required_devices(self):
        available = {e["backend"] for e in json.loads(tandem("devices", "--json")[1]) if e["devices"]}
        absent = "cuda:99" if "cuda" in available else "cuda"
        for arguments in (("run", "plates"), ("check", "plates"), ("devices",)):
            self.bad(f"--require {absent}: ", *arguments, "--require", absent)
        self.assertEqual(tandem("devices", "--require", "host,opencl,opencl:0")[0], 0)

    def test_unwritable_output_is_detected_first(self):
        for option in ("--out", "--dump-pairs", "--dump-contacts", "--dump-distances"):
            rule = ("--set", "contact_rule=distance") if option == "--dump-distances" else ()
            out = self.bad(
                "cannot be written",
                "run",
                "plates",
                "--frames",
                "0",
                *rule,
                option,
                self.work / "no/such/file",
            )
            self.assertNotIn("traverse", out)

    def test_too_little_memory(self):
        """1 TiB is more than any device has: the error names both numbers, the record has status failed, and earlier
        records stay."""
        for device in ("host", "opencl:0"):
            out = self.work / f"memory{device}.jsonl"
            cell = f"run {self.twice} --algorithm gproximity --device {device} --repeat 1 --out {out}"
            arguments = (cell, "--set groups=64")
            self.assertEqual(tandem(*arguments)[0], 0)
            self.bad(
                "of 5726623061 items and 2147483648 is the most; lower it, or raise groups",
                cell,
                "--set groups=16 --set queue_bytes=1099511627776",
            )
            before = out.read_bytes()
            # The array of the release has a quarter of the memory; with a limit of memory it is as large as
            # fits.
            whole = (cell, "--set queue_bytes=device")
            status, _, errors = tandem(*whole, address_space=2 << 30)
            self.assertEqual((status, len(errors)), (2, 1), errors)
            self.assertRegex(
                errors[0],
                r"setting queue_bytes=device stands for \d+\.\d\d GB on .* do not fit; give --set queue_bytes=67108864, or --memory",
            )
            self.assertTrue(out.read_bytes().startswith(before))
            self.bad("queues", *arguments, "--set", "queue_bytes=67108864,1099511627776", code=3)
            self.assertTrue(out.read_bytes().startswith(before))
            records = self.records(out)
            self.assertEqual([r["status"] for r in records], ["ok", "ok", "failed"])
            needed, there_is = map(
                int, re.search(r"needs (\d+) bytes.* (\d+)$", records[2]["failure"]).groups()
            )
            self.assertGreater(needed, 10**12)
            self.assertLess(there_is, needed)
            self.assertGreater(there_is, 0)

    def test_without_any_driver(self):
        nothing = {"OCL_ICD_VENDORS": "/nonexistent/"}
        out = self.output("devices", environment=nothing)
        self.assertIn("opencl: no platform", out)
        reasons = {
            e["backend"]: e["reason"] for e in json.loads(tandem("devices", "--json", environment=nothing)[1])
        }
        self.assertIn("no platform", reasons["opencl"])
        self.bad("opencl: no platform", "run", "plates", "--device", "opencl:0", environment=nothing)
        self.bad("opencl: no platform", "devices", "--require", "opencl", environment=nothing)
        status, out, _ = tandem("run", "--mesh", self.good, "--device", "host", environment=nothing)
        self.assertEqual(status, 0, out)


class Regressions(Case):
    """Regression tests of fixed errors."""

    def cell(self, *arguments, **options):
        return tandem(f"run {self.twice} --device host --algorithm chunked", *arguments, **options)

    def test_check_takes_one_algorithm(self):
        for name in ("chunked", "gproximity"):
            self.output("check", "plates", "--frames", "0", "--algorithm", name, "--device", "host")

    def test_coordinates_beyond_single_precision(self):
        """A bar stretched through another: 108 pairs in double; float must find them too or refuse (exit 2)."""
        points, tets = bar(2, (0, 0, 0))
        long = gmsh(self.work / "long.msh", [(x * 1e39, y, z) for x, y, z in points], tets)
        other = gmsh(self.work / "other.msh", *bar(3, (0.5, 0.25, 0.375)))
        counts = []
        for precision in ("double", "float"):
            out = self.work / f"{precision}.jsonl"
            status = tandem(
                f"run --mesh {long} --mesh {other} --device host --algorithm chunked --repeat 1 --set k=6 "
                f"--set precision={precision} --out {out}"
            )[0]
            counts.append(self.records(out)[0]["work"]["candidate_pairs"] if status == 0 else status)
        self.assertIn(counts[1], (counts[0], 2))

    def test_impossible_cells_are_detected_before_any_is_measured(self):
        out = self.work / "late.jsonl"
        self.cell("--set", "leaves=4,3", "--out", out)
        self.assertFalse(out.exists() and out.read_text())

    def test_dumps_without_pairs_are_detected_first(self):
        out = self.work / "digest.jsonl"
        self.cell("--set", "output=digest", "--dump-pairs", self.work / "digest.csv", "--out", out)
        self.assertFalse(out.exists() and out.read_text())

    def test_dump_after_a_failed_cell_keeps_the_table(self):
        status, text, errors = tandem(
            f"run {self.twice} --algorithm gproximity --device host --repeat 1 "
            f"--set queue_bytes=1099511627776,67108864 --dump-pairs {self.work}/failed.csv"
        )
        self.assertEqual((status, len(errors), right_cells(text)), (3, 1, 1))
        self.assertGreater(
            len((self.work / "failed.csv").read_text().splitlines()), 100, "of the cell that finished"
        )

    def test_a_dump_is_complete_or_absent(self):
        """A file with only a header would read as an answer without pairs; a file of the user stays until it
        is replaced."""
        pairs, contacts, out = self.work / "pairs.csv", self.work / "contacts.csv", self.work / "once.jsonl"
        contacts.write_text("mine\n")
        (self.work / "link.csv").symlink_to(contacts)
        failing = (
            f"run {self.twice} --algorithm gproximity --device host --repeat 1 "
            "--set queue_bytes=1099511627776 --dump-pairs",
        )
        self.bad("queues", *failing, pairs, "--dump-contacts", self.work / "link.csv", code=3)
        self.assertEqual((list(self.work.glob("pairs.csv*")), contacts.read_text()), ([], "mine\n"))
        piped = ran([PROGRAM, *words_of(failing), "/dev/stderr"])
        self.assertNotIn("body_a", piped.stderr)
        self.assertEqual(
            self.cell(
                "--repeat", 1, "--out", out, "--dump-pairs", pairs, "--dump-contacts", self.work / "link.csv"
            )[0],
            0,
        )
        self.assertEqual(pairs.read_text().partition("\n")[0], "frame,body_a,tet_a,body_b,tet_b")
        self.assertGreater(len(contacts.read_text().splitlines()), 10, "a link is followed")
        pairs.unlink()
        status, text, _ = self.cell("--repeat", 1, "--out", out, "--resume", "--dump-pairs", pairs)
        self.assertEqual((status, pairs.exists()), (0, False))
        self.assertIn("no dump is written: run again without --resume", text)
        (self.work / "here").symlink_to(self.work)
        self.bad(
            "named for two outputs",
            f"run plates --dump-pairs {self.work}/new.csv --dump-contacts {self.work}/here/new.csv",
        )

    def test_a_failure_is_one_line_without_an_empty_one(self):
        words = f"run --mesh {self.good} --algorithm gproximity --device host --set queue_bytes=1099511627776"
        done = ran([PROGRAM, *words.split()])
        self.assertTrue(done.stderr.startswith("tandem: "), done.stderr)

    def test_records_can_be_written_to_a_pipe(self):
        self.assertEqual(self.cell("--out", "/dev/stdout")[0], 0)

    def test_a_profile_without_measurements_is_an_error(self):
        status, out, errors = self.cell("--profile", "3")
        self.assertEqual((status, errors), (0, []))
        self.assertIn("on host: replayed frames 0:0 3 times; nothing measured or recorded", out)

    def test_a_profile_writes_nothing(self):
        for option in ("--out", "--dump-pairs", "--dump-contacts"):
            status, _, errors = self.cell("--profile", "1", option, self.work / "profile.x")
            self.assertEqual((status, len(errors)), (2, 1))
            self.assertIn("--profile only replays frames", errors[0])
        self.assertFalse((self.work / "profile.x").exists())

    def test_a_negative_profile_is_refused(self):
        self.assertEqual(self.cell("--profile", "-1")[0], 2)

    def test_poses_without_meshes_are_refused(self):
        pose = ("--pose", "1 0 0 1 0 0 0")
        self.assertEqual(
            tandem("run", "pile:bodies=2,frames=1", "--device", "host", "--repeat", 1, *pose)[0], 2
        )

    def test_unknown_devices_beside_all_are_refused(self):
        self.assertEqual(
            tandem("run", "pile:bodies=2,frames=1", "--repeat", 1, "--device", "all,nosuch")[0], 2
        )

    def test_a_folder_is_no_scene_description(self):
        folder = self.work / "folder.json"
        folder.mkdir()
        self.bad("folder.json", "run", folder)

    def test_errors_locate_the_field_of_a_scene_description(self):
        path = self.work / "place.json"
        path.write_text('{"meshes": {"j": {"builtin": "jack"}}}')
        self.assertNotIn(": :", tandem("run", path)[2][0])
