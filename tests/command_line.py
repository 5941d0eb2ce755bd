#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""command_line.py PROGRAM SOURCE: the command line of the program: listings, unknown words, contradictions,
bad use."""

import json
import re
import sys
import unittest

from program import SOURCE, Case, tandem


class CommandLine(Case):
    def test_listings(self):
        keys = {
            "devices": {"backend", "reason", "devices", "drivers"},
            "scenes": {"name", "models", "parameters", "bodies", "vertices", "tetrahedra"},
            "algorithms": {"name", "baseline", "summary", "parameters", "presets"},
        }
        for name, words in (
            ("devices", ["host", "opencl:0"]),
            ("scenes", ["plates", "pile", "density", "glasses", "1729", "14793", "16140"]),
            ("algorithms", ["chunked", "gproximity", "tiled", "embree", "unc2010", "seed_threshold"]),
        ):
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

    def test_bad_use(self):
        self.bad("the nearest is 'chunked'", "run", "plates", "--algorithm", "chunkd")
        self.bad("the nearest is 'seed_threshold'", "run", "plates", "--set", "seed_treshold=1")
        self.bad("the nearest is 'opencl:0'", "run", "plates", "--device", "opencl:7")
        self.bad("the nearest is 'fair'", "run", "plates", "--preset", "fairr")
        self.bad("unknown scene 'galaxies' (there are: ", "run", "galaxies")  # nothing is within two edits
        self.bad("unknown option --zzzzzz; see 'tandem run --help'", "run", "plates", "--zzzzzz")
        self.bad(
            "setting 'slabs' belongs to tiled, not to chunked; name another algorithm",
            "run",
            "plates",
            "--algorithm",
            "chunked",
            "--set",
            "slabs=all",
        )
        self.bad(
            "preset 'fair' belongs to gproximity, not to tiled",
            "run",
            "plates",
            "--algorithm",
            "tiled",
            "--preset",
            "fair",
        )
        for file, expected in (
            ("a.jsonl", "a file of records, not a scene; 'tandem report' draws it"),
            ("b.msh", "b.msh is a mesh, not a scene; give it with --mesh b.msh"),
            ("c.stl", "c.stl is a surface, and tandem needs tetrahedra; make them with "),
        ):
            self.bad(expected, "run", file)
        renamed = "preset 'resident' of chunked is now called 'grouped'"
        for names in ("resident", "resident,fair"):  # without a preset of chunked by its own name
            self.bad(renamed, "run", "plates", "--preset", names, "--dry-run")
        self.bad(renamed, "run", "plates", "--algorithm", "chunked", "--preset", "resident", "--dry-run")
        self.assertEqual(
            tandem("run", "plates", "--device", "host", "--preset", "grouped,resident,fair", "--dry-run")[0],
            0,
        )
        self.bad("the nearest is 'opencl:0'", "check", "plates", "--device", "opencl:7")
        self.bad("the nearest is 'chunked'", "check", "plates", "--algorithm", "chunkd")
        for setting in (
            "k=10",
            "group_size=-1",
            "leaves=3",
            "precision=half",
            "pair_capacity=-1",
            "pair_capacity=4294967296",
            "k=6,,8",
            "axes=coordinate",
            "rounding=directed",
        ):
            expected = "goes with k=8 only" if setting == "axes=coordinate" else "impossible"
            self.bad(expected, "run", "plates", "--algorithm", "chunked", "--set", setting, "--frames", "0")
        self.bad(
            "goes with rounding=safe",
            "run",
            "plates",
            "--set",
            "placement=exact",
            "--set",
            "rounding=nearest",
        )
        for frames in ("5:2", "0:500", "500", "x", "1:", "-1:2", "0:99999999999999999999"):
            self.bad("frames", "run", "plates", "--frames", frames)
        for pose in (
            "0 0 0 1 0 0",
            "0 0 0 1 0 0 0 0",
            "0 0 0 0 0 0 0",
            "nan 0 0 1 0 0 0",
            "a b c d e f g",
            "",
        ):
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
            self.assertRegex(
                out,
                r"^tandem \d+\.\d+\.\d+, commit [0-9a-f]{7,}(, dirty)?, g\+\+ [\d.]+, with(out)? Embree[^\n]*\n$",
            )
        version = re.search(r"project\(tandem VERSION ([\d.]+)", (SOURCE / "CMakeLists.txt").read_text())[1]
        summary = next(
            e["summary"] for e in json.loads(tandem("algorithms", "--json")[1]) if e["name"] == "embree"
        )
        self.assertIn(f"tandem {version}, ", out)
        self.assertEqual("without Embree" in out, "built without Embree" in summary)
        record = self.work / "version.jsonl"
        tandem("run", "--mesh", self.good, "--device", "host", "--algorithm", "chunked", "--out", record)
        environment = self.records(record)[0]["environment"]
        self.assertIn(
            f", commit {environment['commit']}{', dirty' if environment['dirty'] else ''}, {environment['compiler']}, ",
            out,
        )

    def test_citation(self):
        """The program prints CITATION.bib, which agrees with CITATION.cff and with the project's version."""
        status, out, errors = tandem("--cite")
        self.assertEqual((status, errors), (0, []))
        first, entries = out.split("\n", 1)
        self.assertEqual(first, f"% {tandem('--version')[1].strip()}")
        self.assertEqual(entries, (SOURCE / "CITATION.bib").read_text())
        cff = (SOURCE / "CITATION.cff").read_text()
        fields = dict(zip(("version", "date-released"), ("version", "date"))) | {
            "start": "pages",
            "end": "pages",
        }
        fields |= {name: name for name in ("title", "journal", "volume", "year", "doi")} | {"issue": "number"}
        values = re.findall(r"^ *([a-z-]+): \"?([^\n\"]+)\"?$", cff, re.M)
        compared = [(fields[name], value) for name, value in values if name in fields]
        self.assertEqual(len(compared), 3 + 2 * 8)
        for name, value in compared:
            self.assertRegex(entries, rf"{name} += {{[^}}]*{re.escape(value)}")
        self.assertIn(
            re.search(r"project\(tandem VERSION ([\d.]+)", (SOURCE / "CMakeLists.txt").read_text())[1],
            [value for _, value in compared],
        )

    def test_unknown_words(self):
        """Unknown words of any form and position: the error names the nearest known word and the help."""
        for arguments, named in (
            (("run", "plates", "--algoritm"), "--algorithm"),
            (("run", "plates", "--algoritm", "tiled"), "--algorithm"),
            (("run", "--algoritm=tiled", "plates"), "--algorithm"),
            (("check", "plates", "--algoritm", "tiled"), "--algorithm"),
            (("run", "plates", "--algo"), "--algorithm"),
            (("run", "plates", "-devices", "host"), "--device"),
            (("compare", "a", "b", "--treshold=1"), "--threshold"),
            (("devices", "--jsn"), "--json"),
            (("run", "plates", "--algoritm", "--repeat", "x"), "--algorithm"),
        ):
            word = next(a for a in arguments if a.startswith("-")).split("=")[0]
            self.bad(
                f"tandem: unknown option {word}; did you mean {named}? see 'tandem {arguments[0]} --help'",
                *arguments,
            )
        self.bad(
            "tandem: unknown option --algoritm; did you mean --algorithm? see 'tandem --help'",
            "--algoritm",
            "scenes",
        )
        self.bad("option --device must come after a command", "--device", "host", "run", "plates")
        for word, named in (("rum", "run"), ("algorithm", "algorithms"), ("devises", "devices")):
            self.bad(
                f"tandem: unknown command '{word}'; the nearest is '{named}' (there are: run, ",
                word,
                "--device",
                "host",
            )
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
            (
                "--threads cannot be combined with --set threads",
                "--device",
                "host",
                "--threads",
                1,
                "--set",
                "k=6",
                "--set",
                "threads=2",
            ),
            ("--threads requires --device host", "--threads", 1),
            ("--threads requires --device host", "--threads", 1, "--device", "opencl:0,cuda:0"),
            *(
                (f"--profile cannot be combined with {word}", "--profile", 1, word, *value)
                for word, *value in (
                    ("--dry-run",),
                    ("--resume", "--out", "x"),
                    ("--repeat", 1),
                    ("--noise", "1%"),
                    ("--seconds", 1),
                    ("--seed", 1),
                )
            ),
            ("--profile cannot be combined with --truth contacts", "--profile", 1, "--truth", "contacts"),
            ("--dry-run cannot be combined with --dump-pairs", "--dry-run", "--dump-pairs", "x"),
            ("--dry-run cannot be combined with --dump-contacts", "--dry-run", "--dump-contacts", "x"),
            ("--pose requires --mesh", "--pose", "0 0 0 1 0 0 0"),
        ):
            self.bad(message, "run", "plates:count=2", "--frames", 0, *arguments)
        for command in ("check", "accuracy", "export"):
            self.bad("--pose requires --mesh", command, "--pose", "0 0 0 1 0 0 0")
        self.bad("--truth-contacts requires", "check", "plates", "--truth-contacts", 3)
        self.bad(
            "--threads cannot be combined with --set threads",
            "check",
            "plates",
            "--threads",
            1,
            "--set",
            "threads=2",
        )
        self.bad("--resume requires -o", "simulate", "arch", "--resume")
        self.bad("--checkpoint requires -o", "simulate", "arch", "--checkpoint", 3)
        self.bad("--steps", "simulate", "arch", "--steps", 0)
        self.bad("--every", "export", "plates", "--every", 0, "--glb", "x")
        self.bad("--contacts requires --vtu", "export", "plates", "--contacts", "--glb", "x")
        self.bad("--device requires --contacts", "export", "plates", "--device", "host", "--glb", "x")
        self.bad(
            "--device all: contacts need one device",
            "export",
            "plates",
            "--contacts",
            "--device",
            "all",
            "--vtu",
            self.work / "vtu",
        )
        for option in (("--device", "host"), ("--out", "x")):
            self.bad(f"{option[0]} requires --measure", "devices", *option)
        # Combinations that must be accepted: such options beside others, and where they have an effect.
        for arguments in (
            ("--truth", "contacts", "--truth-contacts", 3),
            ("--threads", 1, "--set", "k=6"),
            ("--seconds", 1, "--noise", "1%"),
            ("--algorithm", "chunked,auto", "--choose-afresh", "--choose-seconds", 1),
            ("--set", "threads=1,2"),
        ):
            status, out, errors = tandem(
                "run", "--mesh", self.good, "--mesh", self.good, "--device", "host", *arguments, "--dry-run"
            )
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
                text = " ".join(out.split(f"\n    {preset['name']}: ")[1].split("\n    ")[1:6]).replace(
                    "    ", " "
                )
                for name, value in preset["settings"].items():
                    self.assertEqual(
                        f"{name}={value}" in re.split(r"[\s,]+", text.split(": ")[0]),
                        value != initial[name],
                        (name, text),
                    )
            flat = " ".join(out.split())
            for parameter in entry["parameters"]:
                value = entry["presets"][0]["settings"][parameter["name"]]
                description = " ".join(f"{parameter['name']} = {value} {parameter['help']}".split())
                span = ["{}..{}".format(*parameter["range"])] if "range" in parameter else []
                values = ("range: " if span else "choices: ") + ", ".join(span + parameter.get("choices", []))
                self.assertIn(f"{description} {values}", flat)
            for counter in entry["counters"]:
                self.assertIn(
                    " ".join(f"{counter['name']} {counter['meaning']} [{counter['unit']}]".split()), flat
                )
            only = json.loads(tandem("algorithms", entry["name"], "--json")[1])
            self.assertEqual(only, [entry])
        self.assertIn(
            "device in grouped, paper; sphere_boxes in published", tandem("algorithms", "chunked")[1]
        )
        self.assertIn("device in resident; sphere where no preset sets it", tandem("algorithms", "tiled")[1])
        self.bad("the nearest is 'tiled'", "algorithms", "chunked", "tild")
        listing = tandem("algorithms")[1]
        self.assertEqual([line for line in listing.splitlines() if len(line) > 100], [])
        self.assertIn("settings, as in preset resident", listing)
        self.assertRegex(listing, r"\n    broad +device +how to find body pairs")
        self.assertIn(
            "[sphere, sphere_boxes, tight, device; sphere where no preset sets it]", " ".join(listing.split())
        )


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
