# SPDX-License-Identifier: MIT
"""Files of JSON lines that survive a kill and a loss of power."""

import ctypes
import json
import os

from ..errors import BadUse


def _sync_folder(path):
    descriptor = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def sync_file_system(path):
    """Syncs the file system of a folder, so that the output of all processes there survives a loss of power."""
    descriptor = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        ctypes.CDLL(None).syncfs(descriptor)
    finally:
        os.close(descriptor)


class Journal:
    """An append-only file of JSON lines. A line survives a loss of power once append() has returned. An
    incomplete last line, which a kill leaves, is moved to FILE.torn."""

    def __init__(self, path, refusal):
        """refusal: what is wrong with a file that has other lines, and what to do."""
        self.path, self.refusal = path, refusal
        self._keep_whole_lines()
        is_new = not path.exists()
        self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o666)
        if is_new:
            _sync_folder(path.parent)

    def _keep_whole_lines(self):
        try:
            data = self.path.read_bytes()
        except FileNotFoundError:
            return
        end = data.rfind(b"\n") + 1
        if end == len(data):
            return
        with open(f"{self.path}.torn", "ab") as torn:
            torn.write(data[end:] + b"\n")
            torn.flush()
            os.fsync(torn.fileno())
        _sync_folder(self.path.parent)
        with open(self.path, "r+b") as file:
            file.truncate(end)
            os.fsync(file.fileno())

    def lines(self):
        for number, text in enumerate(self.path.read_text().splitlines(), 1):
            try:
                line = json.loads(text)
            except ValueError:
                line = None
            if not isinstance(line, dict):
                raise BadUse(f"{self.path}:{number}: {self.refusal}")
            yield line

    def append(self, line):
        data = (json.dumps(line, separators=(",", ":"), ensure_ascii=False) + "\n").encode()
        if os.write(self._file, data) != len(data):
            raise OSError(28, os.strerror(28), str(self.path))
        os.fsync(self._file)
