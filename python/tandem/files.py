# SPDX-License-Identifier: MIT
"""Checks of outputs, figures without control characters, and atomic replacement of files."""

import errno
import fcntl
import io
import os
import stat
import tempfile

from .errors import BadUse, OutputError
from .text_lines import visible

_STARTS = (b'"schema":', b'"schema" :')


def _has_records(path):
    """Whether a file begins as a line of records does, or is compressed by xz, as older records are."""
    with open(path, "rb") as file:
        start = file.read(1 << 16)
    line = start.split(b"\n", 1)[0]
    return start.startswith(b"\xfd7zXZ") or (line.startswith(b"{") and any(word in line for word in _STARTS))


def _is_page(path):
    start = b"<!doctype html"
    with open(path, "rb") as file:
        return file.read(len(start)).lower() == start


def _is_same(path, other):
    try:
        return os.path.samefile(path, other)
    except OSError:
        return False


def _check_existing(path, inputs, is_page):
    if any(_is_same(path, one) for one in inputs):
        raise BadUse(f"{path}: is an input of this command; choose another file for the output")
    if not os.access(path, os.W_OK):
        raise BadUse(f"{path}: cannot be written ({os.strerror(errno.EACCES)}); choose another file")
    if _has_records(path):
        raise BadUse(
            f"{path}: is a file of records, which are never overwritten; choose another file for the output"
        )
    if is_page and os.path.getsize(path) > 0 and not _is_page(path):
        raise BadUse(f"{path}: exists and is no HTML page; choose another file for the output")


def check_output(path, inputs=(), suffix="", is_page=False):
    """Call this before any work. Raises BadUse for an output that is one of the inputs or a file of records,
    compared by device and inode, and for one that cannot be written, such as a folder. `suffix`: that of a
    file which is made beside it and then renamed; the output has to be a regular file. `is_page`: only
    pages and empty files may be overwritten."""
    path = os.fspath(path)
    for name in (path + suffix, path):
        try:
            mode = os.stat(name).st_mode
        except FileNotFoundError:
            mode = 0
        except OSError as problem:
            raise BadUse(f"{path}: cannot be written ({problem.strerror}); choose another file") from None
    if stat.S_ISREG(mode):
        _check_existing(path, inputs, is_page)
        return
    if stat.S_ISDIR(mode):
        raise BadUse(f"{path}: is a folder; name a file for the output")
    if suffix and mode:
        raise BadUse(f"{path}: is not a regular file; choose another for the output")
    folder = os.path.dirname(path) or "."
    if mode == 0 and not os.access(folder, os.W_OK | os.X_OK):
        raise BadUse(
            f"{path}: cannot be written ({os.strerror(errno.EACCES if os.path.exists(folder) else errno.ENOENT)}); choose another file"
        )


def temporary_folder():
    """A tempfile.TemporaryDirectory. Raises BadUse if there is no place for one."""
    try:
        return tempfile.TemporaryDirectory(prefix="tandem-")
    except OSError as problem:
        raise BadUse(f"no folder for temporary files ({problem.strerror}); set TMPDIR to one") from None


def _sync_folder(path):
    folder = os.open(os.path.dirname(path) or ".", os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(folder)
    except OSError as problem:
        if problem.errno not in (errno.EINVAL, errno.ENOTSUP):  # some file systems do not sync folders
            raise
    finally:
        os.close(folder)


def _locked(path, flags):
    """Opens and locks a file. Returns its descriptor. Raises OutputError if another process has the lock."""
    try:
        descriptor = os.open(path, flags | os.O_CLOEXEC, 0o666)
    except OSError as problem:
        raise OutputError(f"{path}: cannot be written ({problem.strerror})") from None
    reason = (
        "another process writes it; wait for its end"
        if stat.S_ISREG(os.fstat(descriptor).st_mode)
        else "is no file; choose another"
    )
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(descriptor)
        raise OutputError(f"{path}: {reason}") from None
    return descriptor


def _remove_stale(path):
    """Removes the file of a killed process. Refuses a link, by which another user of the folder could choose
    the written file."""
    if os.path.islink(path):
        raise OutputError(f"{path}: is a link, and a file has to be made there; remove it")
    if os.path.exists(path):
        descriptor = _locked(path, os.O_RDWR)
        os.remove(path)
        os.close(descriptor)


def save_svg(figure, path, **options):
    """Saves a figure of Matplotlib as SVG, with control characters of its texts as escapes. `options`: those
    of its savefig()."""
    text = io.BytesIO()
    figure.savefig(text, format="svg", **options)
    with open(path, "w", encoding="utf-8") as file:
        file.write(visible(text.getvalue().decode(), "\n\t"))


def replace_whole(path, data):
    """Writes the bytes to PATH.partial and renames it, so that a kill leaves the old file or the new one.
    Raises OutputError."""
    partial = f"{path}.partial"
    _remove_stale(partial)
    descriptor = _locked(partial, os.O_RDWR | os.O_CREAT | os.O_EXCL)
    try:
        for begin in range(0, len(data), 1 << 20):
            piece = data[begin : begin + (1 << 20)]
            while piece:
                piece = piece[os.write(descriptor, piece) :]
        os.fsync(descriptor)
    except OSError as problem:
        raise OutputError(f"{partial}: writing failed ({problem.strerror})") from None
    finally:
        os.close(descriptor)
    try:
        os.rename(partial, path)
    except OSError as problem:
        raise OutputError(f"{path}: cannot be replaced ({problem.strerror})") from None
    _sync_folder(path)
