#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""command_line.py PROGRAM SOURCE: the command line of the program: listings, tables, dumps, and bad input."""
import itertools
import json
import re
import subprocess
import sys
import unittest

from program import LONG, PROGRAM, SMALL, SOURCE, Case, bar, gmsh, sets, tandem


def boxes(points, tets):
    return [[(min(points[v][axis] for v in t), max(points[v][axis] for v in t)) for axis in range(3)] for t in tets]


def overlapping(a, b):
    """Pairs of tetrahedra whose boxes overlap or touch. Coordinates are multiples of 1/8, so this is exact."""
    return [(i, j) for i, x in enumerate(boxes(*a)) for j, y in enumerate(boxes(*b))
            if all(p[0] <= q[1] and q[0] <= p[1] for p, q in zip(x, y))]


def own_algorithms():
    """The algorithms that run by default."""
    return [entry for entry in json.loads(tandem("algorithms", "--json")[1]) if not entry["baseline"]]


class CommandLine(Case):
    def test_listings(self):
        keys = {"devices": {"backend", "reason", "devices"}, "scenes": {"name", "models", "parameters", "bodies", "vertices", "tetrahedra"},
                "algorithms": {"name", "baseline", "summary", "parameters", "presets"}}
        for name, words in (("devices", ["host", "opencl:0"]), ("scenes", ["plates", "pile", "density", "glasses", "1729", "14793", "16140"]),
                            ("algorithms", ["chunked", "gproximity", "tiled", "embree", "unc2010", "seed_threshold"])):
            status, out, errors = tandem(name)
            self.assertEqual((status, errors), (0, []))
            for word in words:
                self.assertIn(word, out)
            status, out, errors = tandem(name, "--json")
            self.assertEqual((status, errors), (0, []))
            entries = json.loads(out)
            self.assertGreater(len(entries), 1)
            for entry in entries:
                self.assertLessEqual(keys[name], set(entry))
            self.assertTrue(all(word in out for word in words))

    def test_check_prints_the_matrix(self):
        presets = sum(len(entry["presets"]) for entry in own_algorithms())
        devices = [d["id"] for entry in json.loads(tandem("devices", "--json")[1]) for d in entry["devices"]]
        for arguments in (("plates", "--frames", "20:21"), ("pile:bodies=8,frames=2",))[0 if LONG else 1:]:
            status, out, errors = tandem("check", *arguments)
            self.assertEqual((status, errors), (0, []), out)
            rows = [line.split() for line in out.splitlines() if line.split()[:1] and line.split()[0] in devices]
            self.assertEqual(len(rows), presets * len(devices), out)
            for row in rows:
                self.assertGreater(int(row[3]), 0)
                self.assertEqual((row[4:6], row[8]), (["0", "0"], "yes"), out)
            self.assertIn("\nall agree with the reference\n", out)

    def test_dumps_agree_with_brute_force(self):
        parts = [bar(4, (0, 0, 0)), bar(3, (0.5, 0.25, 0.375))]
        files = [gmsh(self.work / f"part{i}.msh", *part) for i, part in enumerate(parts)]
        header = ("frame,body_a,tet_a,body_b,tet_b", "frame,body_a,tet_a,body_b,tet_b,px,py,pz,nx,ny,nz,depth")
        # Poses without rounding: a translation, and half a turn about z.
        for pose, sign, shift in (("0.125 0 0 1 0 0 0", 1, (0.125, 0, 0)), ("3.5 1 -0.375 0 0 0 1", -1, (3.5, 1, -0.375))):
            moved = ([(sign * x + shift[0], sign * y + shift[1], z + shift[2]) for x, y, z in parts[1][0]], parts[1][1])
            expected = [(0, 0, a, 1, b) for a, b in overlapping(parts[0], moved)]
            self.assertGreater(len(expected), 50)
            self.assertLess(len(expected), len(parts[0][1]) * len(parts[1][1]))
            for algorithm, rounding in itertools.product(("chunked", "gproximity"), ("nearest", "safe")):
                pairs, contacts, out = (self.work / f"d{len(list(self.work.iterdir()))}.{end}" for end in ("p", "c", "jsonl"))
                status, text, errors = tandem("run", "--mesh", files[0], "--mesh", files[1], "--pose", "0 0 0 1 0 0 0", "--pose",
                                              pose, "--set", "k=6", "--set", f"rounding={rounding}", "--algorithm", algorithm,
                                              "--repeat", 1, *(() if LONG or rounding == "safe" else ("--device", "host")),
                                              "--dump-pairs", pairs, "--dump-contacts", contacts, "--out", out)
                self.assertEqual((status, errors), (0, []), text)
                self.assertEqual(self.dump(pairs, header[0])[1], expected)
                work = self.records(out)[0]["work"]
                self.assertEqual(work["candidate_pairs"], [len(expected)])
                rows, ids = self.dump(contacts, header[1])
                self.assertEqual(len(rows), work["contacts"][0])
                self.assertGreater(len(rows), 10)
                self.assertLessEqual(set(ids), set(expected))
                for row in rows:
                    self.assertAlmostEqual(sum(float(x) ** 2 for x in row[8:11]), 1, places=5)

    def test_dumps_of_several_frames(self):
        pairs, contacts, out = (self.work / name for name in ("p.csv", "c.csv", "frames.jsonl"))
        status, text, errors = tandem("run", "plates", "--frames", "20:21", "--repeat", 1, "--algorithm", "gproximity",
                                      "--dump-pairs", pairs, "--dump-contacts", contacts, "--out", out)
        self.assertEqual((status, errors), (0, []), text)
        work = self.records(out)[0]["work"]
        for path, columns, counts in ((pairs, 5, work["candidate_pairs"]), (contacts, 12, work["contacts"])):
            header = "frame,body_a,tet_a,body_b,tet_b,px,py,pz,nx,ny,nz,depth".split(",")[:columns]
            ids = self.dump(path, ",".join(header))[1]
            self.assertEqual([sum(row[0] == frame for row in ids) for frame in (20, 21)], counts)
            self.assertEqual(len(ids), sum(counts))
        self.assertTrue(all(a < b for _, a, _, b, _ in self.dump(pairs, "frame,body_a,tet_a,body_b,tet_b")[1]))

    def test_tiny_capacities_retry(self):
        out = self.work / "tiny.jsonl"
        status, text, _ = tandem("run", "pile:bodies=6,frames=1", "--algorithm", "chunked,gproximity", "--set", "pair_capacity=1",
                                 "--set", "contact_capacity=1", "--out", out)
        self.assertEqual(status, 0, text)
        for record in self.records(out):
            self.assertGreater(record["work"]["retries"], 0)

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
        reasons = {"short.msh": "", "nan.msh": "nan", "count.msh": "999999999999", "range.msh": "5001", "hexa.msh": "hexahedr"}
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
        for path, reason in ((noise, ""), (surface, "no tetrahedra"), (self.work / "missing.msh", ""), (self.work, "folder")):
            self.bad([str(path), reason], "run", "--mesh", path)

    def test_hard_cases(self):
        fast = ("--device", "host", "--quiet", "--preset", "grouped,resident,fair", *(() if LONG else sets(SMALL)))
        status, out, errors = tandem("check", "hard:corner-cancellation", "--set", "k=8", "--set", "rounding=nearest,safe", *fast)
        self.assertEqual((status, errors), (0, []), out)
        missed = [int(line.split()[-2]) for line in out.splitlines() if line.startswith("host ")]
        nearest, safe = missed[::2], missed[1::2]
        algorithms = own_algorithms()
        self.assertEqual((len(missed), set(safe)), (2 * len(algorithms), {0}), out)
        self.assertGreater(min(nearest), 0, out)
        status, out, errors = tandem("check", "hard:all:pairs=2,together=2", *fast)
        self.assertEqual((status, errors), (0, []), out)
        rows = [line for line in out.splitlines() if line.startswith("hard:")]
        self.assertEqual(len(rows), 44)
        refusal = "tetrahedra 2 not finite in 1 of 2 bodies: body 0 tetrahedron 0, 1 in frame 0; "
        self.assertIn("refused: " + refusal, rows[9])
        self.assertEqual(rows[10].split(), ["hard:not-finite", "1", "0", "0", "0", "0", str(len(algorithms)), "0", "skipped:", "2"])
        self.assertIn("rounding=safe misses no pair that touches or overlaps", out)
        self.bad("unknown family of hard cases 'tuch'; the nearest is 'touch'", "check", "hard:tuch")
        self.bad("difficulty=10 is impossible; give a number from 1 to 9", "run", "hard:touch:difficulty=10")
        self.bad("hard:all accepts seed, pairs and together", "check", "hard:all:difficulty=1")

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
        for value in ("pile:density=-1", "pile:density=nan", "pile:bodies=0", "pile:bodies=2.5", "plates:count=99999999999999999"):
            self.bad("impossible", "run", value)
        # More than any machine's memory: nothing is generated.
        for value in ("pile:bodies=10000000,refine=4", "plates:count=100000,refine=4", "funnel:bodies=1000000,refine=3", "glasses:bodies=1000000,refine=3"):
            self.bad(["bodies of mesh", "take at least"], "run", value)
        self.bad("no value", "run", "pile:density")
        self.bad("the nearest is 'jack'", "run", "pile:mesh=jak")
        self.bad("absent.json", "run", self.work / "absent.json")

    def test_errors_that_quote_a_file_are_one_line(self):
        scene = self.work / "controls.json"
        scene.write_text('{"meshes": {"a\\n\\u001b[31mb": {"builtin": "jac"}}, "bodies": []}')
        self.bad(r"/meshes/a\n\x1b[31mb/builtin: unknown mesh 'jac'", "run", scene, "--device", "host")
        self.bad(r"no\nsuch.json: cannot be read", "run", "no\nsuch.json", "--device", "host")

    def test_bad_use(self):
        self.bad("the nearest is 'chunked'", "run", "plates", "--algorithm", "chunkd")
        self.bad("the nearest is 'seed_threshold'", "run", "plates", "--set", "seed_treshold=1")
        self.bad("the nearest is 'opencl:0'", "run", "plates", "--device", "opencl:7")
        self.bad("the nearest is 'fair'", "run", "plates", "--preset", "fairr")
        renamed = "preset 'resident' of chunked is now called 'grouped'"
        for names in ("resident", "resident,fair"):  # without a preset of chunked by its own name
            self.bad(renamed, "run", "plates", "--preset", names, "--dry-run")
        self.bad(renamed, "run", "plates", "--algorithm", "chunked", "--preset", "resident", "--dry-run")
        self.assertEqual(tandem("run", "plates", "--device", "host", "--preset", "grouped,resident,fair", "--dry-run")[0], 0)
        self.bad("the nearest is 'opencl:0'", "check", "plates", "--device", "opencl:7")
        self.bad("the nearest is 'chunked'", "check", "plates", "--algorithm", "chunkd")
        for setting in ("k=10", "group_size=0", "leaves=3", "precision=half", "pair_capacity=-1", "pair_capacity=4294967296",
                        "k=6,,8", "axes=coordinate", "rounding=directed"):
            expected = "goes with k=8 only" if setting == "axes=coordinate" else "impossible"
            self.bad(expected, "run", "plates", "--algorithm", "chunked", "--set", setting, "--frames", "0")
        self.bad("goes with rounding=safe", "run", "plates", "--set", "placement=exact", "--set", "rounding=nearest")
        for frames in ("5:2", "0:500", "500", "x", "1:", "-1:2", "0:99999999999999999999"):
            self.bad("frames", "run", "plates", "--frames", frames)
        for pose in ("0 0 0 1 0 0", "0 0 0 1 0 0 0 0", "0 0 0 0 0 0 0", "nan 0 0 1 0 0 0", "a b c d e f g", ""):
            self.bad("--pose", "run", "--mesh", self.good, "--pose", pose)
        self.bad("--pose", "run", "--mesh", self.good, "--pose", "0 0 0 1 0 0 0", "--pose", "0 0 0 1 0 0 0")
        self.bad("exclude", "run", "plates", "--mesh", self.good)
        self.bad("scene", "run")
        self.bad("--set", "run", "plates", "--set", "k")
        self.bad("--help", "run", "plates", "--nonsense")
        self.bad("--help")
        for repeat in ("0", "-1", "x"):
            self.bad("--repeat", "run", "plates", "--repeat", repeat)
        self.bad("--help", "fly")

    def test_version(self):
        for arguments in (("--version",), ("run", "--version")):
            status, out, errors = tandem(*arguments)
            self.assertEqual((status, errors), (0, []))
            self.assertRegex(out, r"^tandem \d+\.\d+\.\d+, commit [0-9a-f]{7,}(, dirty)?, g\+\+ [\d.]+, with(out)? Embree[^\n]*\n$")
        version = re.search(r"project\(tandem VERSION ([\d.]+)", (SOURCE / "CMakeLists.txt").read_text())[1]
        summary = next(e["summary"] for e in json.loads(tandem("algorithms", "--json")[1]) if e["name"] == "embree")
        self.assertIn(f"tandem {version}, ", out)
        self.assertEqual("without Embree" in out, "built without Embree" in summary)
        record = self.work / "version.jsonl"
        tandem("run", "--mesh", self.good, "--device", "host", "--algorithm", "chunked", "--out", record)
        environment = self.records(record)[0]["environment"]
        self.assertIn(f", commit {environment['commit']}{', dirty' if environment['dirty'] else ''}, {environment['compiler']}, ", out)

    def test_unknown_words(self):
        """Unknown words of any form and position: the error names the nearest known word and the help."""
        for arguments, named in (
                (("run", "plates", "--algoritm"), "--algorithm"), (("run", "plates", "--algoritm", "tiled"), "--algorithm"),
                (("run", "--algoritm=tiled", "plates"), "--algorithm"), (("check", "plates", "--algoritm", "tiled"), "--algorithm"),
                (("run", "plates", "--algo"), "--algorithm"), (("run", "plates", "-devices", "host"), "--device"),
                (("compare", "a", "b", "--treshold=1"), "--threshold"), (("devices", "--jsn"), "--json"),
                (("run", "plates", "--algoritm", "--repeat", "x"), "--algorithm")):
            word = next(a for a in arguments if a.startswith("-")).split("=")[0]
            self.bad(f"tandem: unknown option {word}; did you mean {named}? see 'tandem {arguments[0]} --help'", *arguments)
        self.bad("tandem: unknown option --algoritm; did you mean --algorithm? see 'tandem --help'", "--algoritm", "scenes")
        self.bad("option --device must come after a command", "--device", "host", "run", "plates")
        for word, named in (("rum", "run"), ("algorithm", "algorithms"), ("devises", "devices")):
            self.bad(f"tandem: unknown command '{word}'; the nearest is '{named}' (there are: run, ", word, "--device", "host")
        self.bad("unknown command 'rum'", "--", "rum")
        self.bad("unexpected argument 'b'; see 'tandem check --help'", "check", "a", "b")
        self.bad("unexpected argument '--algoritm'", "check", "a", "--", "--algoritm")
        self.bad("unknown scene '--algoritm'", "run", "--", "--algoritm")
        self.bad("--set: 1 required", "run", "plates", "--set")
        for word in ("-", "--", "---", "--=", "-=", "-x", "=", ""):
            self.assertEqual(tandem(word, word)[0], 2, word)
            self.assertEqual(tandem("run", "--device", "host", word, word)[0], 2, word)

    def test_contradictions(self):
        """Options that would have no effect are refused, and the error names the conflicting option."""
        for message, *arguments in (
                (("--repeat cannot be combined with --noise", "N samples"), "--repeat", 3, "--noise", "1%"),
                ("--repeat cannot be combined with --seconds", "--seconds", 3, "--repeat", 3),
                ("--truth-contacts requires --truth contacts", "--truth", "none", "--truth-contacts", 3),
                ("--truth-contacts requires --truth contacts", "--truth-contacts", 3),
                ("--choose-seconds requires --algorithm auto", "--choose-seconds", 1),
                ("--choose-afresh requires --algorithm auto", "--choose-afresh", "--algorithm", "chunked,tiled"),
                ("--threads cannot be combined with --set threads", "--device", "host", "--threads", 1, "--set", "k=6", "--set", "threads=2"),
                ("--threads requires --device host", "--threads", 1),
                ("--threads requires --device host", "--threads", 1, "--device", "opencl:0,cuda:0"),
                *((f"--profile cannot be combined with {word}", "--profile", 1, word, *value)
                  for word, *value in (("--dry-run",), ("--resume", "--out", "x"), ("--repeat", 1), ("--noise", "1%"), ("--seconds", 1),
                                       ("--seed", 1))),
                ("--profile cannot be combined with --truth contacts", "--profile", 1, "--truth", "contacts"),
                ("--dry-run cannot be combined with --dump-pairs", "--dry-run", "--dump-pairs", "x"),
                ("--dry-run cannot be combined with --dump-contacts", "--dry-run", "--dump-contacts", "x"),
                ("--pose requires --mesh", "--pose", "0 0 0 1 0 0 0")):
            self.bad(message, "run", "plates:count=2", "--frames", 0, *arguments)
        for command in ("check", "accuracy", "export"):
            self.bad("--pose requires --mesh", command, "--pose", "0 0 0 1 0 0 0")
        self.bad("--truth-contacts requires", "check", "plates", "--truth-contacts", 3)
        self.bad("--threads cannot be combined with --set threads", "check", "plates", "--threads", 1, "--set", "threads=2")
        self.bad("--resume requires -o", "simulate", "arch", "--resume")
        self.bad("--checkpoint requires -o", "simulate", "arch", "--checkpoint", 3)
        self.bad("--steps", "simulate", "arch", "--steps", 0)
        self.bad("--every", "export", "plates", "--every", 0, "--glb", "x")
        self.bad("--contacts requires --vtu", "export", "plates", "--contacts", "--glb", "x")
        self.bad("--device requires --contacts", "export", "plates", "--device", "host", "--glb", "x")
        self.bad("--device all: contacts need one device", "export", "plates", "--contacts", "--device", "all", "--vtu", self.work / "vtu")
        for option in (("--device", "host"), ("--out", "x")):
            self.bad(f"{option[0]} requires --measure", "devices", *option)
        # Combinations that must be accepted: such options beside others, and where they have an effect.
        for arguments in (("--truth", "contacts", "--truth-contacts", 3), ("--threads", 1, "--set", "k=6"), ("--seconds", 1, "--noise", "1%"),
                          ("--algorithm", "chunked,auto", "--choose-afresh", "--choose-seconds", 1), ("--set", "threads=1,2")):
            status, out, errors = tandem("run", "--mesh", self.good, "--device", "host", *arguments, "--dry-run")
            self.assertEqual((status, errors), (0, []), out)

    def test_descriptions_of_algorithms(self):
        algorithms = json.loads(tandem("algorithms", "--json")[1])
        for entry in algorithms:
            status, out, errors = tandem("algorithms", entry["name"])
            self.assertEqual((status, errors), (0, []))
            self.assertEqual([line for line in out.splitlines() if len(line) > 100], [])
            initial = {p["name"]: p["default"] for p in entry["parameters"]}
            for preset in entry["presets"]:
                # The effective values: the preset's values replace the parameters' defaults.
                self.assertEqual(preset["settings"], {**initial, **preset["values"]})
                text = " ".join(out.split(f"\n    {preset['name']}: ")[1].split("\n    ")[1:6]).replace("    ", " ")
                for name, value in preset["settings"].items():
                    self.assertEqual(f"{name}={value}" in re.split(r"[\s,]+", text.split(": ")[0]), value != initial[name], (name, text))
            flat = " ".join(out.split())
            for parameter in entry["parameters"]:
                value = entry["presets"][0]["settings"][parameter["name"]]
                description = " ".join(f"{parameter['name']} = {value} {parameter['help']}".split())
                values = "choices: " + ", ".join(parameter["choices"]) if "choices" in parameter else "range: {}..{}".format(*parameter["range"])
                self.assertIn(f"{description} {values}", flat)
            for counter in entry["counters"]:
                self.assertIn(" ".join(f"{counter['name']} {counter['meaning']} [{counter['unit']}]".split()), flat)
            only = json.loads(tandem("algorithms", entry["name"], "--json")[1])
            self.assertEqual(only, [entry])
        self.assertIn("device in grouped, paper; sphere in published", tandem("algorithms", "chunked")[1])
        self.assertIn("device in resident; sphere where no preset sets it", tandem("algorithms", "tiled")[1])
        self.bad("the nearest is 'tiled'", "algorithms", "chunked", "tild")
        listing = tandem("algorithms")[1]
        self.assertEqual([line for line in listing.splitlines() if len(line) > 100], [])
        self.assertIn("settings, as in preset resident", listing)
        self.assertRegex(listing, r"\n    broad +device +how to find body pairs")
        self.assertIn("[sphere, tight, device; sphere where no preset sets it]", " ".join(listing.split()))

    def test_a_baseline_finds_the_same_pairs(self):
        """Same pairs in the same record, when the program has it. It refuses what it does not support, and its absence is an error."""
        summary = next(e["summary"] for e in json.loads(tandem("algorithms", "--json")[1]) if e["name"] == "embree")
        arguments = ("run", "pile:bodies=4,frames=1", "--device", "host", "--repeat", 1, "--set", "k=6")
        if "built without Embree" in summary:
            self.bad("libembree-dev", *arguments, "--algorithm", "embree")
            return
        out = self.work / "baseline.jsonl"
        status, text, errors = tandem(*arguments, "--algorithm", "chunked,embree", "--out", out)
        self.assertEqual((status, errors), (0, []), text)
        self.assertEqual(text.count(": right: "), 2, text)
        chunked, embree = self.records(out)
        self.assertGreater(embree["work"]["candidate_pairs"][0], 0)
        for name in ("digest", "contact_digest"):
            self.assertEqual(embree["agreement"][name], chunked["agreement"][name])
        for stage in ("refit", "traverse"):
            self.assertGreater(embree["stages"][stage]["device_ns"]["median"], 0)
        self.assertNotIn("embree", tandem(*arguments)[1])
        self.bad("choose k=6", *arguments[:-1], "k=18", "--algorithm", "embree")
        self.bad("choose float", *arguments, "--set", "precision=double", "--algorithm", "embree")
        for device in ("opencl:0", "host+opencl:0"):
            self.bad("device host only, not on opencl:0", "run", "plates", "--device", device, "--algorithm", "embree")

    def test_required_devices(self):
        available = {e["backend"] for e in json.loads(tandem("devices", "--json")[1]) if e["devices"]}
        absent = "cuda:99" if "cuda" in available else "cuda"
        for arguments in (("run", "plates"), ("check", "plates"), ("devices",)):
            self.bad(f"--require {absent}: ", *arguments, "--require", absent)
        self.assertEqual(tandem("devices", "--require", "host,opencl,opencl:0")[0], 0)

    def test_unwritable_output_is_detected_first(self):
        for option in ("--out", "--dump-pairs", "--dump-contacts"):
            out = self.bad("cannot be written", "run", "plates", "--frames", "0", option, self.work / "no/such/file")
            self.assertNotIn("traverse", out)

    def test_too_little_memory(self):
        """1 TiB is more than any device has: the error names both numbers, the record has status failed, and earlier
        records stay."""
        for device in ("host", "opencl:0"):
            out = self.work / f"memory{device}.jsonl"
            arguments = ("run", "--mesh", self.good, "--mesh", self.good, "--algorithm", "gproximity", "--device", device,
                         "--repeat", 1, "--out", out, "--set", "groups=64")
            self.assertEqual(tandem(*arguments)[0], 0)
            self.bad("of 5726623061 items and 2147483648 is the most; lower it, or raise groups", *arguments[:-1], "groups=16",
                     "--set", "queue_bytes=1099511627776")
            before = out.read_bytes()
            self.bad("queues", *arguments, "--set", "queue_bytes=67108864,1099511627776", code=3)
            self.assertTrue(out.read_bytes().startswith(before))
            records = self.records(out)
            self.assertEqual([r["status"] for r in records], ["ok", "ok", "failed"])
            needed, there_is = map(int, re.search(r"needs (\d+) bytes.* (\d+)$", records[2]["failure"]).groups())
            self.assertGreater(needed, 10**12)
            self.assertLess(there_is, needed)
            self.assertGreater(there_is, 0)

    def test_without_any_driver(self):
        nothing = {"OCL_ICD_VENDORS": "/nonexistent/"}
        status, out, errors = tandem("devices", environment=nothing)
        self.assertEqual((status, errors), (0, []))
        self.assertIn("opencl: no platform", out)
        reasons = {e["backend"]: e["reason"] for e in json.loads(tandem("devices", "--json", environment=nothing)[1])}
        self.assertIn("no platform", reasons["opencl"])
        self.bad("opencl: no platform", "run", "plates", "--device", "opencl:0", environment=nothing)
        self.bad("opencl: no platform", "run", "plates", environment=nothing)
        self.bad("opencl: no platform", "devices", "--require", "opencl", environment=nothing)
        status, out, _ = tandem("run", "--mesh", self.good, "--device", "host", environment=nothing)
        self.assertEqual(status, 0, out)


class Regressions(Case):
    """Regression tests of fixed errors."""

    def cell(self, *arguments, **options):
        return tandem("run", "--mesh", self.good, "--mesh", self.good, "--device", "host", "--algorithm", "chunked",
                      *arguments, **options)

    def test_check_takes_one_algorithm(self):
        for name in ("chunked", "gproximity"):
            status, out, errors = tandem("check", "plates", "--frames", "0", "--algorithm", name, "--device", "host")
            self.assertEqual((status, errors), (0, []), out)

    def test_coordinates_beyond_single_precision(self):
        """A bar stretched through another: 108 pairs in double; float must find them too or refuse (exit 2)."""
        points, tets = bar(2, (0, 0, 0))
        long = gmsh(self.work / "long.msh", [(x * 1e39, y, z) for x, y, z in points], tets)
        other = gmsh(self.work / "other.msh", *bar(3, (0.5, 0.25, 0.375)))
        counts = []
        for precision in ("double", "float"):
            out = self.work / f"{precision}.jsonl"
            status = tandem("run", "--mesh", long, "--mesh", other, "--device", "host", "--algorithm", "chunked", "--repeat", 1,
                            "--set", "k=6", "--set", f"precision={precision}", "--out", out)[0]
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
        status, text, errors = tandem("run", "--mesh", self.good, "--mesh", self.good, "--algorithm", "gproximity", "--device",
                                      "host", "--repeat", 1, "--set", "queue_bytes=1099511627776,67108864", "--dump-pairs",
                                      self.work / "failed.csv")
        self.assertEqual((status, len(errors), text.count(": right: ")), (3, 1, 1))

    def test_a_failure_is_one_line_without_an_empty_one(self):
        done = subprocess.run([str(PROGRAM), "run", "--mesh", self.good, "--algorithm", "gproximity", "--device", "host", "--set",
                               "queue_bytes=1099511627776"], capture_output=True, text=True, timeout=60)
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
        self.assertEqual(self.cell("--profile", "-1", timeout=3)[0], 2)

    def test_poses_without_meshes_are_refused(self):
        pose = ("--pose", "1 0 0 1 0 0 0")
        self.assertEqual(tandem("run", "pile:bodies=2,frames=1", "--device", "host", "--repeat", 1, *pose)[0], 2)

    def test_unknown_devices_beside_all_are_refused(self):
        self.assertEqual(tandem("run", "pile:bodies=2,frames=1", "--repeat", 1, "--device", "all,nosuch")[0], 2)

    def test_a_folder_is_no_scene_description(self):
        folder = self.work / "folder.json"
        folder.mkdir()
        self.bad("folder.json", "run", folder)

    def test_errors_locate_the_field_of_a_scene_description(self):
        path = self.work / "place.json"
        path.write_text('{"meshes": {"j": {"builtin": "jack"}}}')
        self.assertNotIn(": :", tandem("run", path)[2][0])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
