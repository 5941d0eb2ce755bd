# SPDX-License-Identifier: MIT
# test: cost=5
"""scripts/check_pages on small trees and on this one."""

import pathlib
import re
import subprocess
import tempfile
import unittest

from tests.program import PROGRAM, SOURCE

HELP = """#!/bin/sh
case "$*" in
--help) printf 'Cells:\\n  run  measure\\n  check  compare\\n\\nOptions:\\n  -h, --help  x\\n  --version  x\\n\\n    tandem run\\n' ;;
"run --help") printf '  -o,--out FILE Excludes: --json\\n  --set NAME\\n' ;;
"check --help" | "hidden --help") printf '  -o,--out FILE\\n' ;;
*) exit 2 ;;
esac
"""
RIGHT = """
    tandem --version: which
    mpirun -n 2 --bind-to x tandem run a && tandem check b --out c | sort --unique
    tandem run SCENE ... | PLAN   text --of it
    A=b tandem run --set 'a --none'  # --none
    tandem check a -- c -o d --set e=1

`scripts/tool --none`, `tandem COMMAND --help`, `tandem hidden`, `tandem.run()`, `--set`, `--full` and --none.
"""
WRONG = {
    "tandem runs": "tandem has no command runs",
    "tandem check --set a": "tandem check has no option --set",
    "mpirun -n 2 build/tandem run -x": "tandem run has no option -x",
    "tandem run a; tandem check --set b": "tandem check has no option --set",
    "tandem run \\\n    --none": "tandem run has no option --none",
    "tandem check a -- --none": "tandem run has no option --none",
    "--none": "nothing has an option --none",
}


class CheckedPages(unittest.TestCase):
    def setUp(self):
        self.root = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.write("help", HELP).chmod(0o755)

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        return path

    def found(self, program="help", root=None):
        command = [SOURCE / "scripts/check_pages", self.root / program, root or self.root]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode == 0, done.stderr), ("are right" in done.stdout, ""))
        return done.stdout.splitlines() if done.returncode else []

    def test_links(self):
        self.write("docs/other.md", "# A `b`: c, d_e!\n\n# Twice\n\n# [Twice](page.md)\n")
        self.write(
            "docs/page.md",
            "[a](other.md) [b](other.md#a-b-c-d_e) [c](#here) [d](other.md#twice-1) [e](https://a.b/c)\n"
            "`[f](none)` [![g](../help)](../docs)\n\n    [h](none)\n\n<!-- [i](none) -->\n## Here\n\n[j]: other.md\n",
        )
        self.assertEqual(self.found(), [])
        self.write("docs/other.md", "```\n# None\n```\n")
        self.write("docs/page.md", "[a](n.md)\n[b](other.md#n)\n\n| [c](../o.md#n) |\n\n[d]: n.md\n[e](#n)\n")
        places = [re.sub(r".*:(\d+): link to (.*):.*", r"\1:\2", line) for line in self.found()]
        self.assertEqual(places, "1:n.md 2:other.md#n 4:../o.md#n 6:n.md 7:#n".split())

    def test_commands_and_options(self):
        self.write("scripts/tool", "#!/bin/sh\n[ $1 = --full ]\n")
        self.write("page.md", RIGHT)
        self.assertEqual(self.found(), [])
        for words, message in WRONG.items():
            self.write("page.md", f"```sh\n{words}\n```\n")
            self.assertEqual(self.found(), [f"page.md:2: {message}"])
            self.write("page.md", f"a\n`{words}`\n" if "\\" not in words else f"\n    {words}\n")
            self.assertEqual(self.found(), [f"page.md:2: {message}"])

    def test_readmes_and_subjects(self):
        git = f"git -C '{self.root}' -c user.name=a -c user.email=a@b"
        for count, found in ((0, 0), (1, 2)):
            self.write("a/README.md", "\n" * (80 + count))
            subprocess.run(f"{git} init -q; {git} add .; {git} commit -qm {'x' * (72 + count)}", shell=True)
            self.assertEqual(len(self.found()), found)

    def test_this_tree(self):
        self.assertEqual(self.found(PROGRAM, SOURCE), [])
