# SPDX-License-Identifier: MIT
"""Subcommands of the program that are written in Python: libexec/tandem/NAME runs `main` of the module NAME. The program has checked
their options and handed them over as --name=value. What they share, other programs of the package use as well."""
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
    """Prints a line about input that is left out."""
    print(message, file=sys.stderr)


def complain(problem, code):
    """Prints the one line of a problem; returns the exit code."""
    print(f"tandem: {visible(str(problem))}", file=sys.stderr)
    return code


def check_packages(command, names, instead=""):
    """Goes on with the system's python3, or where this is it with that of PATH, where this one lacks a package; BadUse where that lacks one
    as well, or is none."""
    missing = [name for name in names if importlib.util.find_spec(name) is None]
    if not missing:
        return
    for other in (shutil.which("/usr/bin/python3"), shutil.which("python3")):
        if other and not os.path.samefile(other, sys.executable) and "TANDEM_PYTHON_TRIED" not in os.environ:
            os.environ["TANDEM_PYTHON_TRIED"] = "1"
            os.execv(other, [other, *sys.orig_argv[1:]])
    raise BadUse(f"{command} needs python3 with {', '.join(missing)}; install {' '.join(f'python3-{name}' for name in missing)}{instead}")


def _print(text):
    """Text on standard output, to its end. Names of files need not be UTF-8."""
    try:
        sys.stdout.buffer.write(text.encode(errors="surrogateescape"))
        sys.stdout.buffer.flush()
    except OSError as problem:
        # What is left of it would be written again when Python ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise OutputError(f"standard output could not be written ({problem.strerror})") from None


def run(make):
    """The exit code of a command. `make` returns its text and its exit code, and raises BadUse, RecordError or OutputError."""
    from ..lines import RecordError
    try:
        text, code = make()
        _print(text)
        return code
    except (BadUse, RecordError) as problem:
        return complain(problem, 2)
    except OutputError as problem:
        return complain(problem, 3)
