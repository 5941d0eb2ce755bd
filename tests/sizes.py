#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# test: cost=7
"""Functions have at most 45 lines, in kernels and Python 60, a complexity of at most
20 and 6 parameters; files have at most 400 lines.

All lines of a function count, from its name to its end, with comments, blank lines and inner functions.
lizard counts them; it counts the lines of a lambda for the function around it."""

import collections
import filecmp
import pathlib
import re
import subprocess
import sys
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[1]

REQUIREMENTS = SOURCE / "tests/requirements.txt"
FETCHED = SOURCE / ".cache/tests"
if not (FETCHED / REQUIREMENTS.name).exists() or not filecmp.cmp(
    REQUIREMENTS, FETCHED / REQUIREMENTS.name, shallow=False
):
    sys.exit(
        "sizes.py: .cache/tests has no lizard as tests/requirements.txt names it; scripts/setup fetches it, with a network"
    )
sys.dont_write_bytecode = True
sys.path.insert(0, str(FETCHED))
import lizard

PARAMETERS, COMPLEXITY, FILE_LINES = 6, 20, 400
# Most lines of a function. Kernels declare many variables, and the formatter of Python gives each element of a
# long list a line of its own.
LINES = {"cpp": 45, "h": 45, "cl": 60, "clh": 60, "py": 60, "script": 60}
EXCLUDED = ("results/", "tests/fuzz/corpus/")
# Names under which lizard gets the text of a kind of file; it does not know kernels by their endings.
AS = {"cpp": "text.cpp", "h": "text.h", "cl": "text.c", "clh": "text.c", "py": "text.py", "script": "text.py"}
# Least numbers of files and of functions in a whole tree: fewer mean that some are not seen.
LEAST = {
    "cpp": (400, 3500),
    "h": (270, 550),
    "cl": (14, 90),
    "clh": (32, 180),
    "py": (100, 1200),
    "script": (8, 90),
    "shell": (20, 0),
}
# Kernels have a parameter for each argument of a launch.
KERNEL = re.compile(r"^(?:KERNEL|__kernel)\s+void\s+(\w+)\(", re.M)
KERNEL_FUNCTION = re.compile(r"^(?:KERNEL|__kernel|DEVICE)\b[^;{}(]*?(\w+)\(", re.M)
# Stubs and shims have the parameters of the interfaces that they stand for: folder, and how names of the
# interface begin.
FOREIGN = {"tests/opencl/": "cl", "tests/cuda/": "cu"}


def kind_of(path, text):
    """Kind of a source file; None for other files. Files without an ending are scripts, in Python or for a
    shell."""
    name = path.rpartition("/")[2]
    if "." in name.lstrip("."):
        ending = name.rpartition(".")[2]
        return "shell" if ending == "sh" else ending if ending in AS else None
    if text.startswith("#!") and "python" in text.partition("\n")[0]:
        return "script"
    return "shell" if text.startswith("#!") or path.startswith("scripts/") else None


class Tree:
    """Numbers of files and functions by kind, exempt functions by rule, and errors, each with FILE:LINE."""

    def __init__(self):
        self.files, self.functions, self.exempt, self.errors = (
            collections.Counter(),
            collections.Counter(),
            collections.Counter(),
            [],
        )

    def add(self, path, text):
        kind = kind_of(path, text)
        if kind is None:
            return
        self.files[kind] += 1
        count = len(text.splitlines())
        if count > FILE_LINES:
            self.errors.append(f"{path}:{count}: {count} lines, more than {FILE_LINES}")
        if kind == "shell":
            return
        functions = lizard.analyze_file.analyze_source_code(AS[kind], text).function_list
        self.functions[kind] += len(functions)
        if kind in ("cl", "clh"):
            unseen = set(KERNEL_FUNCTION.findall(text)) - {function.name for function in functions}
            self.errors += [f"{path}:1: function {name} is not seen" for name in sorted(unseen)]
        kernels = set(KERNEL.findall(text)) if kind == "cl" else set()
        for function in functions:
            self.check(path, kind, function, function.name in kernels)

    def check(self, path, kind, function, is_kernel):
        where = f"{path}:{function.start_line}: function {function.name}"
        if function.length > LINES[kind]:
            self.errors.append(f"{where} has {function.length} lines, more than {LINES[kind]}")
        if function.cyclomatic_complexity > COMPLEXITY:
            self.errors.append(
                f"{where} has complexity {function.cyclomatic_complexity}, more than {COMPLEXITY}"
            )
        if len(function.parameters) <= PARAMETERS:
            return
        if is_kernel:
            self.exempt["kernel"] += 1
            return
        foreign = next(
            (
                folder
                for folder, begin in FOREIGN.items()
                if path.startswith(folder) and function.name.startswith(begin)
            ),
            None,
        )
        if foreign:
            self.exempt[foreign] += 1
        elif kind in ("py", "script") and positional(function) <= PARAMETERS:
            self.exempt["keyword-only"] += 1
        else:
            self.errors.append(f"{where} has {len(function.parameters)} parameters, more than {PARAMETERS}")

    def lacking(self):
        """Kinds of which too few files or functions were seen."""
        return [
            f"{self.files[kind]} files and {self.functions[kind]} functions of kind {kind}, fewer than {least}"
            for kind, least in LEAST.items()
            if (self.files[kind] < least[0] or self.functions[kind] < least[1])
        ]


def positional(function):
    """Number of parameters of a Python function that a call may give by position."""
    texts = [text.strip() for text in function.full_parameters]
    before = next((i for i, text in enumerate(texts) if text.startswith("*")), len(texts))
    return before - texts[:before].count("/")


def sources():
    """Paths of the tree that git tracks, or would if they were added."""
    done = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=SOURCE,
        capture_output=True,
        text=True,
    )
    if done.returncode != 0:
        sys.exit(f"sizes.py: git ls-files: {done.stderr.strip()}")
    return sorted(
        path
        for path in set(done.stdout.split("\0"))
        if path and not path.startswith(EXCLUDED) and (SOURCE / path).is_file()
    )


class Sizes(unittest.TestCase):
    maxDiff = None

    def test_the_tree_is_within_the_limits(self):
        tree = Tree()
        for path in sources():
            tree.add(path, (SOURCE / path).read_text(encoding="utf-8", errors="replace"))
        print(f"files {dict(tree.files)}, functions {dict(tree.functions)}, exempt {dict(tree.exempt)}")
        self.assertEqual(tree.errors + tree.lacking(), [])
        self.assertEqual(set(+tree.exempt), {"kernel", "keyword-only", *FOREIGN}, "every exemption is needed")


class Mistakes(unittest.TestCase):
    """Texts at each limit and one beyond it."""

    def errors(self, path, text):
        tree = Tree()
        tree.add(path, text)
        return tree.errors

    def test_lines_of_functions(self):
        long = lambda head, line, end, count: head + line * (count - 2) + end
        for path, head, line, end in (
            ("base/a.cpp", "int f() {\n", "    // why\n", "}\n"),
            ("base/a.h", "inline int f() {\n", "\n", "}\n"),
            ("algorithms/a.clh", "DEVICE uint f(void) {\n", "    g();\n", "}\n"),
            ("algorithms/a.cl", "DEVICE uint f(void) {\n", "    g();\n", "}\n"),
            ("tests/a.py", "def f():\n", "    g()\n", "    g()\n"),
            ("scripts/a", "#!/usr/bin/env python3\ndef f():\n", "    g()\n", "    g()\n"),
        ):
            number = head.count("\n")
            most = 45 if path.startswith("base") else 60
            self.assertEqual(self.errors(path, long(head, line, end, most)), [], path)
            self.assertEqual(
                self.errors(path, long(head, line, end, most + 1)),
                [f"{path}:{number}: function f has {most + 1} lines, more than {most}"],
            )

    def test_complexity(self):
        for path, head, line, end in (
            ("base/a.cpp", "int f(int a) {\n", "    if (a) g();\n", "}\n"),
            ("algorithms/a.cl", "KERNEL void f(int a) {\n", "    if (a) g();\n", "}\n"),
            ("tests/a.py", "def f(a):\n", "    if a: g()\n", "    g()\n"),
        ):
            self.assertEqual(self.errors(path, head + line * (COMPLEXITY - 1) + end), [], path)
            self.assertEqual(
                self.errors(path, head + line * COMPLEXITY + end),
                [f"{path}:1: function f has complexity 21, more than 20"],
            )

    def test_parameters(self):
        words = lambda count: ", ".join(f"int p{i}" for i in range(count))
        names = lambda count: ", ".join(f"p{i}" for i in range(count))
        for path, begin, end, text in (
            ("base/a.cpp", "int f(", ") { return 1; }\n", words),
            ("base/a.h", "inline int f(", ") { return 1; }\n", words),
            ("algorithms/a.cl", "DEVICE int f(", ") { return 1; }\n", words),
            ("algorithms/a.clh", "DEVICE int f(", ") { return 1; }\n", words),
            ("tests/a.py", "def f(", "):\n    return 1\n", names),
        ):
            self.assertEqual(self.errors(path, begin + text(PARAMETERS) + end), [], path)
            self.assertEqual(
                self.errors(path, begin + text(PARAMETERS + 1) + end),
                [f"{path}:1: function f has 7 parameters, more than 6"],
            )

    def test_lines_of_files(self):
        for path in (
            "base/a.cpp",
            "base/a.h",
            "algorithms/a.cl",
            "algorithms/a.clh",
            "tests/a.py",
            "tests/a.sh",
            "scripts/gpu/steps/a",
        ):
            self.assertEqual(self.errors(path, "\n" * FILE_LINES), [])
            self.assertEqual(
                self.errors(path, "\n" * (FILE_LINES + 1)), [f"{path}:401: 401 lines, more than 400"]
            )
        self.assertEqual(self.errors("docs/a.md", "\n" * 1000), [])

    def test_kernels_may_have_more_parameters_and_other_functions_beside_them_may_not(self):
        parameters = ", ".join(f"uint p{i}" for i in range(PARAMETERS + 1))
        body = ") {\n    g();\n}\n"
        self.assertEqual(self.errors("algorithms/a.cl", f"KERNEL void f({parameters}{body}"), [])
        self.assertEqual(self.errors("algorithms/a.cl", f"__kernel void f({parameters}{body}"), [])
        both = f"KERNEL void f({parameters}{body}DEVICE void h({parameters}{body}"
        self.assertEqual(len(self.errors("algorithms/a.cl", both)), 1)
        self.assertEqual(len(self.errors("algorithms/a.clh", f"KERNEL void f({parameters}{body}")), 1)

    def test_functions_of_kernels_that_are_not_seen_are_errors(self):
        """lizard loses a function whose parentheses differ between branches of the preprocessor."""
        text = "DEVICE uint f(void) {\n#if A\n    if (b) {\n#else\n    {\n#endif\n    }\n}\n"
        self.assertEqual(self.errors("algorithms/a.cl", text), ["algorithms/a.cl:1: function f is not seen"])
        self.assertEqual(self.errors("algorithms/a.clh", text.replace("    if (b) {", "    if (b)")), [])

    def test_foreign_parameters(self):
        text = "int clFlush(" + ", ".join(f"int p{i}" for i in range(PARAMETERS + 1)) + ") { return 1; }\n"
        self.assertEqual(self.errors("tests/opencl/shim.cpp", text), [])
        self.assertEqual(len(self.errors("tests/opencl/shim.cpp", text.replace("clFlush", "flush"))), 1)
        self.assertEqual(len(self.errors("tests/unit/shim.cpp", text)), 1)

    def test_keyword_only_parameters(self):
        self.assertEqual(
            self.errors(
                "tests/a.py", "def f(self, a, /, b, c=(1, 2), d=3, e=4, *, g=5, h, **more):\n    return 1\n"
            ),
            [],
        )
        self.assertEqual(
            len(
                self.errors(
                    "tests/a.py", "def f(self, a, /, b, c=(1, 2), d=3, e=4, g=5, *, h):\n    return 1\n"
                )
            ),
            1,
        )

    def test_a_tree_in_which_little_is_seen_fails(self):
        self.assertEqual(len(Tree().lacking()), len(LEAST))


if __name__ == "__main__":
    unittest.main(argv=["sizes.py"], verbosity=2)
