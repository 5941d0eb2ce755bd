# SPDX-License-Identifier: MIT
"""Ceilings of devices, one row per device."""

from .wording import number, table


class Ceilings:
    COLUMNS = (
        ("copy GB/s", "copy_bytes_per_s", 1e-9),
        ("read GB/s", "read_bytes_per_s", 1e-9),
        ("cached read GB/s", "cache_read_bytes_per_s", 1e-9),
        ("upload pinned GB/s", "upload_pinned_bytes_per_s", 1e-9),
        ("upload GB/s", "upload_pageable_bytes_per_s", 1e-9),
        ("download GB/s", "download_pageable_bytes_per_s", 1e-9),
        ("launch and wait us", "launch_s", 1e6),
        ("launch us", "launch_queued_s", 1e6),
        ("overlap tests k = 8 G/s", "overlap_tests_k8_per_s", 1e-9),
        ("k = 18 G/s", "overlap_tests_k18_per_s", 1e-9),
    )

    def __init__(self, record, devices):
        self.devices = devices.add([record["device"]])
        self.texts = [
            record["device"]["name"],
            *(
                "-" if record[name] is None else number(record[name]["median"] * scale)
                for _, name, scale in self.COLUMNS
            ),
        ]


def text(rows, devices):
    if not rows:
        return ""
    heads = ["device", "name", *(head for head, _, _ in Ceilings.COLUMNS)]
    return "\n### Ceilings\n\n" + table(heads, [[devices.text(row.devices), *row.texts] for row in rows])
