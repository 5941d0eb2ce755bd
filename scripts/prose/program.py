# SPDX-License-Identifier: MIT
"""Commands and options in pages that the program does not have."""

import re
import subprocess

from prose.blocks import Finding
from prose.errors import BadUse
from prose.markdown import CODE

# The program's name, in front of it what launches it.
LEADING = re.compile(
    r"^\s*(?:\$\s+)?(?:(?:\w+=\S*|mpirun|mpiexec|srun|time|env|nice|taskset|parallel|-{1,2}\w\S*|\d+)\s+)*(?:[^\s=]*/)?tandem(?=\s|$)"
)
# What ends a command in a line: another one, a comment, what explains it behind three blanks, a redirection.
BEHIND = re.compile(r"\s\|\|?\s|\s?&&|;|\s#\s|\s{3,}|\s[<>]\s?")
# Between commands of a line.
NEXT = re.compile(r"\s&&\s|(?:\s\||;)\s(?=(?:[^\s=]*/)?tandem\s)")
OPTION = re.compile(r"(?<![\w./=-])(-{1,2}[A-Za-z][\w-]*)")
LONG = re.compile(r"(?<![\w-])--[a-z][\w-]*")
QUOTED = re.compile(r"\"[^\"]*\"|'[^']*'")
COMMAND = re.compile(r"[a-z][a-z-]*$")
DECLARED = re.compile(r"^\s+((?:-{1,2}[A-Za-z][\w-]*,?\s?)+)", re.MULTILINE)


class Program:
    """What a program's help declares: its own options, its commands and theirs. Raises BadUse where it cannot
    be started."""

    def __init__(self, path):
        self._path, self._known = path, {}
        text = self._help()
        listed = re.search(r"(?ims)^Subcommands:\n(.*)", text)
        self.commands = set(re.findall(r"^  ([a-z][\w-]*)", listed[1], re.MULTILINE)) if listed else set()
        if not self.commands:
            raise BadUse(f"{path}: its --help lists no subcommands")
        self._own = self._options(text)

    def has(self, command):
        """Whether there is this command; some are not listed."""
        if (
            command not in self.commands
            and subprocess.run([self._path, command, "--help"], capture_output=True, check=False).returncode
            == 0
        ):
            self.commands.add(command)
        return command in self.commands

    def _help(self, *command):
        try:
            done = subprocess.run(
                [self._path, *command, "--help"], capture_output=True, text=True, timeout=60, check=True
            )
        except (OSError, subprocess.SubprocessError) as problem:
            raise BadUse(f"{self._path}: cannot tell its options ({problem})") from None
        return done.stdout

    @staticmethod
    def _options(text):
        return {
            name for group in DECLARED.findall(text) for name in re.findall(r"-{1,2}[A-Za-z][\w-]*", group)
        }

    def options(self, command):
        """Options that may stand in a line of this command; of the program alone where it is None."""
        if command not in self._known:
            self._known[command] = self._own | (self._options(self._help(command)) if command else set())
        return self._known[command]

    def every_option(self):
        """Options of any command."""
        return set().union(*map(self.options, self.commands))


class Tools:
    """Options of other programs of a tree, by where they are written: scripts, Python modules, test programs,
    the build."""

    FOLDERS, SUFFIXES = ("scripts/", "python/", "cmake/", "tests/"), (".py", ".cpp", ".cmake", ".sh", ".txt")

    def __init__(self, root, paths):
        files = [
            path
            for path in paths
            if path.startswith(self.FOLDERS) and not path.startswith(("tests/fuzz/corpus/", "scripts/prose/"))
        ]
        files = [path for path in files if path.endswith(self.SUFFIXES) or "." not in path.rsplit("/", 1)[-1]]
        # The tests in Python quote options that the program refuses.
        files = [path for path in files if not (path.startswith("tests/") and path.endswith(".py"))]
        self.options = {
            name
            for path in files
            for name in LONG.findall((root / path).read_text(encoding="utf-8", errors="replace"))
        }


def _problem(program, line):
    """What is wrong with the words behind the program's name, or None. Names in capitals stand for any word."""
    words = QUOTED.sub("Q", BEHIND.split(line, maxsplit=1)[0]).split()
    command = words[0] if words and not words[0].startswith(("-", "[")) else None
    if command and not COMMAND.match(command):
        return None
    if command and not program.has(command):
        return f"tandem has no command {command}"
    own, behind = (words[: words.index("--")], words[words.index("--") :]) if "--" in words else (words, [])
    for name, part in (
        (command, own),
        ("run", behind),
    ):  # words behind -- are those of the run that the command starts
        unknown = [option for option in OPTION.findall(" ".join(part)) if option not in program.options(name)]
        if unknown:
            return f"{' '.join(filter(None, ('tandem', name)))} has no option {unknown[0]}"
    return None


def _code(page):
    """(line, text) of lines of code, those that a backslash ends with the next, and of inline code."""
    line, begun = 0, ""
    for block in page.blocks:
        if block.kind == "code":
            line, begun = (line, f"{begun} {block.text.strip()}") if begun else (block.line(0), block.text)
            if begun.endswith("\\"):
                begun = begun[:-1].rstrip()
                continue
            yield line, begun
        else:
            for match in CODE.finditer(block.text):
                yield block.line(match.start()), match[0].strip("`").strip()
        begun = ""


def check(program, tools, page):
    """Findings of code that begins with tandem, also behind a launcher, and of inline code that begins with
    an option."""
    for line, text in _code(page):
        for part in NEXT.split(text):
            begun = LEADING.match(part)
            if begun and (problem := _problem(program, part[begun.end() :])):
                yield Finding("program", page.path, line, problem)
        option = LONG.match(text)
        if option and option[0] not in program.every_option() | tools.options:
            yield Finding("program", page.path, line, f"nothing has an option {option[0]}")
