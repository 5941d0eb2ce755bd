# SPDX-License-Identifier: MIT
"""Waiting for processes without limits that a loaded machine misses: a process counts as hung by its own
processor time, which stands still while other jobs run."""

import os
import pathlib
import threading
import time

TICKS = os.sysconf("SC_CLK_TCK")
ASLEEP = 300  # seconds in which a process neither ran nor waited for a processor or a disk


class Hung(Exception):
    """A process that uses processor time without an end, or waits for nothing."""


def state_of(process):
    """(processor seconds of a process with its ended children, whether a thread runs or waits for a processor
    or a disk)."""
    folder = pathlib.Path("/proc") / str(process)
    fields = (folder / "stat").read_text().rsplit(")", 1)[1].split()
    states = []
    for thread in folder.glob("task/*/stat"):
        try:
            states.append(thread.read_text().rsplit(")", 1)[1].split()[0])
        except (FileNotFoundError, ProcessLookupError):
            pass  # a thread that has ended
    return sum(map(int, fields[11:15])) / TICKS, any(state in "RD" for state in states)


def communicate(process, seconds, asleep=ASLEEP):
    """As process.communicate(). Kills the process and raises Hung after `seconds` of its processor time, or
    after `asleep` seconds without any."""
    why = []
    ended = threading.Event()

    def watch():
        used, since = 0.0, time.monotonic()
        while not ended.wait(0.1):
            try:
                now, active = state_of(process.pid)
            except (FileNotFoundError, ProcessLookupError):
                return
            if active or now != used:
                used, since = now, time.monotonic()
            if used > seconds or time.monotonic() - since > asleep:
                why.append(
                    f"{used:.1f} s of processor time"
                    if used > seconds
                    else f"{asleep} s without any processor time"
                )
                process.kill()
                return

    watcher = threading.Thread(target=watch)
    watcher.start()
    try:
        text = process.communicate()
    finally:
        ended.set()
        watcher.join()
    if why:
        raise Hung(why[0])
    return text
