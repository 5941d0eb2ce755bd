# SPDX-License-Identifier: MIT
# test: cost=15 full=300
"""Loss of power after every call that changes a file. Changes that are not yet
synced are on the disk completely, not at all, all but one, only one, or with half of the last write or zeros
in its place. The command is resumed on every such disk: everything promised before is there, and the final
result equals that without the loss. power.cpp logs the calls."""

import collections
import json
import os
import pathlib
import random
import re
import shutil
import struct

from tests.program import BUILT, LONG, Case, sets, tandem, tried

PRELOAD = str(BUILT / "libtandem_power.so")  # children run in other folders
SHORT = 12  # disks per command in the short form, a random selection
CAPACITIES = sets({name: 4096 for name in ("pair_capacity", "contact_capacity", "tile_pair_capacity")})
Change = collections.namedtuple(
    "Change", "of what"
)  # `of`: a file's number or a folder; what: a function of the disk
State = collections.namedtuple(
    "State", "names files"
)  # path: number of a file, None for a folder; number: bytes


def written(old, at, data):
    return old.ljust(at, b"\0")[:at] + data + old[at + len(data) :]


def folder_of(path):
    return os.path.dirname(path) or "."


class Disk:
    """The certain content, and the pending changes in order. Syncing a file makes its content certain,
    syncing a folder its names. A file's name is certain only after its folder is synced: POSIX leaves this
    open, and file systems differ."""

    def __init__(self, folder):
        self.certain, self.pending, self.names = State({}, {}), [], {}
        for path in sorted(folder.rglob("*")):
            name = str(path.relative_to(folder))
            self.certain.names[name] = None if path.is_dir() else self.new_file(path.read_bytes())
        self.names = dict(self.certain.names)

    def new_file(self, content=b""):
        number = len(self.certain.files)
        self.certain.files[number] = content
        return number

    def change(self, of, what):
        self.pending.append(Change(of, what))

    def settle(self, of):
        for change in self.pending:
            if change.of == of:
                change.what(self.certain)
        self.pending = [change for change in self.pending if change.of != of]

    def name(self, path, number):
        self.names[path] = number
        self.change(folder_of(path), lambda state: state.names.__setitem__(path, number))

    def unname(self, path):
        if path in self.names:
            del self.names[path]
            self.change(folder_of(path), lambda state: state.names.pop(path, None))

    def rename(self, source, target):
        number = self.names.pop(source)
        self.names[target] = number
        self.change(
            folder_of(target),
            lambda state: (state.names.pop(source, None), state.names.__setitem__(target, number)),
        )

    def call(self, kind, path, *rest):
        # created without a call of a program: output of a child
        if path not in self.names and kind in ("sync", "write", "size"):
            self.names[path] = self.certain.names[path] = self.new_file()
        number = self.names.get(path)
        if kind == "make":
            self.name(path, self.new_file())
        elif kind == "make-folder":
            self.name(path, None)
        elif kind == "remove":
            self.unname(path)
        elif kind == "rename":
            self.rename(path, rest[0])
        elif kind == "sync-folder":
            self.settle(path)
        elif kind == "sync":
            self.settle(number)
            self.certain.files[number] = bytes.fromhex(rest[0]) if rest else b""
        elif kind == "write":
            at, data = int(rest[0]), bytes.fromhex(rest[1])
            self.change(
                number,
                lambda state, cut=None: state.files.__setitem__(
                    number, written(state.files[number], at, cut(data) if cut else data)
                ),
            )
        elif kind == "size":
            size = int(rest[0])
            self.change(
                number,
                lambda state: state.files.__setitem__(number, state.files[number][:size].ljust(size, b"\0")),
            )

    def after(self, changes, cut=None):
        """The disk with these changes, the last of them cut."""
        state = State(dict(self.certain.names), dict(self.certain.files))
        for i, change in enumerate(changes):
            change.what(state, cut) if cut and i == len(changes) - 1 else change.what(state)
        gone = {
            path
            for path in state.names
            if any(
                str(parent) != "." and str(parent) not in state.names
                for parent in pathlib.PurePath(path).parents
            )
        }
        return {
            path: None if number is None else state.files[number]
            for path, number in state.names.items()
            if path not in gone
        }

    def possible(self):
        """Every disk that a loss of power at this point may leave."""
        every = self.pending
        yield from (self.after(every), self.after([]))
        for i, change in enumerate(every):
            yield self.after(every[:i] + every[i + 1 :])
            yield self.after([change])
        if every and every[-1].what.__defaults__ is not None:  # a write
            yield self.after(every, lambda data: data[: len(data) // 2])
            yield self.after(every, lambda data: bytes(len(data)))


def whole_lines(data):
    return data.split(b"\n")[:-1]


def steps_done(checkpoint):
    return struct.unpack_from("<8sIQQ", checkpoint)[3]


class Power(Case):
    lost, clear, swept = collections.Counter(), set(), {"run", "append", "simulate", "paper"}

    @classmethod
    def tearDownClass(cls):
        print(f"disks after a loss of power: {dict(cls.lost)}")
        if cls.clear == cls.swept:
            tried("losses of power: disks without unsynced changes", sum(cls.lost.values()), "disks")
        super().tearDownClass()

    def words(self, command, folder):
        cells = (
            f"{self.twice} --device host --algorithm chunked,tiled --set k=6",
            *CAPACITIES,
            "--repeat 2 --truth none --quiet",
        )
        return {
            "run": ("run", *cells, "--out", folder / "new.jsonl"),
            "append": ("run", *cells, "--out", folder / "old.jsonl"),
            "simulate": (
                "simulate arch:segments=2 --steps 5 --checkpoint 2 --dynamics absolute_tolerance=1 "
                f"--device host -o {folder}/a.frames --record {folder}/s.jsonl --quiet",
            ),
            "paper": (
                f"paper --device host -o {folder}/paper --steps chunks-morton,chunks-breadth --measure-only",
            ),
        }[command]

    def goes_on(self, command, folder):
        has_any = (folder / "a.frames").exists() if command == "simulate" else command in ("run", "append")
        return tandem(
            *self.words(command, folder),
            *(["--resume"] if has_any else []),
            environment={"TANDEM_KERNEL_CACHE": str(self.work / "cache")},
        )

    def watched(self, command, folder):
        """Log lines of the command's changes to a folder."""
        log = self.work / f"{command}.log"
        environment = {
            "LD_PRELOAD": PRELOAD,
            "POWER_FOLDER": str(folder.resolve()),
            "POWER_LOG": str(log),
            "TANDEM_KERNEL_CACHE": str(self.work / "cache"),
        }
        self.assertEqual(tandem(*self.words(command, folder), environment=environment)[0], 0)
        calls = [line.split("\t") for line in log.read_text().splitlines()]
        self.assertTrue({"make", "write", "sync"} <= {call[0] for call in calls}, "calls that are seen")
        return calls

    def promises(self, command, calls, folder):
        """After each call: synced lines of records by path, and the steps of a synced checkpoint."""
        lines, steps, disk = {}, 0, Disk(folder)
        for call in calls:
            disk.call(*call)
            if call[0] == "sync" and call[1].endswith(".jsonl"):
                lines = {**lines, call[1]: whole_lines(disk.certain.files[disk.names[call[1]]])}
            if (number := disk.certain.names.get("a.frames.checkpoint")) is not None:
                steps = steps_done(disk.certain.files[number])
            yield lines, steps

    def disks(self, command, before):
        """(promised, {path: bytes}) of every distinct disk; a random selection in the short form."""
        calls = self.watched(command, before)
        begin = self.work / f"{command}-begin"
        disk, found = Disk(begin), {}
        for promised, call in zip(self.promises(command, calls, begin), calls):
            disk.call(*call)
            for state in disk.possible():
                found[json.dumps(promised, default=repr), tuple(sorted(state.items()))] = promised, state
        every = list(found.values())
        self.assertGreater(len(every), 10, command)
        return every if LONG else random.Random(2018).sample(every, min(SHORT, len(every)))

    def make(self, state, folder):
        folder.mkdir()
        for path, content in sorted(state.items()):
            (folder / path).mkdir() if content is None else (folder / path).write_bytes(content)

    def judge(self, command, folder, promised, whole):
        lines, steps = promised
        code, text, errors = self.goes_on(command, folder)
        messages = [
            line
            for line in errors
            if line.startswith("tandem: ") and not re.search(r"the last line was torn", line)
        ]
        self.assertEqual((code, messages), (0, []), text)
        for path, kept in lines.items():
            self.assertTrue(
                set(kept) <= set(whole_lines((folder / path).read_bytes())),
                f"{path}: a promised record is gone",
            )
        if steps and (step := re.search(r"continues after step (\d+)", text)):
            self.assertGreaterEqual(int(step[1]), steps)
        for path, content in whole.items():
            self.assertEqual(self.lasting(path, (folder / path).read_bytes()), content, path)

    @staticmethod
    def lasting(path, content):
        """The part of a file's content that is the same in every run: for records, which ones exist."""
        if not path.endswith(".jsonl"):
            return content
        lines = [json.loads(line) for line in content.splitlines()]
        once = {
            tuple(str(line.get(name)) for name in ("what", "key", "asked", "kind", "step", "exit"))
            for line in lines
            if line.get("kind") not in ("run", "verdict")
        }
        return sorted(once)

    def sweep(self, command, prepare=lambda folder: None):
        before, begin = self.work / f"{command}-before", self.work / f"{command}-begin"
        for folder in (before, begin):
            folder.mkdir()
            prepare(folder)
        disks = self.disks(command, before)
        whole = {
            str(path.relative_to(before)): self.lasting(str(path), path.read_bytes())
            for path in before.rglob("*")
            if path.suffix in (".jsonl", ".frames", ".csv")
        }
        for number, (promised, state) in enumerate(disks):
            folder = self.work / f"{command}-{number}"
            self.make(state, folder)
            with self.subTest(
                command=command,
                number=number,
                disk={path: content and len(content) for path, content in state.items()},
            ):
                self.judge(command, folder, promised, whole)
            shutil.rmtree(folder)
        self.lost[command] = len(disks)
        if self._outcome.success:
            self.clear.add(command)

    def test_run(self):
        self.sweep("run")

    def test_append(self):
        """Appends to existing records and to a line torn by a kill."""
        self.sweep(
            "append",
            lambda folder: (folder / "old.jsonl").write_bytes(b'{"what":"was there before"}\n{"what":"to'),
        )

    def test_simulate(self):
        """Also with an existing checkpoint of another recording."""
        other = self.work / "other.frames"
        self.assertEqual(
            tandem("simulate", "arch:segments=2", "--steps", 3, "--device", "host", "-o", other, "--quiet")[
                0
            ],
            0,
        )
        self.sweep(
            "simulate", lambda folder: shutil.copy(f"{other}.checkpoint", folder / "a.frames.checkpoint")
        )

    def test_paper(self):
        self.sweep("paper")
