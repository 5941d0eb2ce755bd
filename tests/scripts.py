#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""scripts.py PROGRAM SOURCE: readers of records and exports (tandem.tables, tandem.error_figures, tandem.answer,
scripts/convert_records, scripts/render) on every committed file, on cells of every status, and on invalid files.
Also checks the committed microbenchmarks."""
import collections
import contextlib
import importlib
import importlib.machinery
import importlib.util
import io
import csv
import json
import lzma
import math
import os
import re
import resource
import shutil
import subprocess
import sys
import textwrap
import unittest

from program import LONG, PROGRAM, SMALL, SOURCE, Case, sets, tandem

sys.dont_write_bytecode = True
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "python")]
COMMITTED = sorted([*SOURCE.glob("results/*/*.jsonl"), *SOURCE.glob("results/*/*.jsonl.xz")])
# other names are those of scripts
MODULES = {"tables": "tandem.tables", "figures": "tandem.error_figures", "answer": "tandem.answer"}

QUOTE = re.compile(r"(?s)<!-- quote: (\S+) -->\n```\w+\n(.*?)```")


def stands_in(quote, lines):
    """Whether the lines of a quote are consecutive lines of a file, ignoring their common indentation."""
    own = textwrap.dedent(quote).splitlines()
    return bool(own) and any(textwrap.dedent("\n".join(lines[i:i + len(own)])).splitlines() == own for i in range(len(lines)))


def wrong_quotes(page):
    """Errors in the blocks of a page that follow <!-- quote: FILE -->; every block of C++ must be such a quote."""
    quotes, blocks = QUOTE.findall(page), page.count("```cpp")
    of_cpp = sum(name.endswith((".cpp", ".h")) for name, _ in quotes)
    wrong = [f"{blocks} blocks of C++ and {of_cpp} quotes of it"] if blocks != of_cpp else []
    if (marks := page.count("<!-- quote:")) != len(quotes):
        wrong.append(f"{marks} marks and {len(quotes)} quotes")
    for name, quote in quotes:
        if not (SOURCE / name).is_file():
            wrong.append(f"{name}: no such file")
        elif not stands_in(quote, (SOURCE / name).read_text().splitlines()):
            wrong.append(f"{name}: has no such lines: {quote.partition(chr(10))[0]}")
    return wrong


def loaded(name, scripts={}):
    """The module or script, loaded once: starting Python and loading its libraries takes longer than most tests."""
    if name in MODULES:
        return importlib.import_module(MODULES[name])
    if name not in scripts:
        loader = importlib.machinery.SourceFileLoader(f"script_{name}", str(SOURCE / "scripts" / name))
        scripts[name] = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
        loader.exec_module(scripts[name])
    return scripts[name]


def called(module, *arguments):
    """(exit code, standard output, lines of standard error) of main() of a module, in this process."""
    out = io.TextIOWrapper(io.BytesIO(), "utf-8", write_through=True)
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()) as errors:
        try:
            code = module.main([str(argument) for argument in arguments]) or 0
        except SystemExit as end:  # with a text, which Python prints, or with a code
            code = 1 if isinstance(end.code, str) else end.code
            errors.write(end.code if isinstance(end.code, str) else "")
    return code, out.buffer.getvalue().decode(), errors.getvalue().splitlines()


def script(name, *arguments, address_space=None):
    """(exit code, standard output, lines of standard error). Runs in this process, unless the address space is
    limited or Python is not the scripts' own and may lack their libraries."""
    if not address_space and name != "render" and os.path.realpath(sys.executable) == os.path.realpath("/usr/bin/python3"):
        return called(loaded(name), *arguments)
    limit = (lambda: resource.setrlimit(resource.RLIMIT_AS, (address_space, address_space))) if address_space else None
    what = ["-B", "-m", MODULES[name]] if name in MODULES else [SOURCE / "scripts" / name]
    done = subprocess.run(["/usr/bin/python3", *what, *map(str, arguments)], capture_output=True, text=True, timeout=500,
                          preexec_fn=limit, cwd=SOURCE, env={**os.environ, "PYTHONPATH": str(SOURCE / "python")})
    return done.returncode, done.stdout, done.stderr.splitlines()


def committed(name):
    return [json.loads(line) for line in (SOURCE / "results" / name).read_text().splitlines()]


def rows_of(text):
    """Cells of every line of a Markdown table."""
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in text.splitlines() if line.startswith("| ")]


class Scripts(Case):
    def file(self, name, records):
        path = self.work / name
        path.write_text("".join(json.dumps(record) + "\n" for record in records))
        return path

    def output_of(self, name, *arguments, **options):
        code, text, errors = script(name, *arguments, **options)
        self.assertEqual((code, errors), (0, []), (name, arguments, text[-500:]))
        return text

    def refused(self, name, expected, *arguments, code=2):
        status, text, errors = script(name, *arguments)
        self.assertEqual((status, len(errors)), (code, 1), (name, arguments, errors, text))
        self.assertTrue(errors[0].startswith("tandem: " if name in MODULES else f"{name}: "), errors)
        for part in [expected] if isinstance(expected, str) else expected:
            self.assertIn(part, errors[0])

    def table(self, *records):
        return self.output_of("tables", self.file("shown.jsonl", records))

    def sample(self, path):
        """A copy of a committed file; in the short form only a few of its lines."""
        data = lzma.open(path).read() if path.suffix == ".xz" else path.read_bytes()
        lines = data.splitlines(keepends=True)
        lines = lines if LONG else [*lines[:-1:-(-len(lines) // 12)], lines[-1]]
        copy = self.work / path.name
        copy.write_bytes(lzma.compress(b"".join(lines)) if path.suffix == ".xz" else b"".join(lines))
        return copy, [json.loads(line) for line in lines]

    def test_every_committed_file(self):
        self.assertGreater(len(COMMITTED), 20)
        for path in COMMITTED:
            copy, records = self.sample(path)
            with self.subTest(path.name):
                text = self.output_of("tables", copy)
                cells = [record for record in records if "key" in record]
                rows = [row for row in rows_of(text) if "±" in "".join(row)]
                kernels = [kernel for record in records if "profile_of" in record for kernel in record["kernels"]]
                self.assertEqual(len(rows), len(cells) + len(kernels))
                for part in text.split("\n### "):
                    labels = [tuple(row[:2]) for row in rows_of(part) if "±" in "".join(row)]
                    self.assertEqual(len(labels), len(set(labels)), part[:200])
                drawn = [record for record in cells if (record["error"] or {}).get("truth")]
                if drawn:
                    self.assertIn(f"{len(drawn)} records drawn", self.output_of("figures", copy, self.work / "drawn"))
                else:
                    self.refused("figures", "no record has errors against the truth", copy, self.work / "drawn")
                before = copy.read_bytes()
                self.assertIn(f"{len(records)} lines of the newest schema", self.output_of("convert_records", copy))
                unpack = lzma.decompress if path.suffix == ".xz" else bytes
                same = [json.loads(line) for line in unpack(copy.read_bytes()).splitlines()]
                self.assertEqual(same, [json.loads(line) for line in unpack(before).splitlines()])
                self.refused("render", "no .glb", copy, self.work / "picture")

    def test_launches_are_counted_as_in_the_paper_too(self):
        """A frame of plates has three launches in the paper's Table 5: 306 in 102 frames."""
        records = [record for record in committed("h200/plan.jsonl") if record["scene"]["name"] == "plates" and record["settings"]["k"] == "8"]
        header, *rows = rows_of(self.table(*records))
        ratio = next(row for row in rows if row[0] == "published / published")
        launches, theirs = header.index("launches"), header.index("as theirs")
        of = {row[0]: (row[launches], row[theirs]) for row in rows if len(row) == len(header) and "±" in "".join(row)}
        paper = {(row["scene"], row["algorithm"]): int(row["launches"]) for row in
                 csv.DictReader((SOURCE / "results/paper/table5.csv").read_text().splitlines()) if row["gpu"] == "K20c"}
        chunked, = (value for name, value in of.items() if name.startswith("chunked published"))
        self.assertEqual(chunked, ("4", str(round(paper["plates", "chunked"] / 102))))
        published = next(record for record in records if (record["algorithm"], record["preset"]) == ("gproximity", "published"))
        times = {kernel: value["launches"] for kernel, value in published["kernel_times"].items()}
        self.assertEqual(times["plan_balance"], times["traverse_queues"])
        gproximity, = (value for name, value in of.items() if name.startswith("gproximity published"))
        self.assertEqual(gproximity[1], f"{2 + 2 * times['traverse_queues'] / 102:.0f}")
        ours = sum(stage["launches"] for stage in published["stages"].values())
        self.assertEqual(ratio[-2:], [f"{ours / 408:.1f}", f"{(2 + 2 * times['traverse_queues'] / 102) / 3:.1f}"])
        self.assertEqual({theirs for name, (_, theirs) in of.items() if name.startswith("tiled")}, {"-"})
        self.assertNotIn("as theirs", self.table(*committed("h200/published.jsonl")), "nothing is known of their kernels")

    def test_invalid_files(self):
        record = committed("cpu/walks.jsonl")[0]
        line = json.dumps(record).encode() + b"\n"
        packed = lzma.compress(line)
        bad = {"text.jsonl": (b"no record\n", ":1: is not JSON"), "number.jsonl": (b"3\n", ":1: is no record of tandem"),
               "list.jsonl": (b"[]\n", ":1: is no record of tandem"), "other.jsonl": (b'{"a": 1}\n', ":1: is no record of tandem"),
               "deep.jsonl": (b"[" * 100000 + b"\n", ":1: is not JSON"), "bytes.jsonl": (bytes(range(256)), "is not JSON"),
               "nan.jsonl": (json.dumps({**record, "total_ns": math.nan}).encode() + b"\n", ":1: is not JSON"),
               "half.jsonl": (b'{"key": "\\ud83d"}\n', ":1: is not JSON"), "second.jsonl": (line + b'{"schema":4,"key"\n', ":2: is not JSON"),
               "torn.jsonl": (line[:100], "torn.jsonl: its only line has no end"),
               "old.jsonl": (json.dumps({**record, "schema": 2}).encode() + b"\n", [":1: a record of schema 2", "scripts/convert_records"]),
               "newer.jsonl": (json.dumps({**record, "schema": 9}).encode() + b"\n", [":1: a record of schema 9", "use the package"]),
               "empty.jsonl": (b"", "is empty"), "empty.jsonl.xz": (lzma.compress(b""), "is empty"),
               "half.jsonl.xz": (packed[:len(packed) // 2], "half.jsonl.xz: "), "odd.jsonl.xz": (packed[:300] + b"odd" + packed[303:], "odd.jsonl.xz: ")}
        for name, (data, expected) in bad.items():
            path = self.work / name
            path.write_bytes(data)
            for reader in ("tables", "figures"):
                with self.subTest(f"{reader} {name}"):
                    # An unfinished line causes a warning, and may be the only line.
                    status, _, errors = script(reader, path, *([self.work / "none"] if reader == "figures" else []))
                    self.assertEqual((status, len(errors)), (2, 1 + (name == "torn.jsonl")), errors)
                    self.assertTrue(errors[-1].startswith("tandem: "), errors)
                    for part in [expected] if isinstance(expected, str) else expected:
                        self.assertIn(part, errors[-1])
        for name in ("text.jsonl", "list.jsonl", "bytes.jsonl", "second.jsonl", "torn.jsonl", "empty.jsonl", "half.jsonl.xz", "odd.jsonl.xz", "deep.jsonl"):
            with self.subTest(f"convert_records {name}"):
                self.refused("convert_records", name, self.work / name)
                self.assertEqual((self.work / name).read_bytes(), bad[name][0])
        for reader, folder in (("tables", "is a folder"), ("figures", "is a folder"), ("convert_records", "directory")):
            more = [self.work / "none"] if reader == "figures" else []
            self.refused(reader, ["absent.jsonl", "No such file"], self.work / "absent.jsonl", *more)
            self.refused(reader, folder, self.work, *more)
        frameless = {**record, "frames": {"first": 1, "last": 0}}
        self.refused("tables", "frameless.jsonl:1: is no record of a cell (ZeroDivisionError", self.file("frameless.jsonl", [frameless]))
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
        whole = self.file("whole.jsonl", committed("h200/accuracy.jsonl")[:2])
        torn = self.work / "cut.jsonl"
        torn.write_text(whole.read_text() + whole.read_text()[:100])
        for reader, more in (("tables", []), ("figures", [self.work / "of the whole"])):
            code, text, errors = script(reader, torn, *more)
            self.assertEqual((code, text, len(errors)), (0, self.output_of(reader, whole, *more), 1))
            self.assertIn("cut.jsonl:3: the last line has no end", errors[0])

    def test_errors_for_arbitrary_bytes_are_one_line(self):
        """The inputs of the fuzz target of records, which the readers in C++ get as well."""
        inputs = sorted((SOURCE / "tests/fuzz/corpus/records").iterdir())
        self.assertGreater(len(inputs), 3)
        export = importlib.import_module("tandem.commands.export_csv")
        for path in inputs:
            for read in (lambda: script("tables", path), lambda: script("figures", path, self.work / "odd"), lambda: called(export, f"--records={path}")):
                code, _, errors = read()
                errors = [line for line in errors if "the last line has no end" not in line]
                self.assertIn((code, len(errors)), ((0, 0), (2, 1)), (path.name, errors))

    def test_the_standard_library_is_enough(self):
        """Reading, tables, exports and conversion work without the packages of the system and of users."""
        walks, copy = SOURCE / "results/cpu/walks.jsonl", self.work / "walks.jsonl"
        shutil.copy(walks, copy)
        programs = PROGRAM.parent / "libexec/tandem"
        for words in ((programs / "export-csv", f"--records={walks}"), (programs / "tables", walks), (SOURCE / "scripts/convert_records", copy)):
            done = subprocess.run(["/usr/bin/python3", "-S", "-I", *map(str, words)], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""), words)
            self.assertGreater(len(done.stdout), 20)
        self.assertEqual(copy.read_bytes(), walks.read_bytes())

    def test_older_records_are_converted_to_the_newest_schema(self):
        """What schema 3 of cells (2 of simulations, 1 of profiles) called otherwise, and nothing else, changes; converting again changes nothing."""
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
        for name in ("h200/plan.jsonl", "h200/auto.jsonl", "h100x2/shares.jsonl", "h100x2/passage/hosts.jsonl", "h200/profile.jsonl", "h200/simulation-funnel.jsonl"):
            records = committed(name)
            presets.update(record["preset"] for record in records if record.get("algorithm") == "chunked")
            path = self.work / "older.jsonl"
            path.write_text("".join(json.dumps({**older(record), "schema": record["schema"] - 1}) + "\n" for record in records))
            self.refused("tables", "convert_records", path)
            self.output_of("convert_records", path)
            self.assertEqual([json.loads(line) for line in path.read_text().splitlines()], records, name)
            once = path.read_bytes()
            self.output_of("convert_records", path)
            self.assertEqual(path.read_bytes(), once)
        self.assertEqual(presets, {"grouped", "paper", "published"})

    def test_cells_that_failed_or_are_wrong_are_shown_and_never_ranked(self):
        plates = {record["algorithm"] + record["preset"]: record for record in reversed(committed("h200/plates.jsonl"))
                  if record["settings"]["k"] == "8" and record["devices"][0]["id"] == "cuda:0"}
        first, second, third = (plates[name] for name in ("chunkedgrouped", "chunkedpublished", "gproximityfair"))
        fastest = {**first, "status": "wrong", "agreement": {**first["agreement"], "missing": 7, "extra": 0}}
        lost = {**second, "status": "failed", "failure": "the device | was\nlost", "total_ns": None, "breakdown_ns": None, "stages": {}, "work": None,
                "agreement": None, "conditions": None}
        rows = rows_of(self.table(fastest, lost, third))
        self.assertEqual([row[-1] for row in rows[:4]], ["notes", "WRONG: 7 missing", "failed: the device \\| was lost", ""])
        self.assertEqual([cell for row in rows for cell in row if "**" in cell], [])
        self.assertEqual(len(rows), 4) # no ratios
        rows = rows_of(self.table(third, lost, first))
        self.assertEqual(["**" in row[-2] for row in rows[:4]], [False, False, False, True])
        self.assertEqual(rows[4][0], "gProximity / chunked")

    def test_labels_name_the_differences(self):
        def cell(device=0, commit=None, asked=None, **settings):
            record = json.loads(json.dumps(committed("h200/tiled.jsonl")[0]))
            record["settings"].update(settings)
            record["asked"] = asked or {}
            record["devices"] = [{**record["devices"][0], "id": f"cuda:{d}", "hardware": f"{d}" * 16} for d in ([device] if isinstance(device, int) else device)]
            record["environment"]["commit"] = commit or record["environment"]["commit"]
            return record
        name_of = lambda *records: [tuple(row[:2]) for row in rows_of(self.table(*records))[1:len(records) + 1]]
        plain = name_of(cell())[0]
        self.assertEqual(plain[1], "cuda:0")
        self.assertEqual(name_of(cell(threads="1"), cell(threads="4")), [(f"{plain[0]} threads=1", "cuda:0"), (f"{plain[0]} threads=4", "cuda:0")])
        self.assertEqual(name_of(cell(), cell((0, 1))), [plain, (plain[0], "cuda:0+cuda:1")])
        # An adjusted group size does not make a different cell.
        self.assertEqual(name_of(cell(0, group_size="64"), cell(1, asked={"group_size": "64"}, group_size="1")), [plain, (plain[0], "cuda:1")])
        self.assertEqual([name for name, _ in name_of(cell(), cell(commit="a" * 40), cell(commit="a" * 40))],
                         [f"{plain[0]} @{cell()['environment']['commit'][:7]}", f"{plain[0]} @aaaaaaa", f"{plain[0]} @aaaaaaa (2)"])
        other = cell()
        other["devices"][0].update(name="Another", hardware="f" * 16)
        self.assertEqual([device for _, device in name_of(cell(), other)], ["cuda:0 NVIDIA H200", "cuda:0 Another"])
        self.assertEqual(self.table(cell(rounding="safe"), cell(rounding="published")).count("\n### "), 2)
        chosen = next(record for record in committed("h200/auto.jsonl") if record["chosen"])
        self.assertIn(f"chosen by auto of {chosen['chosen']['of']}", self.table(chosen))

    def test_other_kinds(self):
        profile = self.work / "own.jsonl"
        status, text, errors = tandem("profile", "plates", "--frames", 60, "--algorithm", "tiled", "--set", "k=6", "--repeat", 2, "--device", "host", "--out", profile,
                                      *sets({name: SMALL[name] for name in ("pair_capacity", "contact_capacity", "tile_pair_capacity")}))
        self.assertEqual((status, errors), (0, []), text)
        kernels = json.loads(profile.read_text())["kernels"]
        steps = committed("h200/simulation-funnel.jsonl")
        text = self.output_of("tables", profile, SOURCE / "results/h200/ceilings.jsonl", self.file("simulation.jsonl", [*steps, *steps[:5]]))
        rows = {row[0]: row for row in rows_of(text)}
        ceilings = [row[2] for row in rows_of(text) if row[0].startswith("cuda:0")]
        for kernel in kernels:
            self.assertEqual(rows[kernel["entry"]][1:2], [kernel["stage"]])
            self.assertIn("±", rows[kernel["entry"]][2])
        self.assertEqual(ceilings, ["3908", "3937"])
        self.assertIn("150", rows[steps[-1]["scene"]["key"]])
        self.assertIn("5 steps of a simulation that has not ended", text)
        self.refused("figures", "no record has errors", profile, self.work / "none")

    def test_long_files(self):
        """A hundred thousand cells of one scene, each with its own setting, in bounded memory."""
        record = {**committed("h200/plates.jsonl")[0], "kernels": [], "conditions": None, "kernel_times": {}, "breakdown_ns": None, "device_span_ns": None}
        record["total_ns"] = {**record["total_ns"], "frames": [], "samples": []}
        path, count = self.work / "long.jsonl", 100000 if LONG else 4000
        with open(path, "w") as out:
            for i in range(count):
                settings = {**record["settings"], "threads": str(i)}
                algorithm, preset = (("chunked", "grouped"), ("gproximity", "fair"))[i % 2]
                out.write(json.dumps({**record, "algorithm": algorithm, "preset": preset, "settings": settings}) + "\n")
        text = self.output_of("tables", path, address_space=1 << 29)
        self.assertEqual(text.count("threads="), count + count) # a row each, and half as many ratios, each of two cells
        self.assertIn("only those to the fastest chunked cell are shown", text)
        path.unlink()

    def test_figures_report_missing_data(self):
        records = [record for record in committed("h200/accuracy.jsonl") if record["settings"]["contact_rule"] == "opposing"][:3]
        truth = {**records[0]["error"]["truth"], "contacts": None}
        bare = [{**record, "error": {**record["error"], "truth": truth}} for record in records]
        nothing = {**truth, **{name: 0 for name in ("touching", "overlapping", "missed_touching", "missed_overlapping", "candidates", "false")}, "candidate_ratio": None}
        met = [{**record, "error": {**record["error"], "truth": nothing}} for record in records]
        hard = [{**record, "scene": {**record["scene"], "name": "hard", "key": f"hard:touch:difficulty={i}"}} for i, record in enumerate(met)]
        swept = [{**record, "settings": {**record["settings"], "group_size": str(32 << i), "placement": "exact" if i else "rounded"}} for i, record in enumerate(bare)]
        many = [{**bare[0], "settings": {**bare[0]["settings"], "group_size": str(i)}} for i in range(205)]
        folder = self.work / "lacking"
        for name, cells, figure, expected in (("bare", bare, "pareto", "nothing to draw: no cell was asked for this"),
                                              ("one", bare[:1], "pareto", "one cell"),
                                              ("met", met, "bars", "nothing to draw: no pairs meet"),
                                              ("hard", hard, "cliffs", "nothing to draw: no pairs meet"),
                                              ("swept", swept, "bars", "group_size=64"), ("swept", swept, "pareto", "placement exact, rounded"),
                                              ("many", many, "bars", "the first 200 of 205 configurations"), ("many", many, "pareto", "(205 values)")):
            with self.subTest(name):
                self.output_of("figures", self.file(f"{name}.jsonl", cells), folder)
                self.assertIn(expected, (folder / f"{figure}.svg").read_text())
        self.assertIn("group_size", (folder / "pareto.csv").read_text().splitlines()[0].split(","))
        wrong = {**records[1], "status": "wrong"}
        self.assertIn("1 records drawn", text := self.output_of("figures", self.file("wrong.jsonl", [records[0], wrong]), folder))
        self.assertIn("1 failed, wrong or untimed left out", text)
        self.refused("figures", "the last argument", self.file("a.jsonl", records), self.work / "a.jsonl")
        if os.geteuid() != 0:
            folder.chmod(0o500)
            self.refused("figures", "cannot write", self.work / "a.jsonl", folder, code=3)

    def test_pareto_names_the_cells_that_none_beats(self):
        """Four synthetic cells: fast and coarse, slow and exact, one beaten by both, and the best of all, which
        misses pairs."""
        record = next(record for record in committed("h200/accuracy.jsonl") if record["error"]["truth"]["contacts"])

        def cell(k, ms, ratio, missed=0):
            frames = record["frames"]["last"] - record["frames"]["first"] + 1
            ns = {**record["total_ns"], "median": ms * 1e6 * frames, "low": 0.99 * ms * 1e6 * frames, "high": 1.01 * ms * 1e6 * frames}
            truth = {**record["error"]["truth"], "candidate_ratio": ratio, "missed_touching": missed}
            return {**record, "settings": {**record["settings"], "k": str(k)}, "total_ns": ns, "error": {**record["error"], "truth": truth}}
        cells = [cell(8, 1, 4), cell(26, 2, 1.6), cell(14, 3, 3), cell(6, 0.5, 1.5, missed=1), cell(18, 2.01, 1.6)]
        folder = self.work / "named"
        self.output_of("figures", self.file("named.jsonl", cells), folder)
        text = (folder / "pareto.svg").read_text()
        for expected in ("k=8: the fastest; k=26: 2.50 times fewer candidates for 2.00 times the time", "<!-- k=8 -->", "<!-- k=26 (and 1 alike) -->"):
            self.assertIn(expected, text)
        for beaten in (14, 6, 18):
            self.assertNotIn(f"<!-- k={beaten}", text)
        self.output_of("figures", self.file("named.jsonl", [cell(8, 1, 4), cell(18, 2, 4)]), folder)
        self.assertIn("k=8: the fastest, and nothing is better", (folder / "pareto.svg").read_text())

    def test_pictures(self):
        try:
            subprocess.run(["/usr/bin/python3", "-c", "import numpy, PIL"], check=True, capture_output=True)
        except subprocess.CalledProcessError:
            self.skipTest("no numpy or no Pillow")
        glb, out = self.work / "plates.glb", self.work / "picture"
        status, text, errors = tandem("export", "plates", "--frames", "0:10", "--every", 5, "--glb", glb)
        self.assertEqual((status, errors), (0, []), text)
        self.assertEqual(self.output_of("render", glb, out, "--at", "0,1", "--size", "64x48"), f"{out}-0.png\n{out}-1.png\n")
        data, bad = glb.read_bytes(), self.work / "bad.glb"
        for length, expected in ((0, "empty"), (3, "no .glb"), (4, "ends within"), (16, "ends within"), (100, "ends within"), (len(data) - 1, "ends within")):
            bad.write_bytes(data[:length])
            self.refused("render", expected, bad, out)
        for name, text in (("list", "[]"), ("no nodes", "{}"), ("empty", '{"nodes": []}'), ("far", '{"nodes":[{"mesh":7}],"meshes":[]}'), ("text", "{")):
            text = text.encode().ljust(64)
            bad.write_bytes(data[:12] + len(text).to_bytes(4, "little") + b"JSON" + text + (4).to_bytes(4, "little") + b"BIN\0" + bytes(4))
            with self.subTest(name):
                self.refused("render", "bad.glb: ", bad, out)
        self.refused("render", "No such file", self.work / "absent.glb", out)
        self.refused("render", "cannot be written", glb, self.work / "absent/picture", code=3)
        for option in ("--at=2", "--at=x", "--size=0x4", "--size=9", "--zoom=0", "--box=1,2", "--from=0,0,0", "--cut=x", "--unheard-of"):
            self.refused("render", option.split("=")[0], glb, out, option)

    def test_commands_of_the_pictures_equal_the_page(self):
        """Each row of the table contains the command of its three pictures."""
        status, text, errors = script("pictures", "--list")
        self.assertEqual((status, errors), (0, []))
        page = SOURCE / "docs/user/scenes.md"
        rows = [row for row in page.read_text().splitlines() if "-0.png" in row]
        self.assertEqual([re.match(r"\|`(.*?)`", row)[1] for row in rows], text.splitlines())
        for row in rows:
            pictures = re.findall(r"\]\((.*?)\)", row)
            self.assertEqual([path[-6:] for path in pictures], ["-0.png", "-1.png", "-2.png"], row)
            for path in pictures:
                self.assertTrue((page.parent / path).is_file(), path)

    def test_tables_of_pages_equal_the_records(self):
        plan = SOURCE / "results/h200/plan.jsonl"
        for page in ("README.md", "results/h200/README.md"):
            copy = self.work / "page.md"
            text = (SOURCE / page).read_text()
            self.assertIn("<!-- answer: ", text)
            copy.write_text(re.sub(r"(<!-- answer: [a-z ]+ -->).*?<!-- end -->", r"\1 <!-- end -->", text, flags=re.DOTALL))
            self.assertNotEqual(copy.read_text(), text)
            self.assertEqual(script("answer", plan, "--write", copy), (0, "", []))
            self.assertEqual(copy.read_text(), text, page)
        copy.write_text("<!-- answer: nothing -->\n<!-- end -->\n")
        pile = SOURCE / "results/h200/pile.jsonl"
        for arguments, expected in (((plan, "--write", copy), "no table 'nothing'"), ((plan, "--write", self.work / "none.md"), "none.md: cannot be read"),
                                    ((self.work / "none.jsonl",), "No such file"), ((copy,), "is not JSON"), ((pile,), "pile.jsonl:1: is no record of a cell of the plan"),
                                    ((plan, "--picture"), "expected one argument"), ((), "arguments are required")):
            self.refused("answer", expected, *arguments)
        self.refused("answer", "none/a.svg: cannot be written", plan, "--picture", self.work / "none/a.svg", code=3)
        few = self.file("few.jsonl", committed("h200/plan.jsonl")[:3])
        self.refused("answer", "--picture needs all scenes of the plan", few, "--picture", self.work / "few.svg")

    def test_the_table_of_trials_equals_its_lines(self):
        tried, copy = SOURCE / "results/tried.jsonl", self.work / "page.md"
        text = (SOURCE / "README.md").read_text()
        copy.write_text(re.sub(r"<!-- tried -->.*?<!-- end -->", "<!-- tried --><!-- end -->", text, flags=re.DOTALL))
        self.assertNotEqual(copy.read_text(), text)
        self.assertEqual(script("tried", tried, "--write", copy), (0, "", []))
        self.assertEqual(copy.read_text(), text)
        line = json.loads(tried.read_text().splitlines()[0])
        bad = self.work / "tried.jsonl"
        for lines, message in (("", "has no lines"), ("{}\n", "tried.jsonl:1: no line of what was tried"), (json.dumps({**line, "count": "3"}), "tried.jsonl:1: no line")):
            bad.write_text(lines)
            status, _, errors = script("tried", bad)
            self.assertEqual((status, len(errors)), (1, 1), errors)
            self.assertIn(message, errors[0])
        bad.write_text(json.dumps({**line, "count": 1}) + "\n" + json.dumps({**line, "count": 2222}) + "\n")
        self.assertIn("2,222", script("tried", bad)[1])  # the newest of each
        self.assertEqual(len(script("tried", bad)[1].splitlines()), 3)

    def test_the_picture_of_the_pages_equals_the_records(self):
        """Compares words, which are comments beside their outlines; the outlines depend on the library."""
        words = lambda path: re.findall(r"<!-- (.*?) -->", path.read_text())
        drawn = self.work / "answer.svg"
        self.assertEqual(script("answer", SOURCE / "results/h200/plan.jsonl", "--picture", drawn), (0, "", []))
        self.assertGreater(len(words(drawn)), 10)
        self.assertEqual(words(SOURCE / "results/h200/answer.svg"), words(drawn))

    def test_numbers_of_the_readme_are_generated(self):
        """Measured numbers occur only between the marks of tandem.answer."""
        text = re.sub(r"<!-- answer: [a-z ]+ -->.*?<!-- end -->|^    .*?$", "", (SOURCE / "README.md").read_text(), flags=re.DOTALL | re.MULTILINE)
        self.assertEqual(re.findall(r"\d[\d.,]* ?(?:%|ms|us|ns|s|GB|GiB|MB|times|minutes|seconds)(?![A-Za-z])", text), [])

    def test_quotes_equal_the_examples(self):
        """The user guide quotes every example, and every quote is in its file."""
        quoted, folder = collections.Counter(), SOURCE / "scripts/examples"
        for page in sorted((SOURCE / "docs/user").glob("*.md")):
            text = page.read_text()
            self.assertEqual(wrong_quotes(text), [], page.name)
            quoted.update(name for name, _ in QUOTE.findall(text))
        examples = {str(p.relative_to(SOURCE)) for p in folder.iterdir() if p.suffix in (".cpp", ".h", ".py")}
        self.assertGreater(len(examples), 4)
        self.assertLessEqual(examples, set(quoted))

    def test_wrong_quotes_are_detected(self):
        name = "scripts/examples/find_pairs.h"
        lines = (SOURCE / name).read_text().splitlines()
        page = lambda *quote: "\n".join([f"<!-- quote: {name} -->", "```cpp", *quote, "```", ""])
        self.assertEqual(wrong_quotes(page(*lines)), [])
        self.assertEqual(wrong_quotes(page(*(line[4:] for line in lines if line.startswith("    ")))), [])
        for quote in ([lines[0] + ";"], [lines[0], lines[2]], []):
            self.assertEqual(wrong_quotes(page(*quote)), [f"{name}: has no such lines: {(quote or [''])[0]}"])
        self.assertEqual(wrong_quotes(page(lines[0]).replace(name, "scripts/examples/absent.h")), ["scripts/examples/absent.h: no such file"])
        self.assertEqual(wrong_quotes("```cpp\nint i;\n```\n"), ["1 blocks of C++ and 0 quotes of it"])
        self.assertEqual(wrong_quotes(f"<!-- quote: {name} -->\ntext\n"), ["1 marks and 0 quotes"])

    def test_committed_microbenchmarks(self):
        """The data that compare.py of Google Benchmark reads: the same repetitions for every benchmark except
        partitions, and nothing that identifies the machine."""
        result = json.loads((SOURCE / "results/cpu/bench.json").read_text(), parse_constant=self.fail)
        context = result["context"]
        self.assertEqual({"host_name", "executable"} & set(context), set())
        self.assertRegex(context["commit"], "^[0-9a-f]{40}$")
        self.assertIs(context["dirty"], False)
        self.assertGreater(len(context["processor"]), 3)
        repetitions = {}
        for one in result["benchmarks"]:
            self.assertIn(one["run_type"], ("iteration", "aggregate"))
            self.assertTrue({"name", "run_name", "family_index", "per_family_instance_index", "repetitions"} <= set(one), one)
            if one["run_type"] == "aggregate":
                self.assertIn("aggregate_name", one)
                continue
            self.assertIn(one["time_unit"], ("ns", "us", "ms", "s"))
            self.assertGreater(min(one["real_time"], one["iterations"]), 0)
            self.assertGreaterEqual(one["cpu_time"], 0)
            repetitions.setdefault(one["name"], []).append(one["repetition_index"])
        for name, own in repetitions.items():
            # the U test needs nine; a partition takes seconds
            times = 1 if re.match("partition,|ghosts,", name) else 10
            self.assertEqual(sorted(own), list(range(times)), name)
        self.assertGreater(len(repetitions), 50)
        compare = shutil.which("compare.py", path="/usr/share/benchmark")
        if compare and subprocess.run(["/usr/bin/python3", "-c", "import numpy, scipy"], capture_output=True).returncode == 0:
            file = SOURCE / "results/cpu/bench.json"
            done = subprocess.run(["/usr/bin/python3", compare, "--no-color", "benchmarks", file, file], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout, r"OVERALL_GEOMEAN +\+0.0000")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
