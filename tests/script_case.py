# SPDX-License-Identifier: MIT
"""Helpers shared by tests of Python's readers of records and of scripts: they run in this process where
possible."""

import contextlib
import importlib
import importlib.machinery
import importlib.util
import io
import json
import lzma
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile

from tests.program import SOURCE, Case

sys.dont_write_bytecode = True
sys.path.insert(0, str(SOURCE / "scripts"))
# other names are those of scripts
MODULES = {"tables": "tandem.tables", "figures": "tandem.error_figures"}


def loaded(name, scripts={}):
    """The module or script, loaded once: starting Python and loading its libraries takes longer than most
    tests."""
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
    if (
        not address_space
        and name != "render"
        and os.path.realpath(sys.executable) == os.path.realpath("/usr/bin/python3")
    ):
        return called(loaded(name), *arguments)
    limit = (
        (lambda: resource.setrlimit(resource.RLIMIT_AS, (address_space, address_space)))
        if address_space
        else None
    )
    what = ["-B", "-m", MODULES[name]] if name in MODULES else [SOURCE / "scripts" / name]
    done = subprocess.run(
        ["/usr/bin/python3", *what, *map(str, arguments)],
        capture_output=True,
        text=True,
        preexec_fn=limit,
        cwd=SOURCE,
        env={**os.environ, "PYTHONPATH": str(SOURCE / "python")},
    )
    return done.returncode, done.stdout, done.stderr.splitlines()


def committed(name):
    opened = lzma.open if name.endswith(".xz") else open
    with opened(SOURCE / "results" / name, "rt") as file:
        return [json.loads(line) for line in file]


@contextlib.contextmanager
def emptied(page, mark):
    """A copy of a page without what stands between its marks <!-- MARK: NAME --> and <!-- end -->."""
    text = page.read_text()
    rest = re.sub(rf"(<!-- {mark}: [a-z ]+ -->).*?<!-- end -->", r"\1 <!-- end -->", text, flags=re.DOTALL)
    assert rest != text, f"{page} has no {mark}"
    with tempfile.TemporaryDirectory() as folder:
        copy = pathlib.Path(folder, "page.md")
        copy.write_text(rest)
        yield copy


def rows_of(text):
    """Cells of every line of a Markdown table."""
    return [
        [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        for line in text.splitlines()
        if line.startswith("| ")
    ]


class ScriptCase(Case):
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
