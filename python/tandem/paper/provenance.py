# SPDX-License-Identifier: MIT
"""Which builds of tandem and which cards the records of a folder come from."""

import dataclasses
import json
import lzma

DIGITS = 12  # of a commit, as in steps.jsonl
SIMULATIONS = ("solver-", "part-")  # beginnings of the names of steps that simulate with the paper's solver


@dataclasses.dataclass(frozen=True)
class Origin:
    """Where records of a step come from. sources: digest of the program's sources; empty if it is unknown. cards:
    the GPUs; empty for work of a processor."""

    step: str
    commit: str
    sources: str
    cards: tuple

    @property
    def build(self):
        """Equal for equal programs: builds of several commits may have the same sources."""
        return self.sources or self.commit


def _commit(commit, is_dirty):
    return f"{(commit or 'unknown')[:DIGITS]}{' with changes' if is_dirty else ''}"


def _cards(record):
    devices = record.get("devices") or [record.get("device") or {}]
    return tuple(
        f"{device['name']} {(device.get('hardware') or '')[:6]}".strip()
        for device in devices
        if device.get("kind") == "gpu"
    )


def _of_records(folder):
    for path in sorted((folder.path / "records").glob("*.jsonl*")):
        with (lzma.open if path.suffix == ".xz" else open)(path, "rt") as file:
            for line in file:
                record = json.loads(line) if '"environment"' in line and line.endswith("\n") else {}
                environment = record.get("environment")
                if environment:
                    commit = _commit(environment["commit"], environment["dirty"])
                    yield Origin(
                        path.name.partition(".")[0], commit, environment.get("sources") or "", _cards(record)
                    )


def origins(folder):
    """The Origins of all records, and of the steps that have none, such as exports."""
    found = list(dict.fromkeys(_of_records(folder)))
    sources_of = {origin.commit: origin.sources for origin in found}
    with_records = {origin.step for origin in found}
    for name, step in folder.steps.items():
        if name not in with_records:
            commit = _commit(step["commit"], step["dirty"])
            found.append(Origin(name, commit, sources_of.get(commit, ""), ()))
    return found


def cards_of(found):
    return sorted({card for origin in found for card in origin.cards})


def builds_of(found):
    """{build: its commits}."""
    builds = {}
    for origin in found:
        builds.setdefault(origin.build, {})[origin.commit] = None
    return {build: list(commits) for build, commits in builds.items()}


def apart(found):
    """(measured, recorded): the Origins without, and with those of simulations that a processor has recorded for
    the measurements on a card. Their contacts are those of any build and device."""
    if not cards_of(found):
        return found, []
    recorded = [origin for origin in found if origin.step.startswith(SIMULATIONS) and not origin.cards]
    return [origin for origin in found if origin not in recorded], recorded


def is_uniform(found):
    return len(builds_of(found)) == 1 and len(cards_of(found)) < 2
