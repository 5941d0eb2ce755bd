# SPDX-License-Identifier: MIT
# test: cost=30 full=50
"""Readers of records and exports (tandem.tables, tandem.error_figures,
scripts/convert_records, scripts/render) on every committed file, on long and older ones, and on invalid
files."""

import importlib
import json
import lzma
import math
import shutil
import subprocess

from tests.program import LONG, PROGRAM, SMALL, SOURCE, ran, sets
from tests.script_case import ScriptCase, called, committed, rows_of, script

FOLDERS = "results/*", "results/h200/paper/records", "tests/records"
COMMITTED = sorted(path for folder in FOLDERS for path in SOURCE.glob(f"{folder}/*.jsonl"))
PACKED = "chosen.jsonl"  # which the test packs


class Scripts(ScriptCase):
    def sample(self, path):
        """A copy of a committed file; in the short form only a few of its lines."""
        lines = path.read_bytes().splitlines(keepends=True)
        lines = lines if LONG else [*lines[: -1 : -(-len(lines) // 12)], lines[-1]]
        copy = self.work / (path.name + ".xz" if path.name == PACKED else path.name)
        copy.write_bytes(lzma.compress(b"".join(lines)) if path.name == PACKED else b"".join(lines))
        return copy, [json.loads(line) for line in lines]

    def test_every_committed_file(self):
        self.assertGreater(len(COMMITTED), 20)
        drawings = 0
        for path in COMMITTED:
            copy, records = self.sample(path)
            with self.subTest(path.name):
                text = self.output_of("tables", copy)
                cells = [record for record in records if "key" in record]
                rows = [row for row in rows_of(text) if "±" in "".join(row)]
                kernels = [
                    kernel for record in records if "profile_of" in record for kernel in record["kernels"]
                ]
                self.assertEqual(len(rows), len(cells) + len(kernels))
                for part in text.split("\n### "):
                    labels = [tuple(row[:2]) for row in rows_of(part) if "±" in "".join(row)]
                    self.assertEqual(len(labels), len(set(labels)), part[:200])
                drawn, to = (
                    sum(bool((cell["error"] or {}).get("truth")) for cell in cells),
                    self.work / "drawn",
                )
                if drawn and (LONG or drawings < 2):
                    drawings += 1
                    self.assertIn(f"{drawn} records drawn", self.output_of("figures", copy, to))
                elif not drawn:
                    self.refused("figures", "no record has errors against the truth", copy, to)
                self.check_conversion(copy, len(records))
                if LONG or path in COMMITTED[:2]:
                    self.refused("render", "no .glb", copy, self.work / "picture")

    def check_conversion(self, copy, count):
        """Conversion to the newest schema changes nothing."""
        unpack = lzma.decompress if copy.suffix == ".xz" else bytes
        lines = lambda: [json.loads(line) for line in unpack(copy.read_bytes()).splitlines()]
        before = lines()
        self.assertIn(f"{count} lines of the newest schema", self.output_of("convert_records", copy))
        self.assertEqual(lines(), before)

    def test_invalid_files(self):
        record = committed("cpu/walks.jsonl")[0]
        of = lambda changes: json.dumps({**record, **changes}).encode() + b"\n"
        line = of({})
        packed = lzma.compress(line)
        bad = {
            "text.jsonl": (b"no record\n", ":1: is not JSON"),
            "number.jsonl": (b"3\n", ":1: is no record of tandem"),
            "list.jsonl": (b"[]\n", ":1: is no record of tandem"),
            "other.jsonl": (b'{"a": 1}\n', ":1: is no record of tandem"),
            "deep.jsonl": (b"[" * 100000 + b"\n", ":1: is not JSON"),
            "bytes.jsonl": (bytes(range(256)), "is not JSON"),
            "nan.jsonl": (of({"total_ns": math.nan}), ":1: is not JSON"),
            "half.jsonl": (b'{"key": "\\ud83d"}\n', ":1: is not JSON"),
            "second.jsonl": (line + b'{"schema":4,"key"\n', ":2: is not JSON"),
            "torn.jsonl": (line[:100], "torn.jsonl: its only line has no end"),
            "old.jsonl": (of({"schema": 1}), [":1: a record of schema 1", "scripts/convert_records"]),
            "newer.jsonl": (of({"schema": 9}), [":1: a record of schema 9", "use the package"]),
            "empty.jsonl": (b"", "is empty"),
            "empty.jsonl.xz": (lzma.compress(b""), "is empty"),
            "half.jsonl.xz": (packed[: len(packed) // 2], "half.jsonl.xz: "),
            "odd.jsonl.xz": (packed[:300] + b"odd" + packed[303:], "odd.jsonl.xz: "),
        }
        for name, (data, expected) in bad.items():
            path = self.work / name
            path.write_bytes(data)
            for reader in ("tables", "figures"):
                with self.subTest(f"{reader} {name}"):
                    # An unfinished line causes a warning, and may be the only line.
                    folder = [self.work / "none"] if reader == "figures" else []
                    status, _, errors = script(reader, path, *folder)
                    self.assertEqual((status, len(errors)), (2, 1 + (name == "torn.jsonl")), errors)
                    self.assertTrue(errors[-1].startswith("tandem: "), errors)
                    for part in [expected] if isinstance(expected, str) else expected:
                        self.assertIn(part, errors[-1])
        names = "text.jsonl list.jsonl bytes.jsonl second.jsonl torn.jsonl empty.jsonl deep.jsonl"
        for name in [*names.split(), "half.jsonl.xz", "odd.jsonl.xz"]:
            with self.subTest(f"convert_records {name}"):
                self.refused("convert_records", name, self.work / name)
                self.assertEqual((self.work / name).read_bytes(), bad[name][0])
        messages = {"tables": "is a folder", "figures": "is a folder", "convert_records": "directory"}
        for reader, folder in messages.items():
            more = [self.work / "none"] if reader == "figures" else []
            self.refused(reader, ["absent.jsonl", "No such file"], self.work / "absent.jsonl", *more)
            self.refused(reader, folder, self.work, *more)
        frameless = {**record, "frames": {"first": 1, "last": 0}}
        self.refused(
            "tables",
            "frameless.jsonl:1: is no record of a cell (ZeroDivisionError",
            self.file("frameless.jsonl", [frameless]),
        )
        self.refused("tables", "the following arguments are required")
        self.refused("figures", "the following arguments are required", self.work / "text.jsonl")
        self.assertFalse((self.work / "none").exists())
        for fields in ("settings", "devices", "total_ns", "stages", "environment", "frames", "sampling"):
            for value in ({}, [], 3, "x"):
                broken = {**record, fields: value}
                code, _, errors = script("tables", self.file("broken.jsonl", [broken]))
                self.assertLessEqual((code, len(errors)), (2, 1), (fields, value, errors))
                self.assertNotIn("Traceback", "".join(errors))

    def test_an_unfinished_last_line_is_ignored(self):
        whole = self.file("whole.jsonl", committed("../tests/records/accuracy.jsonl")[:2])
        torn = self.work / "cut.jsonl"
        torn.write_text(whole.read_text() + whole.read_text()[:100])
        self.assertEqual(script("tables", torn)[1], self.output_of("tables", whole))
        for reader, more, expected in (
            ("tables", [], "### "),
            ("figures", [self.work / "of the whole"], "2 records drawn"),
        ):
            code, text, errors = script(reader, torn, *more)
            self.assertEqual((code, len(errors)), (0, 1))
            self.assertIn(expected, text)
            self.assertIn("cut.jsonl:3: the last line has no end", errors[0])

    def test_errors_for_arbitrary_bytes_are_one_line(self):
        """The inputs of the fuzz target of records, which the readers in C++ get as well."""
        inputs = sorted((SOURCE / "tests/fuzz/corpus/records").iterdir())
        self.assertGreater(len(inputs), 3)
        export = importlib.import_module("tandem.commands.export_csv")
        for path in inputs:
            for read in (
                lambda: script("tables", path),
                lambda: script("figures", path, self.work / "odd"),
                lambda: called(export, f"--records={path}"),
            ):
                code, _, errors = read()
                errors = [line for line in errors if "the last line has no end" not in line]
                self.assertIn((code, len(errors)), ((0, 0), (2, 1)), (path.name, errors))

    def test_the_standard_library_is_enough(self):
        """Reading, tables, exports and conversion work without the packages of the system and of users."""
        walks, copy = SOURCE / "results/cpu/walks.jsonl", self.work / "walks.jsonl"
        shutil.copy(walks, copy)
        programs = PROGRAM.parent / "libexec/tandem"
        for words in (
            (programs / "export-csv", f"--records={walks}"),
            (programs / "tables", walks),
            (SOURCE / "scripts/convert_records", copy),
        ):
            done = ran(["/usr/bin/python3", "-S", "-I", *map(str, words)])
            self.assertEqual((done.returncode, done.stderr), (0, ""), words)
            self.assertGreater(len(done.stdout), 20)
        self.assertEqual(copy.read_bytes(), walks.read_bytes())

    def test_older_records_are_converted_to_the_newest_schema(self):
        """What schema 3 of cells (2 of simulations, 1 of profiles) called otherwise, and nothing else,
        changes; converting again changes nothing."""
        former = {"partition": "shares", "repartitions": "deals", "partition bodies": "deal bodies"}

        def older(record):
            if isinstance(record, list):
                return [older(one) for one in record]
            if not isinstance(record, dict):
                return record
            record = {former.get(name, name): older(value) for name, value in record.items()}
            if record.get("algorithm") == "chunked" and record.get("preset") in ("grouped", "paper"):
                record["preset"] = "resident"
            return record

        presets = set()
        for name in (
            "h200/plan.jsonl",
            "h200/paper/records/cells-plates.jsonl",
            "../tests/records/chosen.jsonl",
            "../tests/records/two_ranks.jsonl",
            "h200x2/ranks.jsonl",
            "h200/profile.jsonl",
            "simulations/solver-meteor.jsonl.xz",
        ):
            records = [record for record in committed(name) if record.get("kind") != "verdict"]
            presets.update(record["preset"] for record in records if record.get("algorithm") == "chunked")
            records = records if LONG else records[:: -(-len(records) // 20)]
            path = self.work / "older.jsonl"
            path.write_text(
                "".join(
                    json.dumps({**older(record), "schema": record["schema"] - 1}) + "\n" for record in records
                )
            )
            if "key" not in records[0]:  # cells of the two schemas before are read
                self.refused("tables", "convert_records", path)
            self.output_of("convert_records", path)
            self.assertEqual([json.loads(line) for line in path.read_text().splitlines()], records, name)
            once = path.read_bytes()
            self.output_of("convert_records", path)
            self.assertEqual(path.read_bytes(), once)
        self.assertEqual(presets, {"grouped", "paper", "published"})

    def test_the_rule_of_descent_has_its_new_name(self):
        """Larger is another rule in records with setting copies."""
        walks = committed("cpu/walks.jsonl")
        record = next(r for r in walks if r.get("settings", {}).get("descent") == "unlike")
        older = json.loads(json.dumps(record).replace("descent=unlike", "descent=larger"))
        older["settings"]["descent"] = "larger"
        today = json.loads(json.dumps(older))
        today["settings"]["copies"] = "none"
        path = self.work / "descents.jsonl"
        path.write_text("".join(json.dumps(one) + "\n" for one in (older, today)))
        self.output_of("convert_records", path)
        self.assertEqual([json.loads(line) for line in path.read_text().splitlines()], [record, today])

    def test_other_kinds(self):
        profile = self.work / "own.jsonl"
        self.output(
            "profile",
            "plates",
            "--frames",
            60,
            "--algorithm",
            "tiled",
            "--set",
            "k=6",
            "--repeat",
            2,
            "--device",
            "host",
            "--out",
            profile,
            "--ceilings",
            SOURCE / "tests/records/ceilings.jsonl",
            *sets(
                {name: SMALL[name] for name in ("pair_capacity", "contact_capacity", "tile_pair_capacity")}
            ),
        )
        kernels = json.loads(profile.read_text())["kernels"]
        steps = committed("simulations/solver-meteor.jsonl.xz")
        text = self.output_of(
            "tables",
            profile,
            SOURCE / "tests/records/ceilings.jsonl",
            self.file("simulation.jsonl", [*steps, *steps[:5]]),
        )
        rows = {row[0]: row for row in rows_of(text)}
        ceilings = [row[2] for row in rows_of(text) if row[0].startswith("cuda:0")]
        for kernel in kernels:
            self.assertEqual(rows[kernel["entry"]][1:2], [kernel["stage"]])
            self.assertIn("±", rows[kernel["entry"]][2])
        self.assertEqual(ceilings, ["3908", "3937"])
        self.assertIn("500", rows[steps[-1]["scene"]["key"]])
        self.assertIn("5 steps of a simulation that has not ended", text)
        self.refused("figures", "no record has errors", profile, self.work / "none")

    def test_long_files(self):
        """A hundred thousand cells of one scene, each with its own setting, in bounded memory."""
        record = {
            **committed("h200/paper/records/thresholds.jsonl")[0],
            "kernels": [],
            "conditions": None,
            "kernel_times": {},
            "breakdown_ns": None,
            "device_span_ns": None,
        }
        record["total_ns"] = {**record["total_ns"], "frames": [], "samples": [], "rounds": []}
        path, count = self.work / "long.jsonl", 100000 if LONG else 1000
        with open(path, "w") as out:
            for i in range(count):
                settings = {**record["settings"], "threads": str(i)}
                algorithm, preset = (("chunked", "grouped"), ("gproximity", "fair"))[i % 2]
                out.write(
                    json.dumps({**record, "algorithm": algorithm, "preset": preset, "settings": settings})
                    + "\n"
                )
        text = self.output_of("tables", path, address_space=1 << 29)
        self.assertEqual(
            text.count("threads="), count + count
        )  # a row each, and half as many ratios, each of two cells
        self.assertIn("only those to the fastest chunked cell are shown", text)
        path.unlink()

    def moving_picture(self, glb, out):
        """A loop has a picture for each exported frame, and a red disc where a mark is."""
        from PIL import Image

        marks = self.work / "marks.csv"
        marks.write_text("picture,x,y,z,radius\n1,0,0,0,5\n")
        words = glb, out, "--loop", 50, "--size", "64x48", "--from=0,0,1", "--box=-4,-3,-3,4,3,3"
        self.assertEqual(self.output_of("render", *words, "--marks", marks), f"{out}.webp\n")
        image = Image.open(f"{out}.webp")
        self.assertEqual(image.n_frames, 3)
        for number in range(3):
            image.seek(number)
            red, green, blue = image.convert("RGB").getpixel((32, 24))
            self.assertEqual(red > 150 and green < 90 and blue < 90, number == 1, (number, red, green, blue))
        marks.write_text("picture,x,y\n1,0,0\n")
        self.refused("render", "no table of picture,x,y,z,radius", *words, "--marks", marks)
        self.refused("render", "milliseconds from 1 to 10000", glb, out, "--loop", 0)

    def test_pictures(self):
        try:
            subprocess.run(["/usr/bin/python3", "-c", "import numpy, PIL"], check=True, capture_output=True)
        except subprocess.CalledProcessError:
            self.skipTest("no numpy or no Pillow")
        glb, out = self.work / "plates.glb", self.work / "picture"
        self.output("export", "plates", "--frames", "0:10", "--every", 5, "--glb", glb)
        self.assertEqual(
            self.output_of("render", glb, out, "--at", "0,1", "--size", "64x48"),
            f"{out}-0.png\n{out}-1.png\n",
        )
        self.moving_picture(glb, out)
        data, bad = glb.read_bytes(), self.work / "bad.glb"
        lengths = (
            (0, "empty"),
            (3, "no .glb"),
            (4, "ends within"),
            (len(data) - 1, "ends within"),
            *(((16, "ends within"), (100, "ends within")) if LONG else ()),
        )
        for length, expected in lengths:
            bad.write_bytes(data[:length])
            self.refused("render", expected, bad, out)
        for name, text in (
            ("list", "[]"),
            ("no nodes", "{}"),
            ("empty", '{"nodes": []}'),
            ("far", '{"nodes":[{"mesh":7}],"meshes":[]}'),
            ("text", "{"),
        ):
            text = text.encode().ljust(64)
            bad.write_bytes(
                data[:12]
                + len(text).to_bytes(4, "little")
                + b"JSON"
                + text
                + (4).to_bytes(4, "little")
                + b"BIN\0"
                + bytes(4)
            )
            with self.subTest(name):
                self.refused("render", "bad.glb: ", bad, out)
        self.refused("render", "No such file", self.work / "absent.glb", out)
        self.refused("render", "cannot be written", glb, self.work / "absent/picture", code=3)
        options = (
            "--at=2",
            "--at=x",
            "--size=0x4",
            "--size=9",
            "--zoom=0",
            "--box=1,2",
            "--from=0,0,0",
            "--cut=x",
            "--unheard-of",
        )
        for option in options if LONG else options[::3]:
            self.refused("render", option.split("=")[0], glb, out, option)
