#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""kernel_resources.py PAGE.md FILE.s ...: writes a page with registers, spills and memory of kernels, from
the metadata of AMD machine code. Files are named KERNEL.GPU.PRECISION.s, as scripts/compile_kernels --table
makes them."""

import pathlib
import re
import sys

HEAD = """# Resources of kernels on AMD GPUs

For developers of kernels: what each kernel takes of an AMD GPU, as clang 15 compiles it at k = 18 in groups of 64.

`scripts/compile_kernels --table PAGE.md` writes this page; no device is needed, and none was used. A cell is
*vector registers / scalar registers / bytes of local memory*. Registers that do not fit are *spilled* to memory: a cell with spills adds
their number, and one with private memory adds its bytes per work-item.
"""


def entries(path):
    """By entry: numbers of the metadata of one assembly file."""
    text = path.read_text()
    _, _, metadata = text.partition("amdhsa.kernels:")
    for block in re.split(r"\n  - (?=\.)", metadata)[
        1:
    ]:  # a GPU with accumulation registers begins with their number
        values = dict(re.findall(r"^    \.(\w+): +(\S+)$", block, re.MULTILINE))
        yield (
            values["name"],
            {
                name: int(values[name])
                for name in (
                    "vgpr_count",
                    "sgpr_count",
                    "group_segment_fixed_size",
                    "vgpr_spill_count",
                    "sgpr_spill_count",
                    "private_segment_fixed_size",
                )
            },
        )


def cell(numbers):
    spills = numbers["vgpr_spill_count"] + numbers["sgpr_spill_count"]
    private = numbers["private_segment_fixed_size"]
    return (
        f"{numbers['vgpr_count']} / {numbers['sgpr_count']} / {numbers['group_segment_fixed_size']}"
        + (f", {spills} spilled" if spills else "")
        + (f", {private} private" if private else "")
    )


def main(page, paths):
    rows, gpus = {}, set()
    for path in paths:
        kernel, gpu, precision, _ = path.name.split(".")
        if precision != "32":
            continue
        gpus.add(gpu)
        for name, numbers in entries(path):
            rows.setdefault((kernel, name), {})[gpu] = cell(numbers)
    if not rows:
        sys.exit("kernel_resources: no file has metadata of a kernel; compile for an AMD GPU")
    columns = sorted(gpus, key=lambda gpu: (len(gpu), gpu))
    for (kernel, name), cells in rows.items():
        if missing := gpus - set(cells):
            sys.exit(f"kernel_resources: {kernel}: {name} has no metadata for {', '.join(sorted(missing))}")
    lines = [HEAD, f"| kernel | {' | '.join(columns)} |", "|---|" + "---|" * len(columns)]
    lines += [
        f"| `{kernel}`: `{name}` | {' | '.join(cells[gpu] for gpu in columns)} |"
        for (kernel, name), cells in sorted(rows.items())
    ]
    pathlib.Path(page).write_text("\n".join(lines) + "\n")
    print(f"kernel_resources: {len(rows)} entries for {', '.join(columns)} in {page}")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1], [pathlib.Path(name) for name in sys.argv[2:]])
