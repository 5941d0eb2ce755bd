#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""prose.py PROGRAM SOURCE: scripts/check_prose on small trees that satisfy and violate each rule, and on this
tree for the rules that it satisfies; scripts/docs."""

import contextlib
import importlib.machinery
import importlib.util
import io
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

if len(sys.argv) != 3:
    sys.exit(__doc__)
PROGRAM = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()

# Rules that this tree satisfies; `scripts/check_prose --help` lists all.
CLEAN = [
    "mean",
    "long",
    "size",
    "link",
    "program",
    "of",
    "retired-page",
    "retired-comment",
    "retired-message",
    "retired-identifier",
    "allowed",
]

HELP = """#!/usr/bin/env python3
import sys
if sys.argv[1:] == ["--help"]:
    print("Options:\\n  -h,--help  Print this\\n  --version  x\\n\\nSubcommands:\\n  run  measure\\n  check  compare")
elif sys.argv[1:] in (["run", "--help"], ["check", "--help"], ["hidden", "--help"]):
    print("Options:\\n  -h,--help  x\\n  -o,--out FILE Excludes: --json\\n      wrapped text\\n" + ("  --set NAME" if "run" in sys.argv else ""))
else:
    sys.exit(2)
"""


def sentence(count):
    return " ".join(["word"] * count) + "."


def loaded(script):
    """Loads a script into this process."""
    sys.dont_write_bytecode = True
    loader = importlib.machinery.SourceFileLoader(script, str(SOURCE / "scripts" / script))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


CHECKER = loaded("check_prose")


def check(*arguments):
    """(exit code, lines of standard output, standard error) of check_prose."""
    with (
        contextlib.redirect_stdout(io.StringIO()) as out,
        contextlib.redirect_stderr(io.StringIO()) as errors,
    ):
        try:
            code = CHECKER.main([str(argument) for argument in arguments])
        except SystemExit as end:
            code = end.code
    return code, out.getvalue().splitlines(), errors.getvalue()


class Tree(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)

    def write(self, **files):
        """Files by their paths, with __ for / and _o_ for a dot."""
        for name, text in files.items():
            path = self.root / name.replace("__", "/").replace("_o_", ".")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)

    def found(self, rule, *arguments):
        """The findings of a rule, without the rule's name."""
        code, lines, errors = check("--root", self.root, "--only", rule, *arguments)
        self.assertEqual(code, 1 if len(lines) and "[" in lines[0] else 0, (lines, errors))
        if code == 0:
            self.assertRegex("\n".join(lines), r"\Acheck_prose: \d+ pages, \d+ sources, 0 findings\Z")
            return []
        for line in lines:
            self.assertRegex(line, rf"^[^:]+:\d+: .* \[{rule}")
        return [line.rsplit(" [", 1)[0] for line in lines]

    def page(self, rule, text, name="docs__page_o_md"):
        self.write(**{name: text})
        return self.found(rule)


class Pages(Tree):
    def test_mean(self):
        self.assertEqual(self.page("mean", f"# Page\n\n{sentence(25)} {sentence(15)}\n"), [])
        self.assertEqual(
            self.page("mean", f"{sentence(25)} {sentence(16)}\n"),
            ["docs/page.md:1: mean sentence of 20.5 words in 2 sentences (at most 20)"],
        )
        self.write(docs__page_o_md="", README_o_md=sentence(19))
        self.assertEqual(
            self.found("mean"), ["README.md:1: mean sentence of 19.0 words in 1 sentences (at most 18)"]
        )

    def test_long(self):
        self.assertEqual(self.page("long", sentence(35)), [])
        self.assertEqual(
            self.page("long", f"One.\n\n- Two.\n- three\n  {sentence(36)}\n")[0].split(" ...")[0],
            "docs/page.md:4: sentence of 37 words (at most 35): three word word word word word word word",
        )

    def test_where_sentences_end(self):
        for text in (
            "A. B.",
            "A? B!",
            "A\n\nB",
            "- A\n- B",
            "1. A\n2. B",
            "# A\nB",
            "(A.) B",
            "**A.** B",
            "A `x.y`. B",
            'A "x." B',
            "A [x](y.md). B",
            "> A\n\nB",
        ):
            joined = text.replace("A", sentence(30)[:-1]).replace("B", sentence(30)[:-1])
            self.assertEqual(self.page("long", joined), [], text)
        for text in (
            "A e.g. B",
            "A, i.e. B",
            "A 0.2 B",
            "A main.cpp B",
            "A et al. B",
            "A etc. and B",
            "A no. 3 B",
            "A\nB",
            "A ... B",
            "A: B",
            "- A\n  B",
            "> A\n> B",
        ):
            joined = text.replace("A", sentence(20)[:-1]).replace("B", sentence(20)[:-1])
            self.assertEqual(len(self.page("long", joined)), 1, text)

    def test_what_is_no_prose(self):
        many = sentence(40)
        for text in (
            f"```\n{many}\n```\n",
            f"~~~sh\n{many}\n```\n{many}\n~~~\n",
            f"\n    {many}\n\n    {many}\n",
            f"| a | b |\n|---|---|\n| {many} | c |\n",
            f"<!-- {many}\n\n{many} -->\n",
            f"`{many}`\n",
            f"# {many}\n",
            f"{many}\n===\n",
            f"---\nabout: {many}\n---\n",
            f"![{many}](a.png)\n",
            f"- a\n\n      {many}\n",
        ):
            self.assertEqual(self.page("long", text), [], text)
        for text in (f"- a\n\n    {many}\n", f"a\n    {many}\n", f"```\n```\n{many}\n"):
            self.assertEqual(len(self.page("long", text)), 1, text)

    def test_size(self):
        for name, lines, count in (
            ("docs__page_o_md", 150, 2500),
            ("README_o_md", 150, 1800),
            ("scenes__README_o_md", 80, 1000),
            ("results__h200__README_o_md", 150, 2500),
            ("scenes__page_o_md", 150, 2500),
        ):
            self.write(**{name: "\n" * (lines - 1) + "word " * count})
            self.assertEqual(self.found("size"), [], name)
            self.write(**{name: "\n" * lines + "word " * (count + 1)})
            path = name.replace("__", "/").replace("_o_", ".")
            self.assertEqual(
                self.found("size"),
                [
                    f"{path}:1: {lines + 1} lines (at most {lines})",
                    f"{path}:1: {count + 1} words (at most {count})",
                ],
            )
            self.write(**{name: ""})

    def test_links(self):
        self.write(
            docs__other_o_md='# A `b`: c, d_e!\n\n# Twice\n\n# Twice\n\n<a id="named"></a>\n',
            docs__figure_o_png="",
            top_o_md="",
        )
        good = (
            "[a](other.md) [b](other.md#a-b-c-d_e) [c](#here) [d](other.md#twice-1) [e](other.md#named) ![f](figure.png) [g](../top.md)"
            " [h](https://a.b/c) [i](mailto:a@b) [j](.) [![k](figure.png)](../docs) `[l](none)`\n\n    [m](none)\n\n# Here\n\n[n]: other.md\n"
        )
        self.assertEqual(self.page("link", good), [])
        bad = '[a](none.md)\n[b](other.md#none) [c](#none)\n\n| [d](../other.md) |\n\n[e]: none.md\n\n<img src="none.png">\n'
        self.assertEqual(
            self.page("link", bad),
            [
                f"docs/page.md:{line}: link to {target}: there is no such {what}"
                for line, target, what in (
                    (1, "none.md", "file"),
                    (2, "other.md#none", "heading"),
                    (2, "#none", "heading"),
                    (4, "../other.md", "file"),
                    (6, "none.md", "file"),
                    (8, "none.png", "file"),
                )
            ],
        )

    def test_of(self):
        self.assertEqual(self.page("of", "Often it is. One of two. `Of` is a word.\n\n    Of code\n"), [])
        self.assertEqual(
            self.page("of", "One. Of two.\n- Of three\n\n# Of four\n\n**Of five** it is.\n"),
            [
                "docs/page.md:1: a sentence begins with Of: Of two. ...",
                "docs/page.md:2: a sentence begins with Of: Of three ...",
                "docs/page.md:4: a sentence begins with Of: Of four ...",
                "docs/page.md:6: a sentence begins with Of: **Of five** it is. ...",
            ],
        )


class Sources(Tree):
    def test_of(self):
        self.write(
            a_o_cpp='// Something of a.\nint x; // often\n"// Of a string";\n',
            b_o_py='"""Of all."""\'s\'\n'[4:7] + "\n",
            scripts__c="#!/bin/sh\n# About\n",
        )
        self.assertEqual(self.found("of"), [])
        self.write(
            a_o_h="/// Of a.\nint a; ///< Of b\n// One. Of\n// two.\n",
            b_o_py='def f():\n    """Of a."""\n# Of b\n',
            c_o_cmake="set(a b) # Of c\n",
            scripts__d="#!/bin/sh\n  # Of d\n",
            e_o_cl="/* Of e */\n",
        )
        self.assertEqual(
            [one.split(": ")[0] for one in self.found("of")],
            ["a.h:1", "a.h:2", "a.h:3", "b.py:2", "b.py:3", "c.cmake:1", "e.cl:1", "scripts/d:2"],
        )

    def retired(self, line):
        self.write(scripts__prose__retired_o_txt=f"# a comment\n\n{line}\n")

    def test_names(self):
        self.retired(r"\bpassing folders?\b  identifier  temporary directory")
        self.write(
            a_o_cpp="// PassingFolder\nint passing; auto x = \"passing_folder\"; char c = '\"'; int n = 1'000; // passing_folder\n"
            '#include "passing_folder.h"\nauto r = R"x(passing_folder")x";\n',
            b_o_py="'passing_folder'\n# passing_folder\n",
            c_o_sh="passing_folder=1\n",
        )
        self.assertEqual(self.found("retired-identifier"), [])
        self.write(
            a_o_h="\nclass PassingFolder;\nint a_passing_folder_, PASSING_FOLDER;\nPassingFolder f;\n",
            b_o_py="x = f'''a'''\npassingFolder = 1\n",
            passing_folder_o_cl="",
        )
        self.assertEqual(
            self.found("retired"),
            [
                f"{place} write temporary directory"
                for place in (
                    "a.h:2: 'passing folder' in PassingFolder, 2 times:",
                    "a.h:3: 'passing folder' in a_passing_folder_:",
                    "a.h:3: 'passing folder' in PASSING_FOLDER:",
                    "b.py:2: 'passing folder' in passingFolder:",
                    "passing_folder.cl:1: 'passing folder' in the file's name:",
                )
            ],
        )
        self.retired("^Place$  identifier  Location")
        self.write(a_o_h="int place; class Place; class Places;\n", b_o_py="", passing_folder_o_cl="")
        self.assertEqual(self.found("retired"), ["a.h:1: 'Place' in Place: write Location"])

    def test_comments_messages_and_pages(self):
        self.retired(r"\bhalos?\b|becomes of  comment,message,page  ghosts")
        self.write(
            a_o_cpp="int halo; // shallow, what becomes\n\n// of it\n",
            b_o_py="halo = 1\n",
            tests__a_o_py="'halo'\n",
            docs__page_o_md="`halo`\n\n    halo\n\n[x](halo.md)\n",
        )
        self.assertEqual(self.found("retired"), [])
        self.write(
            a_o_cpp='/// What becomes\n/// of it.\nf("a halo");\n',
            b_o_py='def f():\n    """Halo."""\n    return """halo"""  # halos\n',
            docs__page_o_md="A [halo](x.md) becomes\nof it.\n\n# Halo\n\n| halo |\n",
        )
        self.assertEqual(
            [one.split(": write")[0] for one in self.found("retired-comment")],
            ["a.cpp:1: 'becomes of'", "b.py:2: 'Halo'", "b.py:3: 'halos'"],
        )
        self.assertEqual(
            [one.split(": write")[0] for one in self.found("retired-message")],
            ["a.cpp:3: 'halo'", "b.py:3: 'halo'"],
        )
        self.assertEqual(
            [one.split(": write")[0] for one in self.found("retired-page")],
            [
                "docs/page.md:1: 'halo'",
                "docs/page.md:1: 'becomes of'",
                "docs/page.md:4: 'Halo'",
                "docs/page.md:6: 'halo'",
            ],
        )

    def test_the_list(self):
        """The committed list matches its words, and accepts ordinary words in prose."""
        self.retired((SOURCE / "scripts/prose/retired.txt").read_text())
        self.write(
            a_o_cpp="// See here: others have a share of the room, a great deal, and deal with peer access.\nint placed, shared, AxisOrders, hereafter, meetings;\n"
        )
        self.assertEqual(self.found("retired"), [])
        names = "Deal dealt_ wants_a_deal Halo halo_bounds Share shares_ others_ KeptValues PassingFolder Companions strangers said_by see run_there peers".split()
        self.write(a_o_cpp="\n".join(names))
        self.assertEqual(
            [int(one.split(":")[1]) for one in self.found("retired")], list(range(1, len(names) + 1))
        )
        for line in ("[  comment  x", "a  nowhere  x", "a  comment"):
            self.retired(line)
            code, lines, errors = check("--root", self.root)
            self.assertEqual((code, lines), (2, []))
            self.assertIn("retired.txt:3: is no line", errors)


class Allowed(Tree):
    def test_allowed(self):
        self.write(
            docs__page_o_md="Of one.\n",
            scripts__prose__allowed_o_txt="# a comment\nof  docs/*.md  Of one  quoted from a book\n",
        )
        self.assertEqual(self.found("of"), [])
        self.assertEqual(self.found("of,allowed"), [])
        self.write(docs__page_o_md="One.\n")
        self.assertEqual(self.found("allowed"), [])
        code, lines, _ = check("--root", self.root)
        self.assertEqual(
            (code, lines), (1, ["scripts/prose/allowed.txt:2: allows nothing: delete it [allowed]"])
        )
        self.write(scripts__prose__allowed_o_txt="".join(f"of  {n}.md  x  a reason\n" for n in range(41)))
        self.assertEqual(self.found("allowed"), ["scripts/prose/allowed.txt:41: 41 entries (at most 40)"])
        self.write(scripts__prose__allowed_o_txt="of  docs/*.md  Of one\n")
        code, _, errors = check("--root", self.root)
        self.assertEqual(code, 2)
        self.assertIn("allowed.txt:1: is no line", errors)


class Program(Tree):
    def setUp(self):
        super().setUp()
        self.write(tandem=HELP)
        self.program = self.root / "tandem"
        os.chmod(self.program, 0o755)

    def found_in(self, text):
        self.write(docs__page_o_md=text)
        return [one.split(": ", 1)[1] for one in self.found("program", "--program", self.program)]

    def test_known(self):
        self.write(scripts__tool="#!/bin/sh\n[ $1 = --full ]\n")
        for line in (
            "tandem",
            "tandem --version: which",
            "tandem run x -o y --set a=-b,2",
            "build/tandem check --out=f",
            "mpirun -n 2 --bind-to x tandem run a",
            "tandem hidden",
            "tandem run a && tandem check b --out c | sort --unique",
            "tandem run SCENE ... | PLAN   text --of it",
            "tandem COMMAND --help",
            "tandem check a --out b -- c -o d --set e=1",
            "A=b tandem run  # --none",
            "tandem run --set 'a --none'",
            "tandem: error",
            "tandem.run()",
            "other --none",
            "T=/a/tandem other --none",
            "scripts/tool --none",
            "tandem run [--json | -o FILE]"[:11],
        ):
            self.assertEqual(self.found_in(f"\n    {line}\n\n`{line}`\n"), [], line)
        self.assertEqual(self.found_in("`--set` and `--full` and `-o`, and --none\n"), [])

    def test_unknown(self):
        for line, expected in (
            ("tandem runs", "tandem has no command runs"),
            ("tandem check --set a", "tandem check has no option --set"),
            ("tandem --out a", "tandem has no option --out"),
            ("build/tandem run -x", "tandem run has no option -x"),
            ("tandem run [--none]", "tandem run has no option --none"),
            ("mpirun -n 2 tandem runs", "tandem has no command runs"),
            ("tandem run a && tandem check --set b", "tandem check has no option --set"),
            ("tandem run a; tandem runs", "tandem has no command runs"),
            ("tandem run \\\n    --none", "tandem run has no option --none"),
            ("tandem check a -- --none", "tandem run has no option --none"),
            ("tandem check --set a -- b", "tandem check has no option --set"),
        ):
            self.assertEqual(self.found_in(f"```sh\n{line}\n```\n"), [f"{expected}"], line)
            if "\n" not in line:
                self.assertEqual(self.found_in(f"a `{line}`\n"), [expected], line)
        self.assertEqual(self.found_in("`--none X`\n"), ["nothing has an option --none"])

    def test_without_it(self):
        self.write(docs__page_o_md="`tandem runs`\n")
        code, _, errors = check("--root", self.root)
        self.assertEqual(code, 0)
        self.assertIn("without --program commands and options of pages are not checked", errors)
        for program, expected in (
            ("", "needs --program"),
            (self.root / "none", "cannot tell its options"),
            ("/bin/echo", "lists no subcommands"),
        ):
            code, _, errors = check(
                "--root", self.root, "--only", "program", *(["--program", program] if program else [])
            )
            self.assertEqual(code, 2)
            self.assertIn(expected, errors)


class Use(Tree):
    def test_bad_use(self):
        for arguments in (("--only", "none"), ("--root", self.root / "none"), ("--unheard-of",), ("word",)):
            code, lines, errors = check(*arguments)
            self.assertEqual((code, lines), (2, []))
            self.assertIn("check_prose: ", errors)

    def test_counts(self):
        self.write(a__b_o_h="// Of a.\n", docs__page_o_md="Of one. Of two.\n", c_o_md="Of three.\n")
        code, lines, _ = check("--root", self.root, "--counts")
        self.assertEqual(code, 1)
        self.assertEqual(
            [line.split() for line in lines if line.startswith(("rule", "of", "long"))],
            [["rule", ".", "a", "docs", "all"], ["long", "0", "0", "0", "0"], ["of", "1", "1", "2", "4"]],
        )

    def test_files_of_git(self):
        self.write(
            a_o_md="Of one.\n",
            build__b_o_md="Of two.\n",
            _o_cache__c_o_md="Of three.\n",
            _o_github__d_o_md="Of four.\n",
        )
        self.assertEqual([one.split(":")[0] for one in self.found("of")], [".github/d.md", "a.md"])
        subprocess.run(["git", "init", "-q", self.root], check=True)
        subprocess.run(["git", "-C", self.root, "add", "a.md"], check=True)
        self.assertEqual([one.split(":")[0] for one in self.found("of")], ["a.md"])


class Docs(unittest.TestCase):
    """scripts/docs, without doxygen, which only the reference itself needs."""

    def run_docs(self, *arguments, **environment):
        done = subprocess.run(
            [sys.executable, "-B", SOURCE / "scripts/docs", *map(str, arguments)],
            capture_output=True,
            text=True,
            check=False,
            env={**os.environ, **environment},
        )
        return done.returncode, done.stdout, done.stderr

    def test_doxygen_is_missing(self):
        self.assertEqual(
            self.run_docs(PATH="/nonexistent"), (2, "", "doxygen is missing: apt install doxygen\n")
        )

    def test_links_that_the_reference_can_follow(self):
        code, text, errors = self.run_docs("--filter", SOURCE / "docs/README.md")
        self.assertEqual((code, errors), (0, ""))
        self.assertIn("[Quick start](user/quick_start.md)", text)
        self.assertNotIn("](../", text)
        page = SOURCE / "docs/user/page.md"
        self.assertEqual(
            loaded("docs").filtered(
                page, "[a](../glossary.md#b) [c](../../README.md) [d](https://e.f) [g](#h) `i`"
            ),
            "[a](../glossary.md) c [d](https://e.f) g `i`",
        )

    def test_public_headers(self):
        docs = loaded("docs")
        self.assertGreater(len(docs.public_headers()), 20)
        self.assertIn("backends/mpi/mpi_ranks.h", docs.public_headers())
        self.assertEqual([path for path in docs.public_headers() if not (SOURCE / path).is_file()], [])


class ThisTree(unittest.TestCase):
    def test_rules_that_hold(self):
        self.assertTrue(CLEAN)
        code, lines, errors = check(
            "--root",
            SOURCE,
            "--only",
            ",".join(CLEAN),
            *(["--program", PROGRAM] if "program" in CLEAN else []),
        )
        self.assertEqual(code, 0, "\n".join([*lines, errors]))
        pages, sources = (int(lines[0].split()[i]) for i in (1, 3))
        self.assertGreater(pages, 30)
        self.assertGreater(sources, 900)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
