# SPDX-License-Identifier: MIT
"""Names of cells and devices in tables, made only of what differs among them."""

from ..names import method
from ..varying import varying


class Devices:
    """Names of devices. If an id stands for several models or cards in different files, the name has the
    model, or part of the address."""

    def __init__(self):
        self.cards = {}

    def add(self, devices):
        """Adds the devices of a record. Returns the argument of text() for them."""
        own = tuple(
            (d["id"], d["name"] + (" (PoCL)" if "PoCL" in d["driver"] else ""), d["hardware"] or "")
            for d in devices
        )
        for identity, *card in own:
            self.cards.setdefault(identity, {})[tuple(card)] = None
        return own

    def text(self, devices):
        return "+".join(self._one(*device) for device in devices)

    def _one(self, identity, name, hardware):
        cards = self.cards[identity]
        if len(cards) == 1:
            return identity + (" (PoCL)" if name.endswith("(PoCL)") else "")
        alike = sum(model == name for model, _ in cards) > 1
        return f"{identity} {name}" + (f" {hardware[:4] or 'unknown'}" if alike else "")


class Named:
    """The values that name a record of an algorithm. Equal values are stored once, because they need most of
    the memory for long files."""

    _unique = {}

    @classmethod
    def once(cls, value):
        return cls._unique.setdefault(value, value)

    def __init__(self, record, devices, more=None):
        # Settings as they were asked for: a device that changes one, such as to groups of one work-item, does
        # not make another cell.
        settings = sorted({**record["settings"], **record.get("asked", {}), **(more or {})}.items())
        self.settings = self.once(tuple(map(self.once, settings)))
        self.family = self.once((record["algorithm"], record["preset"]))
        self.devices = self.once(devices.add(record["devices"]))
        self.commit = self.once(record["environment"]["commit"] or "")
        self.heading = record["scene"]["key"]
        if "frames" in record:
            self.heading += f", frames {record['frames']['first']}:{record['frames']['last']}"


def labels(rows, devices, known=()):
    """(text, devices) of each Named. The text has the method, and the settings in which its cells differ,
    without those in `known`. Commits are added if nothing else differs."""
    differ = varying({(row.family, row.settings) for row in rows})
    texts = [
        " ".join(
            [
                method(*row.family),
                *(
                    f"{name}={value}"
                    for name, value in row.settings
                    if name not in known and (row.family, name) in differ
                ),
            ]
        )
        for row in rows
    ]
    commits, times = {}, {}
    for row, text in zip(rows, texts):
        commits.setdefault((text, row.devices), set()).add(row.commit)
    for i, row in enumerate(rows):
        if len(commits[texts[i], row.devices]) > 1:
            texts[i] += f" @{row.commit[:7] or '?'}"
        times[texts[i], row.devices] = again = times.get((texts[i], row.devices), 0) + 1
        texts[i] += f" ({again})" if again > 1 else ""
    return list(zip(texts, (devices.text(row.devices) for row in rows)))
