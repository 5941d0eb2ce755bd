#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# test: cost=1
"""The lists of docs/developer/rooms.md allow every include and every namespace of
the tree."""

import pathlib
import re
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[1]

PAGE = "docs/developer/rooms.md"
LIST = "algorithms/list.cpp"
NAMESPACE = re.compile(r"(?:inline )?namespace ([a-z_0-9:]+) \{")
INCLUDE = re.compile(r'\s*#\s*include\s*"([^"]+)"')
ENDINGS = {".h", ".hpp", ".cpp", ".c", ".cl", ".clh", ".cu"}
LEAST = 500  # minimum number of includes in a whole tree: fewer mean that the search has missed files


def words(text):
    """Texts in backquotes."""
    return re.findall(r"`([^`]+)`", text)


def lists(text):
    """The entries of a page's lists, as pairs of the texts before and behind their colons, by heading."""
    found = {}
    for section in re.split(r"(?m)^## ", text)[1:]:
        head, _, body = section.partition("\n")
        found[head] = [line.partition(":")[::2] for line in re.findall(r"(?m)^- (.*)", body)]
    return found


class Rules:
    """Includes that the page of a tree allows. WALK is every algorithm of the tree's list."""

    def __init__(self, root):
        text, algorithms = ((root / name).read_text(encoding="utf-8") for name in (PAGE, LIST))
        listed = re.search(r"TANDEM_ALGORITHMS\(ALGORITHM\)((?: \\\n *ALGORITHM\(\w+\))+)", algorithms)
        walks = re.findall(r"ALGORITHM\((\w+)\)", listed[1])
        text = text.replace("`WALK`", "/".join(f"`{walk}`" for walk in walks))
        of_page = lists(text.replace("`WALK/`", " ".join(f"`{walk}/`" for walk in walks)))
        included = of_page["What a room may include"]
        self.rooms = {room: set(words(others)) for own, others in included for room in words(own)}
        self.limits = {
            tuple(words(own)): (others.split()[0], words(others))
            for own, others in of_page["Narrower limits"]
        }
        self.elsewhere = {words(name)[0] for name, _ in of_page["Headers found elsewhere"]}
        # Number of the step of each folder or file of a room.
        self.steps = {
            words(room)[0]: {
                name.strip("`"): number
                for number, step in enumerate(steps.split())
                for name in step.split("/")
            }
            for room, steps in of_page["Order inside a room"]
        }
        self.namespaces = {
            (name, words(place)[0]) for place, names in of_page["Namespaces"] for name in words(names)
        }

    def room_of(self, path):
        """The longest room that contains the path; otherwise the folder, which has no entry."""
        names = [name for name in self.rooms if path.startswith(name + "/")]
        return max(names, key=len) if names else path.rpartition("/")[0] or "."

    def error(self, path, target):
        """Why the file must not include the other; empty if it may."""
        own, other = self.room_of(path), self.room_of(target)
        for room in (own, other):
            if room not in self.rooms:
                return f"folder {room} is no room of {PAGE}"
        if own == other:
            return self.error_in_room(own, path, target)
        if other not in self.rooms[own]:
            return f"room {own} must not include room {other}"
        rule, entries = self.limits.get((own, other), ("never", ()))
        inner = target[len(other) + 1 :]
        names = lambda entry: inner.startswith(entry) if entry.endswith("/") else inner == entry
        if any(map(names, entries)) == (rule == "never"):
            return f"room {own} must not include {inner} of room {other}"
        return ""

    def error_in_room(self, room, path, target):
        """Why the file must not include the other one of its room; empty if it may."""
        if room not in self.steps:
            return ""
        own, other = (file[len(room) + 1 :].partition("/")[0] for file in (path, target))
        for name in (own, other):
            if name not in self.steps[room]:
                return f"{name} has no step in room {room}"
        if own == other or self.steps[room][other] < self.steps[room][own]:
            return ""
        return f"{own} must not include {other}, which does not stand before it in room {room}"

    def is_namespace(self, path, name):
        """Whether a file may open the namespace `name`, which stands inside `tandem`."""
        *folders, file = path.split("/")
        own = name == file.partition(".")[0] or any(
            name == folder or name.startswith(folder + "_") for folder in folders
        )
        return own or any(name == other and path.startswith(place) for other, place in self.namespaces)


def files(root):
    """Paths below the root that may have includes; build folders and hidden ones are excluded."""
    for folder in sorted(
        entry for entry in root.iterdir() if entry.is_dir() and not re.match(r"build|\.", entry.name)
    ):
        yield from (path for path in sorted(folder.rglob("*")) if path.suffix in ENDINGS)


def check(root):
    """(number of includes, errors); each error begins with FILE:LINE."""
    rules = Rules(root)
    count, errors = 0, []
    for path in files(root):
        name = path.relative_to(root).as_posix()
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            opened = NAMESPACE.match(line)
            inner = opened[1].split("::") if opened else []
            errors += [
                f"{name}:{number}: namespace {one} is no folder or file of the path"
                for one in inner
                if one != "tandem" and not rules.is_namespace(name, one)
            ]
            include = INCLUDE.match(line)
            if not include:
                continue
            count += 1
            target = include[1]
            beside = path.parent / target
            if not (root / target).is_file() and beside.is_file():
                target = beside.resolve().relative_to(root.resolve()).as_posix()
            if target.endswith(".cl.h"):  # generated from the kernel file
                target = target.removesuffix(".h")
            if target in rules.elsewhere:
                continue
            error = rules.error(name, target) if any(root.glob(target)) else f"no file {target}"
            if error:
                errors.append(f"{name}:{number}: {error}")
    if count < LEAST:
        errors.append(f"only {count} includes found, fewer than {LEAST}")
    return count, errors


class Rooms(unittest.TestCase):
    def test_the_tree_follows_the_page(self):
        count, errors = check(SOURCE)
        print(f"{count} includes")
        self.assertEqual(errors, [])

    def test_lists_of_rooms_elsewhere_are_complete(self):
        """What formats, analyses, compiles or digests sources names every room of the library and the program."""
        rooms = set(Rules(SOURCE).rooms) - {"python/core", "tests", "scripts"}
        self.assertGreater(len(rooms), 5)
        for name in (
            "scripts/check_format",
            "scripts/check_tidy",
            ".clang-tidy",
            "cmake/commit.cmake",
            "CMakeLists.txt",
        ):
            words = set(re.findall(r"[a-z_]+", (SOURCE / name).read_text(encoding="utf-8")))
            self.assertLessEqual(rooms, words, name)

    def test_the_page_names_rooms_that_exist(self):
        rules = Rules(SOURCE)
        for room, allowed in rules.rooms.items():
            self.assertTrue((SOURCE / room).is_dir(), room)
            self.assertLessEqual(allowed, set(rules.rooms), room)
        for (own, other), (rule, entries) in rules.limits.items():
            self.assertIn(other, rules.rooms[own])
            self.assertIn(rule, ("only", "never"))
            for entry in entries:
                self.assertTrue((SOURCE / other / entry).exists(), f"{other}/{entry}")
        self.assertEqual(set(rules.steps), {"algorithms", "harness"})
        for room, steps in rules.steps.items():
            files = {path.name for path in (SOURCE / room).iterdir()} - {"README.md", "CMakeLists.txt"}
            self.assertEqual(set(steps), files, f"steps of {room}")


class Mistakes(unittest.TestCase):
    """Small trees with one mistake each; the page is the real one."""

    def errors(self, text, where="geometry/new.h", many=True):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name in (PAGE, LIST):
                (root / name).parent.mkdir(parents=True)
                text_of_file = re.sub(r"(?m)^#include.*\n", "", (SOURCE / name).read_text(encoding="utf-8"))
                (root / name).write_text(text_of_file, encoding="utf-8")
            for path in (
                "base/error.h",
                "scenes/scene.h",
                "scenes/motion.h",
                "harness/plans/cells.h",
                "algorithms/traversal.h",
                "algorithms/tiled/turns.h",
            ):
                (root / path).parent.mkdir(parents=True, exist_ok=True)
                (root / path).touch()
            if many:
                (root / "base/many.cpp").write_text('#include "base/error.h"\n' * LEAST)
            (root / where).parent.mkdir(parents=True, exist_ok=True)
            (root / where).write_text(text)
            return check(root)[1]

    def test_allowed_includes_pass(self):
        self.assertEqual(self.errors('#include "base/error.h"\n#include <vector>\n'), [])
        self.assertEqual(self.errors('#include "error.h"\n#include "commit.h"\n', "base/new.h"), [])

    def test_a_wrong_include_fails(self):
        self.assertEqual(
            self.errors('\n  #  include "harness/plans/cells.h"\n'),
            ["geometry/new.h:2: room geometry must not include room harness"],
        )
        self.assertEqual(
            self.errors('#include "scenes/motion.h"\n', "algorithms/new.cpp"),
            ["algorithms/new.cpp:1: room algorithms must not include motion.h of room scenes"],
        )
        self.assertEqual(
            self.errors('#include "algorithms/tiled/turns.h"\n', "harness/new.cpp"),
            ["harness/new.cpp:1: room harness must not include tiled/turns.h of room algorithms"],
        )
        self.assertEqual(
            self.errors('#include "base/nothing.h"\n'), ["geometry/new.h:1: no file base/nothing.h"]
        )
        self.assertEqual(self.errors('#include "base/*.clh"\n'), ["geometry/new.h:1: no file base/*.clh"])

    def test_an_include_against_the_order_fails(self):
        self.assertEqual(self.errors('#include "algorithms/traversal.h"\n', "algorithms/tiled/new.h"), [])
        self.assertEqual(self.errors('#include "turns.h"\n', "algorithms/tiled/new.h"), [])
        against = "which does not stand before it in room algorithms"
        self.assertEqual(
            self.errors('#include "algorithms/tiled/turns.h"\n', "algorithms/traversal.h"),
            [f"algorithms/traversal.h:1: traversal.h must not include tiled, {against}"],
        )
        self.assertEqual(
            self.errors('#include "algorithms/tiled/turns.h"\n', "algorithms/chunked/new.h"),
            [f"algorithms/chunked/new.h:1: chunked must not include tiled, {against}"],
        )
        self.assertEqual(
            self.errors('#include "algorithms/traversal.h"\n', "algorithms/other/new.h"),
            ["algorithms/other/new.h:1: other has no step in room algorithms"],
        )

    def test_namespaces(self):
        self.assertEqual(
            self.errors("namespace tandem::geometry {\nnamespace geometry_parts {\nnamespace new {\n"), []
        )
        self.assertEqual(
            self.errors("namespace tandem {\nnamespace oracle {\n"),
            ["geometry/new.h:2: namespace oracle is no folder or file of the path"],
        )
        self.assertEqual(
            self.errors("namespace tandem::exporting {\n"),
            ["geometry/new.h:1: namespace exporting is no folder or file of the path"],
        )

    def test_a_room_without_an_entry_fails(self):
        self.assertEqual(
            self.errors('#include "base/error.h"\n', "extra/new.cpp"),
            [f"extra/new.cpp:1: folder extra is no room of {PAGE}"],
        )
        self.assertEqual(
            self.errors('#include "base/error.h"\n', "python/other/new.cpp"),
            [f"python/other/new.cpp:1: folder python/other is no room of {PAGE}"],
        )

    def test_a_tree_with_few_includes_fails(self):
        self.assertEqual(
            self.errors('#include "base/error.h"\n', many=False),
            [f"only 1 includes found, fewer than {LEAST}"],
        )


if __name__ == "__main__":
    unittest.main(argv=["rooms.py"], verbosity=2)
