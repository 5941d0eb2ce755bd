# SPDX-License-Identifier: MIT
# test: cost=1 full=50
"""The commands of README.md as they stand there. The short form checks
that each can be read: options of the program by --dry-run, scripts by their syntax and described options,
Python by its compiler. The long form types them in a clean Debian 12 (debootstrap, as root, with a network),
where they must succeed."""

import os
import pathlib
import re
import shlex
import shutil
import subprocess

from tests.program import LONG, SOURCE, Case, ran, tandem

MIRROR = "http://deb.debian.org/debian"


def commands_of(text):
    """Lines of code blocks by indentation, without comments; the lines of one block are typed in one shell."""
    blocks, last = [], -2
    for number, line in enumerate(text.splitlines()):
        if line.startswith("    ") and line.strip():
            command = re.sub(r"\s{2,}#.*$", "", line.strip())
            if number == last + 1:
                blocks[-1].append(command)
            else:
                blocks.append([command])
            last = number
    return blocks


class Commands(Case):
    def setUp(self):
        self.blocks = commands_of((SOURCE / "README.md").read_text())
        self.commands = [command for block in self.blocks for command in block]

    def test_the_readme_has_the_first_commands(self):
        self.assertEqual(self.commands[0], "bash scripts/run")
        self.assertIn("bash scripts/test", self.commands)

    def test_shells_read_all(self):
        for command in self.commands:
            with self.subTest(command):
                done = ran(["bash", "-n", "-c", command])
                self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_scripts_have_these_options(self):
        for command in self.commands:
            words = shlex.split(command)
            scripts = [word for word in words if word.startswith("scripts/")]
            for script in scripts:
                with self.subTest(command):
                    text = (SOURCE / script).read_text()
                    self.assertEqual(
                        subprocess.run(
                            ["bash", "-n", SOURCE / script], capture_output=True, check=False
                        ).returncode,
                        0,
                    )
                    for option in words[words.index(script) + 1 :]:
                        self.assertIn(
                            option,
                            "".join(re.findall(r"^#.*\n", text, re.M)),
                            "the script's comment describes it",
                        )

    def test_the_program_knows_its_commands(self):
        for command in self.commands:
            words = shlex.split(command)
            if words[0] != "build/tandem":
                continue
            with self.subTest(command):
                if words[1] == "run":
                    self.output(*words[1:], "--dry-run")
                else:
                    self.assertEqual(tandem(words[1], "--help")[0], 0)

    def test_the_output_is_that_of_its_command(self):
        """But for numbers, spaces, and lines of rounds that other work disturbs and of doubts about times."""
        doubtful = re.compile("disturbed|outlier|wider than|drift")
        shown = re.search(r"(?ms)^```text\n\$ (.*?)\n(.*?)^```$", (SOURCE / "README.md").read_text())
        shape = lambda text: [
            re.sub(r"[ -]+", " ", re.sub(r"[0-9][0-9.]*", "N", line))
            for line in text.splitlines()
            if line.strip() and not re.match("scene |.* on host: ", line) and not doubtful.search(line)
        ]
        words = shlex.split(shown[1])
        self.assertEqual(words[0], "build/tandem")
        made = shape(self.output(*words[1:]))
        self.assertEqual(shape(shown[2]), made)

    def test_python_compiles(self):
        for command in self.commands:
            words = shlex.split(command)
            if "-c" in words and "python" in words[0]:
                with self.subTest(command):
                    compile(words[words.index("-c") + 1], command, "exec")

    def test_files_that_are_named_exist(self):
        """All but those that commands make: the program, pages and records."""
        named = {
            word
            for command in self.commands
            for word in shlex.split(command)
            if word.startswith(("scripts/", "docs/", "python/", "results/"))
        }
        self.assertLessEqual({"scripts/run"}, named)
        for name in named:
            self.assertTrue((SOURCE / name).exists(), name)


if LONG:

    class CleanDebian(Case):
        def test_all_commands_succeed(self):
            """Each block is typed in a shell of its own; the first installs and builds."""
            self.assertEqual(os.geteuid(), 0, "needs root, for debootstrap and chroot")
            self.assertTrue(shutil.which("debootstrap"), "needs debootstrap")
            root = pathlib.Path(os.environ.get("TANDEM_CLEAN_ROOT") or self.work / "debian")
            subprocess.run(
                [
                    "debootstrap",
                    "--variant=minbase",
                    "--include=ca-certificates,git",
                    "bookworm",
                    root,
                    MIRROR,
                ],
                check=True,
                stdout=subprocess.DEVNULL,
            )
            subprocess.run(["git", "clone", "-q", SOURCE, root / "tandem"], check=True)
            shutil.copy("/etc/resolv.conf", root / "etc/resolv.conf")
            for block in commands_of((SOURCE / "README.md").read_text()):
                with self.subTest(block[0]):
                    script = "\n".join(["set -e", "cd /tandem", *block])
                    inside = [
                        "chroot",
                        str(root),
                        "env",
                        "-i",
                        "HOME=/root",
                        "PATH=/usr/sbin:/usr/bin:/sbin:/bin",
                        "LANG=C.UTF-8",
                        "bash",
                        "-c",
                        script,
                    ]
                    # PoCL finds no memory, and ends the program, without /sys.
                    mounts = " && ".join(
                        f"mount --rbind /{name} {shlex.quote(str(root))}/{name}"
                        for name in ("proc", "dev", "sys")
                    )
                    done = ran(["unshare", "-m", "bash", "-c", f"{mounts} && exec {shlex.join(inside)}"])
                    self.assertEqual(done.returncode, 0, f"{done.stdout}\n{done.stderr}")
                    print(done.stdout[-1500:])
