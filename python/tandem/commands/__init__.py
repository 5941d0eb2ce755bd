# SPDX-License-Identifier: MIT
"""Subcommands of the program that are written in Python: libexec/tandem/NAME runs `main` of the module NAME.
The program checks their options first and passes them as --name=value. Other programs of the package also use
the functions of this file."""

import argparse
import importlib.util
import os
import shutil
import sys

from ..errors import BadUse, OutputError
from ..text_lines import visible


class Parser(argparse.ArgumentParser):
    """Raises BadUse instead of printing its usage."""

    def error(self, message):
        raise BadUse(f"{message}; see --help")


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
    RecordError or OutputError."""
    from ..lines import RecordError

    try:
        text, code = make()
        _print(text)
        return code
    except (BadUse, RecordError) as problem:
        return print_error(problem, 2)
    except OutputError as problem:
        return print_error(problem, 3)
