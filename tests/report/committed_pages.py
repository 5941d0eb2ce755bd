# SPDX-License-Identifier: MIT
# test: cost=2
"""Numbers, tables, pictures, commands and quotes of committed pages equal what they come from (scripts beside
them, scripts/tried, scripts/pictures). Also checks the committed microbenchmarks."""

import collections
import copy
import json
import re
import shutil
import subprocess
import textwrap

from tandem import errors, markdown
from tests.program import SOURCE
from tests.script_case import ScriptCase, emptied, loaded, script

answer, partitions = (loaded(f"../results/{name}.py") for name in ("h200/answer", "scaling/partitions"))

QUOTE = re.compile(r"(?s)<!-- quote: (\S+) -->\n```\w+\n(.*?)```")


def stands_in(quote, lines):
    """Whether the lines of a quote are consecutive lines of a file, ignoring their common indentation."""
    own = textwrap.dedent(quote).splitlines()
    return bool(own) and any(
        textwrap.dedent("\n".join(lines[i : i + len(own)])).splitlines() == own for i in range(len(lines))
    )


def wrong_quotes(page):
    """Errors in the blocks of a page that follow <!-- quote: FILE -->; every block of C++ must be such a
    quote."""
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


class Pages(ScriptCase):
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
        for name, own, pages in (
            ("answer", answer.Answer().tables, answer.PAGES),
            ("partitions", partitions.committed, [SOURCE / "results/scaling/README.md"]),
        ):
            texts = own()
            for page in pages:
                with emptied(page, name) as copied:
                    markdown.rewrite(copied, name, texts)
                    self.assertEqual(copied.read_text(), page.read_text(), page)
        copied = self.work / "page.md"
        copied.write_text("<!-- partitions: nothing -->\n<!-- end -->\n")
        with self.assertRaisesRegex(errors.BadUse, "no table 'nothing'; there are: partitioner, ghosts"):
            markdown.rewrite(copied, "partitions", texts)

    def test_tables_of_partitions(self):
        """Numbers by hand, of two benchmarks and of another one."""
        ghosts = {"ghosts_mean": 50, "ghosts_most": 90}
        others = {"setup_bytes_most": 5000.0, "frame_bytes_most": 2500.0, "neighbours_mean": 4}
        found = [
            {"name": "partition, parts/4/125/iterations:1", "real_time": 2000.0, "own_most": 110, **ghosts},
            {"name": "ghosts, ranks/8/27", "real_time": 9.0, **ghosts, **others},
            {"name": "refit/host/8", "real_time": 1},
        ]
        made = partitions.tables([{"run_type": "iteration", **one} for one in found])
        self.assertEqual(
            {name: text.splitlines()[2:] for name, text in made.items()},
            {
                "partitioner": ["| 4 | 125 | 2.00 | 4000.0 | 0.88 | 50 | 90 |"],
                "ghosts": ["| 8 | 27 | 50 | 90 | 4.0 | 5 | 2.5 |"],
            },
        )

    def test_the_list_of_trials_equals_its_lines(self):
        tried, copy = SOURCE / "results/tried.jsonl", self.work / "page.md"
        text = (SOURCE / "docs/developer/tried.md").read_text()
        copy.write_text(
            re.sub(r"<!-- tried -->.*?<!-- end -->", "<!-- tried --><!-- end -->", text, flags=re.DOTALL)
        )
        self.assertNotEqual(copy.read_text(), text)
        self.assertEqual(script("tried", tried, "--write", copy), (0, "", []))
        self.assertEqual(copy.read_text(), text)
        line = json.loads(tried.read_text().splitlines()[0])
        bad = self.work / "tried.jsonl"
        for lines, message in (
            ("", "has no lines"),
            ("{}\n", "tried.jsonl:1: no line of what was tried"),
            (json.dumps({**line, "count": "3"}), "tried.jsonl:1: no line"),
        ):
            bad.write_text(lines)
            status, _, errors = script("tried", bad)
            self.assertEqual((status, len(errors)), (1, 1), errors)
            self.assertIn(message, errors[0])
        bad.write_text(json.dumps({**line, "count": 1}) + "\n" + json.dumps({**line, "count": 2222}) + "\n")
        self.assertIn("2,222", script("tried", bad)[1])  # the newest of each
        self.assertEqual(len(script("tried", bad)[1].splitlines()), 3)
        parts = [{"what": "fails: b", "count": 3, "lost": 1}, {"what": "fails: c", "count": 40, "hangs": 2}]
        none = {"lost": 0, "crashes": 0, "hangs": 0, "others": 0}
        bad.write_text("".join(json.dumps({**line, **none, "unit": "runs", **part}) + "\n" for part in parts))
        self.assertEqual(
            script("tried", bad)[1].splitlines(),
            [
                "Lost, wrong, crashed or hung: 3.",
                "",
                f"- fails: b, c: 43 runs on {line['where']}, of which 3 are lost, wrong, crashed or hung",
            ],
        )

    def test_the_picture_of_the_pages_equals_the_records(self):
        """Compares words, which are comments beside their outlines; the outlines depend on the library."""
        words = lambda path: re.findall(r"<!-- (.*?) -->", path.read_text())
        drawn = self.work / "answer.svg"
        answer.Answer().draw(drawn)
        self.assertGreater(len(words(drawn)), 10)
        self.assertEqual(words(SOURCE / "results/h200/answer.svg"), words(drawn))

    def test_the_title_names_only_cells_that_are_told_apart(self):
        found = answer.Answer()
        scene = found.scenes[0]
        found.cells[scene, "18", "chunked"] = copied = copy.copy(found.cells[scene, "18", "tiled"])
        copied.total = {number: ms * (1.001 if number % 2 else 0.998) for number, ms in copied.total.items()}
        count = len(found.scenes)
        self.assertEqual(
            found.title(),
            f"Fastest with k = 18 in {count - 1} of {count} scenes: tiled; in 1: not told apart",
        )

    def test_numbers_of_the_readme_are_generated(self):
        """Measured numbers occur only between the marks of results/h200/answer.py and in output of the program."""
        text = re.sub(
            r"<!-- answer: [a-z ]+ -->.*?<!-- end -->|^    .*?$|^```text$.*?^```$",
            "",
            (SOURCE / "README.md").read_text(),
            flags=re.DOTALL | re.MULTILINE,
        )
        self.assertEqual(
            re.findall(r"\d[\d.,]* ?(?:%|ms|us|ns|s|GB|GiB|MB|times|minutes|seconds)(?![A-Za-z])", text), []
        )

    def test_quotes_equal_the_examples(self):
        """The user guide quotes every example program, and every quote is in its file."""
        quoted, folder = collections.Counter(), SOURCE / "scripts/examples"
        for page in sorted((SOURCE / "docs/user").glob("*.md")):
            text = page.read_text()
            self.assertEqual(wrong_quotes(text), [], page.name)
            quoted.update(name for name, _ in QUOTE.findall(text))
        examples = {str(p.relative_to(SOURCE)) for p in folder.iterdir() if p.suffix in (".cpp", ".py")}
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
        self.assertEqual(
            wrong_quotes(page(lines[0]).replace(name, "scripts/examples/absent.h")),
            ["scripts/examples/absent.h: no such file"],
        )
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
            self.assertTrue(
                {"name", "run_name", "family_index", "per_family_instance_index", "repetitions"} <= set(one),
                one,
            )
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
        if (
            compare
            and subprocess.run(
                ["/usr/bin/python3", "-c", "import numpy, scipy"], capture_output=True
            ).returncode
            == 0
        ):
            file = SOURCE / "results/cpu/bench.json"
            done = subprocess.run(
                ["/usr/bin/python3", compare, "--no-color", "benchmarks", file, file],
                capture_output=True,
                text=True,
            )
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout, r"OVERALL_GEOMEAN +\+0.0000")
