# SPDX-License-Identifier: MIT
"""Tables of profiles: kernels, one table per profile."""

from ..fields import frames_of
from .naming import Named, labels
from .wording import notes, number, table, with_interval


def _percent(value):
    return "" if value is None else f"{100 * value:.3g} %"


class Profile(Named):
    HEADS = [
        "kernel",
        "stage",
        "us per frame",
        "share",
        "launches",
        "times its floor",
        "bound",
        "of bytes",
        "of comparisons",
        "occupancy",
    ]

    def __init__(self, record, devices):
        super().__init__(record, devices)
        total = record["total_ns"] or {}
        self.notes = notes(record)
        rounds = len(set(total.get("rounds", [])))
        self.total_text = with_interval(total, 1e-6 / frames_of(record), rounds)
        self.kernels = [
            [
                k["entry"],
                k["stage"],
                with_interval(k["device_ns"], 1e-3, rounds),
                _percent(k["share"]),
                number(k["launches"]),
                "" if k["over_floor"] is None else number(k["over_floor"]),
                self._bound(k),
                _percent(k["of_bytes"]),
                _percent(k["of_operations"]),
                _percent(k["occupancy"]),
            ]
            for k in record["kernels"]
        ]

    @staticmethod
    def _bound(kernel):
        """The limit of a kernel by the counters of Nsight Compute, or by the floor if there are none."""
        return (kernel["counters"] or {}).get("bound") or kernel["bound"] or ""


def text(rows, devices):
    parts = []
    for row, (name, device) in zip(rows, labels(rows, devices)):
        parts += [
            f"\n### Kernels of {name} on {device}: {row.heading}\n\n",
            f"A frame takes {row.total_text or '?'} ms. {row.notes}".rstrip(),
            "\n\n",
        ]
        if row.kernels:
            parts.append(table(Profile.HEADS, row.kernels))
    return "".join(parts)
