# SPDX-License-Identifier: MIT
"""Atomic replacement of files."""
import errno
import fcntl
import os
import stat

from .errors import OutputError


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
    reason = "another process writes it; wait for its end" if stat.S_ISREG(os.fstat(descriptor).st_mode) else "is no file; choose another"
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(descriptor)
        raise OutputError(f"{path}: {reason}") from None
    return descriptor


def _remove_stale(path):
    """Removes the file of a killed process. Refuses a link, by which another user of the folder could choose the written file."""
    if os.path.islink(path):
        raise OutputError(f"{path}: is a link, and a file has to be made there; remove it")
    if os.path.exists(path):
        descriptor = _locked(path, os.O_RDWR)
        os.remove(path)
        os.close(descriptor)


def replace_whole(path, data):
    """Writes the bytes to PATH.partial and renames it, so that a kill leaves the old file or the new one. Raises OutputError."""
    partial = f"{path}.partial"
    _remove_stale(partial)
    descriptor = _locked(partial, os.O_RDWR | os.O_CREAT | os.O_EXCL)
    try:
        for begin in range(0, len(data), 1 << 20):
            piece = data[begin:begin + (1 << 20)]
            while piece:
                piece = piece[os.write(descriptor, piece):]
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
