# SPDX-License-Identifier: MIT
"""Subcommands of the program that are written in Python: libexec/tandem/NAME runs `main` of the module NAME.
They declare their options, and the program passes all words on. Other programs of the package also use the
functions of this file."""

import argparse
import difflib
import importlib.util
import math
import os
import shutil
import sys

from ..errors import BadUse, OutputError
from ..text_lines import visible

EXAMPLES = "examples:"
LIST_OPTIONS = "--list-options"  # the only word when the program completes a command line


class Answered(Exception):
    """The words ask for a text, such as the help."""


class _Help(argparse.HelpFormatter):
    """Writes an option as "-o, --output FILE", and keeps the lines of examples."""

    def _fill_text(self, text, width, indent):
        if text.startswith(EXAMPLES):
            return text
        fill = super()._fill_text
        return "\n\n".join(fill(part, width, indent) for part in text.split("\n\n"))

    def _format_action_invocation(self, action):
        if not action.option_strings or action.nargs == 0:
            return super()._format_action_invocation(action)
        return f"{', '.join(action.option_strings)} {self._format_args(action, action.dest.upper())}"


class Parser(argparse.ArgumentParser):
    """The options of a command; its help ends with the examples. Raises BadUse instead of printing its usage."""

    def __init__(self, prog, description, *examples, **more):
        epilog = "\n    ".join([EXAMPLES, *examples]) if examples else None
        super().__init__(
            **{"formatter_class": _Help, "allow_abbrev": False} | more,
            prog=prog,
            description=description,
            epilog=epilog,
        )

    def error(self, message):
        end = " see" if message.endswith("?") else "; see"
        raise BadUse(f"{message.removeprefix('argument ')}{end} '{self.prog} --help'")

    def print_help(self, file=None):
        raise Answered(self.format_help())

    def read(self, words):
        """The values of options and arguments, in any order. Raises BadUse, and Answered for the help."""
        if list(words) == [LIST_OPTIONS]:
            raise Answered("".join(map(_declaration, self._actions)))
        options, rest = self.parse_known_intermixed_args(words)
        unknown = [word for word in rest if word.startswith("-") and word != "--"]
        if unknown:
            self.error(self._unknown(unknown[0].partition("=")[0]))
        if rest:
            self.error(f"unexpected argument '{rest[0]}'")
        return options

    def _unknown(self, name):
        names = [one for one in self._option_string_actions if one.startswith("--")]
        near = [one for one in names if one.startswith("--" + name.lstrip("-"))]
        near = near or difflib.get_close_matches(name, names, 1, 0.7)
        return f"unknown option {name}" + (f"; did you mean {near[0]}?" if near else "")


def _declaration(action):
    """A line for the program: the names of an option, and its choices or what its value is called."""
    names, value = ",".join(action.option_strings), action.metavar or action.dest.upper()
    return f"{names}{'' if action.nargs == 0 else f' {value}'}\n" if names else ""


def within(low, high, kind=float):
    """A type of options: a number from `low` to `high`."""

    def read(text):
        try:
            value = kind(text)
        except ValueError:
            value = math.nan
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"{text} is not in the range {low:g} to {high:g}")
        return value

    return read


def check_together(options, requires=(), excludes=()):
    """Raises BadUse for an option that is given without one that it requires, or with one that it excludes.
    requires, excludes: pairs of names."""
    is_given = lambda name: getattr(options, name.replace("-", "_")) not in (None, False, "", [])
    for name, other in requires:
        if is_given(name) and not is_given(other):
            raise BadUse(f"--{name} requires --{other}; see --help")
    for name, other in excludes:
        if is_given(name) and is_given(other):
            raise BadUse(f"--{name} cannot be combined with --{other}; see --help")


def warn(message):
    """Prints a warning on standard error."""
    print(visible(message), file=sys.stderr)


def print_error(problem, code):
    """Prints an error as one line. Returns the exit code."""
    print(f"tandem: {visible(str(problem))}", file=sys.stderr)
    return code


def check_packages(command, names, instead=""):
    """If this Python lacks a package, starts the command again with /usr/bin/python3, or with the python3 of
    PATH. Raises BadUse if that one lacks a package too, or there is no other Python."""
    missing = [name for name in names if importlib.util.find_spec(name) is None]
    if not missing:
        return
    for other in (shutil.which("/usr/bin/python3"), shutil.which("python3")):
        if other and not os.path.samefile(other, sys.executable) and "TANDEM_PYTHON_TRIED" not in os.environ:
            os.environ["TANDEM_PYTHON_TRIED"] = "1"
            os.execv(other, [other, *sys.orig_argv[1:]])
    raise BadUse(
        f"{command} needs python3 with {', '.join(missing)}; install {' '.join(f'python3-{name}' for name in missing)}{instead}"
    )


def _print(text):
    """Writes and flushes a text of lines on standard output, with control characters as escapes. Names of
    files in it need not be UTF-8."""
    try:
        sys.stdout.buffer.write(visible(text, "\n\t").encode(errors="surrogateescape"))
        sys.stdout.buffer.flush()
    except OSError as problem:
        # Otherwise Python writes the rest of the buffer again at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise OutputError(f"standard output could not be written ({problem.strerror})") from None


def run(make):
    """Runs a command and returns its exit code. `make` returns its text and exit code, or raises BadUse,
    RecordError, OutputError or Answered."""
    from ..lines import RecordError

    try:
        try:
            text, code = make()
        except Answered as answer:
            text, code = str(answer), 0
        _print(text)
        return code
    except (BadUse, RecordError) as problem:
        return print_error(problem, 2)
    except OutputError as problem:
        return print_error(problem, 3)
