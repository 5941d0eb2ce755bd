# SPDX-License-Identifier: MIT
# test: cost=15
"""Caches that cannot be written. With the program's own, commands say so in one
line, go on without it, and give the same answer. Without PoCL's, cells fail and name it."""

import os
import resource

from tests.program import PROGRAM, Case, messages, ran, tandem, words_of

NONE = {"TANDEM_KERNEL_CACHE": "", "XDG_CACHE_HOME": "", "HOME": ""}


class Caches(Case):
    def setUp(self):
        self.file = self.work / "file"
        self.file.write_text("kept")
        # Those of /sys are folders in which nobody can make a file.
        self.folders = {
            "/dev/null/below": "Not a directory",
            str(self.file): "Not a directory",
            "/sys/kernel": "Permission denied|Read-only file system|Operation not permitted",
        }
        self.run_words = (f"run {self.twice} --device host --algorithm tiled --quiet",)

    def right(self, *words, environment, status=0):
        """Runs a command that must succeed, and returns what it says on standard error."""
        words = words_of(words)
        code, out, errors = tandem(*words, environment={**NONE, **environment})
        self.assertEqual(code, status, (out, errors))
        if words[0] == "run" and "--dry-run" not in words:
            self.assertIn("right: ", out)
        return errors

    def test_a_folder_that_the_user_names(self):
        self.assertEqual(
            self.right(*self.run_words, environment={"TANDEM_KERNEL_CACHE": str(self.work / "new")}), []
        )
        for folder, why in self.folders.items():
            errors = self.right(*self.run_words, environment={"TANDEM_KERNEL_CACHE": folder})
            self.assertEqual(len(errors), 1, errors)
            self.assertRegex(
                errors[0],
                rf"^tandem: TANDEM_KERNEL_CACHE: {folder} cannot be written \(({why})\), so that nothing is stored in it; name another folder$",
            )
        self.assertEqual(self.file.read_text(), "kept")

    def test_the_usual_folder(self):
        for folder, why in self.folders.items():
            for variable, below in (("XDG_CACHE_HOME", "tandem"), ("HOME", ".cache/tandem")):
                errors = self.right(*self.run_words, environment={variable: folder})
                self.assertEqual(len(errors), 1, errors)
                self.assertRegex(
                    errors[0],
                    rf"^tandem: {folder}/{below} cannot be written \((.*)\), so that nothing is stored in it; name another folder in TANDEM_KERNEL_CACHE$",
                )
        self.assertEqual(self.right(*self.run_words, environment={}), [])  # no variable names a folder

    def test_a_full_disk(self):
        """No file can grow: the system refuses every byte, as on a full disk."""
        folder = self.work / "full"
        for words in (self.run_words, (*self.run_words, "--algorithm", "auto")):
            done = ran(
                [PROGRAM, *words_of(words), "--repeat", "1"],
                restore_signals=False,
                env={**os.environ, **NONE, "TANDEM_KERNEL_CACHE": str(folder)},
                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0)),
            )
            errors = [line for line in messages(done.stderr) if not line.startswith("auto: ")]
            self.assertEqual((done.returncode, len(errors)), (0, 1), (done.stdout, errors))
            self.assertRegex(
                errors[0], rf"^tandem: TANDEM_KERNEL_CACHE: {folder} cannot be written \(File too large\)"
            )
            self.assertIn("right: ", done.stdout)
        self.assertEqual(list(folder.iterdir()), [])

    def test_every_command_says_it_once(self):
        environment = {"TANDEM_KERNEL_CACHE": "/dev/null/below"}
        two = self.twice
        for words in (
            (*self.run_words, "--isolate"),
            (*self.run_words, "--set", "k=8,18"),
            ("profile", two, "--device", "host", "--quiet"),
            ("accuracy", two, "--device", "host", "--algorithm", "tiled", "--set", "k=8", "--quiet"),
            ("devices",),
            ("check", two, "--device", "host", "--algorithm", "tiled", "--set", "k=8", "--quiet"),
        ):
            with self.subTest(words[0]):
                errors = self.right(*words, environment=environment)
                self.assertEqual(
                    [line for line in errors if "/dev/null/below" in line and "cannot be written" in line],
                    errors[:1],
                    errors,
                )
                self.assertEqual(len(errors), 1, errors)

    def test_a_list_of_cells_makes_no_folder(self):
        folder = self.work / "listed"
        self.assertEqual(
            self.right(*self.run_words, "--dry-run", environment={"TANDEM_KERNEL_CACHE": str(folder)}), []
        )
        self.assertFalse(folder.exists())

    def test_a_folder_of_others_is_refused(self):
        folder = self.work / "others"
        folder.mkdir()
        folder.chmod(0o777)
        self.bad(
            f"TANDEM_KERNEL_CACHE: other users can write to {folder}",
            *self.run_words,
            environment={"TANDEM_KERNEL_CACHE": str(folder)},
        )

    def test_the_cache_of_pocl(self):
        """PoCL compiles nothing without it; it has no device if it cannot make the folder."""
        words = (f"run {self.twice} --device opencl:0 --algorithm tiled --quiet",)
        for folder in (str(self.file), "/sys/kernel"):
            self.bad(
                f"its kernel cache {folder} cannot be written (",
                *words,
                code=3,
                environment={"POCL_CACHE_DIR": folder},
            )
        self.bad(
            "its kernel cache /dev/null/below cannot be written (Not a directory); set POCL_CACHE_DIR",
            *words,
            environment={"POCL_CACHE_DIR": "/dev/null/below"},
        )
