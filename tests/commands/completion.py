# SPDX-License-Identifier: MIT
# test: cost=2
"""Completions of command lines, in a real bash, and in zsh if installed."""

import json
import os
import shutil
import subprocess
import time
import unittest

from tests.program import PROGRAM, SOURCE, Case, ran, tandem

BASH = SOURCE / "scripts/completion/tandem.bash"
ZSH = SOURCE / "scripts/completion/_tandem"
COMMANDS = (
    "accuracy algorithms check compare completion convert devices export help paper profile report run scenes simulate "
    "view".split()
)


def asked(*words):
    """The program's completions of the last word."""
    status, out, errors = tandem("completion", "--words", *words)
    assert (status, errors) == (0, []), (words, out, errors)
    return out.split()


class Completion(Case):
    def bash(self, line, breaks=" \t\n\"'><=;|&(:"):
        """What bash would insert at the end of the line: COMPREPLY, which replaces the text after the last word
        break."""
        script = (
            f'COMP_WORDBREAKS=$1; source {BASH}; COMP_LINE=$2 COMP_POINT=${{#2}}; shift 2; COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)); '
            "_tandem; printf '%s\\n' \"${COMPREPLY[@]}\""
        )
        # Splits the line as readline does: breaks other than blanks are separate words.
        words, word = [], ""
        for letter in line:
            if letter in breaks:
                words += [w for w in (word,) if w]
                word = ""
                if letter != " ":
                    words.append(letter)
            else:
                word += letter
        if word or line[-1] == " ":
            words.append(word)
        words[0] = str(PROGRAM)
        line = str(PROGRAM) + line[len("tandem") :]
        done = ran(["bash", "--norc", "-c", script, "bash", breaks, line, *words])
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout.split()

    @property
    def scenes(self):
        return [
            s["name"] for s in json.loads(tandem("scenes", "--json")[1]) if not s["name"].startswith("hard")
        ]

    def test_bash(self):
        for line, offered in (
            ("tandem ", COMMANDS),
            ("tandem r", ["report", "run"]),
            ("tandem run --algo", ["--algorithm"]),
            ("tandem run pi", ["pile"]),
            ("tandem run --algorithm ti", ["tiled"]),
            ("tandem run --algorithm chunked,ti", ["chunked,tiled"]),
            ("tandem run --algorithm=ti", ["tiled"]),
            ("tandem run --device ho", ["host"]),
            ("tandem run --set slabs=", ["all", "three", "touched", "usual"]),
            ("tandem run --set slabs=th", ["three"]),
            ("tandem run --set=slabs=th", ["three"]),
            ("tandem run --set slabs=three,a", ["three,all"]),
            ("tandem run --set group_siz", ["group_size="]),
            ("tandem run pile:bod", ["bodies="]),
            ("tandem view pla", ["plates"]),
            ("tandem report x --scene pla", ["plates"]),
            ("tandem check hard:corner-c", ["corner-cancellation"]),
            ("tandem run pile:bodies=3,dens", ["3,density="]),
            ("tandem run --set slabs= --dry", ["--dry-run"]),
            ("tandem run --set slabs= ", self.scenes),
            ("tandem run --out ", []),
            ("tandem run --frames 3", []),
            ("tandem run --set builder=", ["balanced", "breadth", "hilbert", "median", "morton", "sah"]),
            ("tandem export --builder m", ["median", "morton"]),
            ("tandem export --chunk", ["--chunk-bytes", "--chunks"]),
            ("tandem export --chunks ", []),
            ("tandem algorithms t", ["tiled"]),
            ("tandem completion ", ["bash", "zsh"]),
            ("tandem nix ", []),
        ):
            with self.subTest(line):
                self.assertEqual(sorted(self.bash(line)), sorted(offered))
        whole = " \t\n"
        self.assertEqual(self.bash("tandem run --set slabs=th", whole), ["slabs=three"])
        self.assertEqual(self.bash("tandem run pile:bod", whole), ["pile:bodies="])
        # Without COMP_LINE, as other shells and tests call it.
        script = (
            f"source {BASH}; COMP_WORDS=({PROGRAM} run --algo) COMP_CWORD=2; _tandem; echo ${{COMPREPLY[@]}}"
        )
        self.assertEqual(
            subprocess.check_output(["bash", "--norc", "-c", script], text=True), "--algorithm\n"
        )

    def test_devices(self):
        ids = {d["id"] for entry in json.loads(tandem("devices", "--json")[1]) for d in entry["devices"]}
        self.assertEqual(set(asked("run", "--device", "")), {"all", *ids})
        self.assertEqual(
            set(asked("run", "--device", "host+")), {"host+all", *("host+" + i for i in ids - {"host"})}
        )
        for device in ids - {"host"}:
            backend, number = device.split(":")
            self.assertIn(number, self.bash(f"tandem run --device {backend}:"))
        self.assertLessEqual(ids | {"opencl", "cuda"}, set(asked("run", "--require", "")))

    def test_the_tables_equal_the_program(self):
        algorithms = json.loads(tandem("algorithms", "--json")[1])
        self.assertEqual(set(asked("algorithms", "")), {a["name"] for a in algorithms})
        self.assertEqual(
            set(asked("run", "--algorithm", "")), {"all", "auto", *(a["name"] for a in algorithms)}
        )
        self.assertNotIn("auto", asked("check", "--algorithm", ""))
        for one in algorithms:
            self.assertEqual(
                set(asked("run", "--algorithm", one["name"], "--set", "")),
                {p["name"] + "=" for p in one["parameters"]},
            )
            self.assertEqual(
                set(asked("run", f"--algorithm={one['name']}", "--preset", "")),
                {"all", *(p["name"] for p in one["presets"])},
            )
            for parameter in one["parameters"]:
                offered = set(asked("run", "--algorithm", one["name"], "--set", parameter["name"] + "="))
                self.assertEqual(
                    offered,
                    {
                        f"{parameter['name']}={v}"
                        for v in (*parameter.get("choices", ()), *parameter["alternatives"])
                    },
                )
        scenes = [s["name"] for s in json.loads(tandem("scenes", "--json")[1])]
        self.assertEqual(set(asked("run", "")), {s for s in scenes if not s.startswith("hard")})
        self.assertEqual(set(asked("check", "hard")), {s for s in scenes if s.startswith("hard")})
        self.assertEqual(asked("simulate", "--dynamics", "method="), ["method=gauss_seidel", "method=jacobi"])
        for command in COMMANDS:
            self.assertLessEqual(
                set(asked(command, "--")),
                set(tandem(command, "--help")[1].replace(",", " ").split())
                | {"--no-check", "--no-count", "--version"},
            )
        for option, values in (
            ("--truth", ["none", "pairs", "contacts"]),
            ("--degenerate", ["flat", "skip", "reject"]),
            ("--duplicates", ["merge", "keep", "reject"]),
        ):
            self.assertEqual(asked("run", option, ""), values)
        self.assertEqual(asked("compare", "--format", "m"), ["markdown"])
        self.assertEqual(asked("help", "contact_r"), ["contact_rule"])
        self.assertLessEqual({"run", "report", "tiled", "settings", "k"}, set(asked("help", "")))
        self.assertEqual(asked("run", "--format", ""), ["text", "markdown"])
        self.assertEqual(set(asked("run", "--columns", "")), {"pairs/s", "GB/s"})

    def test_completion_is_fast(self):
        times = []
        for _ in range(5):
            begin = time.monotonic()
            asked("run", "--set", "")
            times.append(time.monotonic() - begin)
        self.assertLess(min(times), 0.1)

    def test_scripts(self):
        for shell, path in (("bash", BASH), ("zsh", ZSH)):
            self.assertEqual(tandem("completion", shell), (0, path.read_text(), []))
        self.bad("fish", "completion", "fish")
        self.bad("shell is required", "completion")

    @unittest.skipUnless(shutil.which("zsh"), "no zsh")
    def test_zsh(self):
        subprocess.run(["zsh", "-n", ZSH], check=True)
        # compadd works only in a widget, so a function that prints its arguments replaces it.
        script = (
            f'compdef() {{ }}; _files() {{ print FILES }}; compadd() {{ print -l -- ${{@:#-*}} }}; source {ZSH}; words=("$@"); '
            "CURRENT=$#; PREFIX=$words[-1]; _tandem"
        )
        for words, offered in (
            (["run", "--algorithm", "ti"], ["tiled"]),
            (["run", "--set", "group_siz"], ["group_size="]),
            (["run", "--set", "slabs="], ["slabs=three", "slabs=all"]),
            (["run", "--out", ""], ["FILES"]),
            ([""], COMMANDS),
        ):
            done = ran(["zsh", "-f", "-c", script, "zsh", PROGRAM, *words], env={**os.environ, "LC_ALL": "C"})
            self.assertEqual((sorted(done.stdout.split()), done.stderr), (sorted(offered), ""))
