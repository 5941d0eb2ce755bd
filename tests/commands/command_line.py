# SPDX-License-Identifier: MIT
# test: cost=2
"""The command line of the program: listings, unknown words, contradictions,
bad use."""

import json
import re

from tests.program import SOURCE, Case, tandem


# For Case.all_bad.
BAD_USE = """
the nearest is 'chunked'                            | run plates --algorithm chunkd
the nearest is 'seed_threshold'                     | run plates --set seed_treshold=1
the nearest is 'opencl:0'                           | run plates --device opencl:7
the nearest is 'fair'                               | run plates --preset fairr
unknown scene 'galaxies' (there are:                | run galaxies
unknown option --zzzzzz; see 'tandem run --help'    | run plates --zzzzzz
setting 'slabs' belongs to tiled, not to chunked; name another algorithm | run plates --algorithm chunked --set slabs=all
preset 'fair' belongs to gproximity, not to tiled   | run plates --algorithm tiled --preset fair
a file of records, not a scene; 'tandem report' draws it | run a.jsonl
b.msh is a mesh, not a scene; give it with --mesh b.msh | run b.msh
c.stl is a surface, and tandem needs tetrahedra; make them with | run c.stl
preset 'resident' of chunked is now called 'grouped' | run plates --preset resident --dry-run
preset 'resident' of chunked is now called 'grouped' | run plates --preset resident,fair --dry-run
preset 'resident' of chunked is now called 'grouped' | run plates --algorithm chunked --preset resident --dry-run
the nearest is 'opencl:0'                           | check plates --device opencl:7
the nearest is 'chunked'                            | check plates --algorithm chunkd
goes with rounding=safe                             | run plates --set placement=exact --set rounding=nearest
--pose                                              | run --mesh {good} --pose '0 0 0 1 0 0 0' --pose '0 0 0 1 0 0 0'
exclude                                             | run plates --mesh {good}
--memory: give bytes such as 4096, 512MB or 1.5GiB; see 'tandem run --help' | run plates --memory -5
--memory: give bytes                                | run plates --memory 0
--memory: give bytes                                | run plates --memory 99999999999999999999
--memory: give bytes                                | run plates --memory 4XB
--memory: give bytes                                | run plates --memory 1e6
--seconds: give seconds from 0.001                  | run plates --seconds nan
--timeout: give seconds from 0.001                  | run plates --isolate --timeout nan
--choose-seconds: give seconds from 0.001           | run plates --algorithm auto --choose-seconds nan
scene                                               | run
--set                                               | run plates --set k
--help                                              | run plates --nonsense
--help                                              | fly
"""
BOTH = "\nThe setting of this name:\n"  # of a command and a setting with one name
UNKNOWN_WORDS = """
tandem: unknown option --algoritm; did you mean --algorithm? see 'tandem --help' | --algoritm scenes
option --device must come after a command           | --device host run plates
tandem: unknown command 'rum'; the nearest is 'run' (there are: run, | rum --device host
tandem: unknown command 'algorithm'; the nearest is 'algorithms' (there are: run, | algorithm --device host
tandem: unknown command 'devises'; the nearest is 'devices' (there are: run, | devises --device host
unknown command 'rum'                               | -- rum
unexpected argument 'b'; see 'tandem check --help'  | check a b
unexpected argument '--algoritm'                    | check a -- --algoritm
unknown scene '--algoritm'                          | run -- --algoritm
--set: 1 required                                   | run plates --set
"""
CONTRADICTIONS = """
--repeat cannot be combined with --seconds          | {run} --seconds 3 --repeat 3
--truth-contacts requires --truth contacts          | {run} --truth none --truth-contacts 3
--truth-contacts requires --truth contacts          | {run} --truth-contacts 3
--choose-seconds requires --algorithm auto          | {run} --choose-seconds 1
--choose-afresh requires --algorithm auto           | {run} --choose-afresh --algorithm chunked,tiled
--threads cannot be combined with --set threads     | {run} --device host --threads 1 --set k=6 --set threads=2
--threads requires --device host                    | {run} --threads 1
--threads requires --device host                    | {run} --threads 1 --device opencl:0,cuda:0
--profile cannot be combined with --truth contacts  | {run} --profile 1 --truth contacts
--dry-run cannot be combined with --dump-pairs      | {run} --dry-run --dump-pairs x
--dry-run cannot be combined with --dump-contacts   | {run} --dry-run --dump-contacts x
--dry-run cannot be combined with --dump-distances  | {run} --dry-run --dump-distances x
--dry-run cannot be combined with --dump-surfaces   | {run} --dry-run --dump-surfaces x
--keys requires --dry-run                           | {run} --keys
--pose requires --mesh                              | {run} --pose '{pose}'
--pose requires --mesh                              | check --pose '{pose}'
--pose requires --mesh                              | accuracy --pose '{pose}'
--pose requires --mesh                              | export --pose '{pose}'
--truth-contacts requires                           | check plates --truth-contacts 3
--threads cannot be combined with --set threads     | check plates --threads 1 --set threads=2
--resume requires -o                                | simulate arch --resume
--checkpoint requires -o                            | simulate arch --checkpoint 3
--steps                                             | simulate arch --steps 0
--every                                             | export plates --every 0 --glb x
--contacts requires --vtu                           | export plates --contacts --glb x
--device requires --contacts                        | export plates --device host --glb x
--device all: contacts need one device              | export plates --contacts --device all --vtu x
--device requires --measure                         | devices --device host
--out requires --measure                            | devices --out x
"""


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
            text = self.output(name)
            for word in words:
                self.assertIn(word, text)
            out = self.output(name, "--json")
            entries = json.loads(out)
            self.assertGreater(len(entries), 1)
            if name == "devices":
                devices = [device for entry in entries for device in entry["devices"]]
                (chosen,) = (device for device in devices if device["default"])
                gpus = [device for device in devices if device["kind"] == "gpu"]
                gpus.sort(key=lambda device: not device["id"].startswith("cuda"))
                self.assertEqual(chosen["id"], gpus[0]["id"] if gpus else "host")
                self.assertRegex(text, rf"(?m)^{chosen['id']} .*; the default device$")
            for entry in entries:
                self.assertLessEqual(keys[name], set(entry))
            self.assertTrue(all(word in out for word in words))

    def test_bad_use(self):
        self.all_bad(BAD_USE, good=self.good)
        cell = "run plates --device host --preset grouped,resident,fair --dry-run"
        self.assertEqual(tandem(cell)[0], 0)
        for (
            setting
        ) in "k=10 group_size=-1 leaves=3 precision=half k=6,,8 axes=coordinate rounding=directed".split():
            expected = "goes with k=8 only" if setting == "axes=coordinate" else "impossible"
            self.bad(expected, f"run plates --algorithm chunked --frames 0 --set {setting}")
        for capacity in (-1, 1 << 32):
            self.bad(
                "impossible", f"run plates --algorithm chunked --frames 0 --set pair_capacity={capacity}"
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
        for repeat in ("0", "-1", "x"):
            self.bad("--repeat", "run", "plates", "--repeat", repeat)
        self.bad("--help")

    def test_version(self):
        for arguments in (("--version",), ("run", "--version")):
            out = self.output(*arguments)
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
        out = self.output("--cite")
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
        self.all_bad(UNKNOWN_WORDS)
        for word in ("-", "--", "---", "--=", "-=", "-x", "=", ""):
            self.assertEqual(tandem(word, word)[0], 2, word)
            self.assertEqual(tandem("run", "--device", "host", word, word)[0], 2, word)

    def test_help(self):
        """Of every command: lines of the terminal's width, plain types, examples with known options."""
        program = tandem("help")[1]
        self.assertEqual(tandem("--help")[1], program)
        commands = re.findall(r"(?m)^  ([a-z]+) ", program)
        self.assertLessEqual({"run", "compare", "help"}, set(commands))
        for command in commands:
            text = self.output("help", command)
            self.assertEqual(tandem(command, "--help")[1], text.split(BOTH)[0])
            options = set(re.findall(r"(?m)^  (?:-\w, )?(--[\w-]+)", text))
            examples = re.findall(r"(?m)^    tandem (\w+)(.*)$", text)
            self.assertTrue(examples or command == "completion", command)
            for name, words in examples:
                self.assertEqual(name, command)
                self.assertLessEqual(set(re.findall(r"--[\w-]+", words)), options)
            for word in ("TEXT", "UINT", "INT", "FLOAT", "{false}", " in ["):
                self.assertNotIn(word, text)
            for columns in (60, 80, 120):
                lines = tandem(command, "--help", environment={"COLUMNS": str(columns)})[1].splitlines()
                self.assertLessEqual(max(map(len, lines)), columns)
        titles = re.findall(r"(?m)^([A-Z].*):$", tandem("help run")[1])
        self.assertEqual(
            titles,
            ["What to measure", "How long to measure", "Checks", "Output", "Machine", "Options", "Examples"],
        )
        self.assertEqual(max(map(len, tandem("help run")[1].splitlines())), 80)

    def test_help_with_settings(self):
        """Of each: what it does, its values, and those of every algorithm's presets."""
        algorithms = json.loads(tandem("algorithms", "--json")[1])
        listed = tandem("help settings")[1]
        parameters = {p["name"]: p for entry in algorithms for p in entry["parameters"]}
        self.assertEqual(re.findall(r"(?m)^  (\w+) +\S", listed), list(parameters))
        self.assertIn(BOTH, tandem("help convert")[1])
        for name, parameter in parameters.items():
            first, *lines = re.sub(r"\n {4,}", " ", self.output("help", name).split(BOTH)[-1]).splitlines()
            self.assertEqual(first, f"{name}: {parameter['help']}")
            span = ["{}..{}".format(*parameter["range"])] if "range" in parameter else []
            values = ", ".join(span + parameter.get("choices", []))
            self.assertEqual(lines[0], f"  {'range' if span else 'choices'}: {values}")
            for entry in algorithms:
                if name not in {p["name"] for p in entry["parameters"]}:
                    continue
                (texts,) = [line for line in lines if re.match(rf"  ([\w, ]+, )?{entry['name']}[,:]", line)]
                for preset in entry["presets"]:
                    value = re.escape(preset["settings"][name])
                    self.assertRegex(texts, rf"[:;] {value} in (all presets|[\w, -]*\b{preset['name']}\b)")
        self.assertEqual(tandem("help tiled")[1], tandem("algorithms tiled")[1])
        self.bad("unknown topic 'kk'; the nearest is 'k'", "help", "kk")
        self.bad("unknown topic 'nothing'; 'tandem help' lists commands", "help", "nothing")

    def test_contradictions(self):
        """Options that would have no effect are refused, and the error names the conflicting option."""
        words = ("--repeat cannot be combined with --noise", "N samples")
        self.bad(words, "run plates:count=2 --frames 0 --repeat 3 --noise 1%")
        self.all_bad(CONTRADICTIONS, run="run plates:count=2 --frames 0", pose="0 0 0 1 0 0 0")
        for option in (
            "--dry-run",
            "--resume --out x",
            "--repeat 1",
            "--noise 1%",
            "--seconds 1",
            "--seed 1",
        ):
            expected = f"--profile cannot be combined with {option.split()[0]}"
            self.bad(expected, f"run plates:count=2 --frames 0 --profile 1 {option}")
        # Combinations that must be accepted: such options beside others, and where they have an effect.
        for arguments in (
            ("--truth", "contacts", "--truth-contacts", 3),
            ("--threads", 1, "--set", "k=6"),
            ("--seconds", 1, "--noise", "1%"),
            ("--algorithm", "chunked,auto", "--choose-afresh", "--choose-seconds", 1),
            ("--set", "threads=1,2"),
        ):
            self.output("run", self.twice, "--device", "host", *arguments, "--dry-run")

    def test_descriptions_of_algorithms(self):
        algorithms = json.loads(tandem("algorithms", "--json")[1])
        for entry in algorithms:
            out = self.output("algorithms", entry["name"])
            self.assertEqual([line for line in out.splitlines() if len(line) > 100], [])
            initial = {p["name"]: p["default"] for p in entry["parameters"]}
            for preset in entry["presets"]:
                # The effective values: the preset's values replace the parameters' defaults.
                self.assertEqual(preset["settings"], {**initial, **preset["values"]})
                head = f'\n    {preset["name"]}, in tables "{preset["title"]}": '
                text = " ".join(out.split(head)[1].split("\n    ")[1:6]).replace("    ", " ")
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
